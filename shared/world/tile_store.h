#pragma once

#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include "shared/world/dormant_ground.h"

namespace spoor {

/// Named layers of a tile. Store, deltas, snapshots and hashes are written over a set of them.
enum class Plane : std::uint8_t {
  height = rules::kHeightPlane,
  compacted = rules::kCompactedPlane,
  material = rules::kMaterialPlane
};
inline constexpr int kPlaneCount = 3;

/// Bits of a wake mask: which tiles a changed tile keeps active in the next tick. Bit (dy + 1) * 3 + (dx + 1); the tile
/// itself is bit 4. 0: asleep.
using WakeMask = std::uint16_t;
inline constexpr WakeMask kWakeSelf = 1u << 4;
inline constexpr WakeMask kWakeMaskLimit = 1u << 9;

using PlaneCells = std::array<std::int32_t, rules::kTileCells>;

/// What the craters of a set did to each cell of a live tile, kept so that a new one costs no more than itself.
struct TileCraters {
  std::size_t count = 0;  // of craters that met the tile
  std::array<rules::CraterSum, rules::kTileCells> sums{};
};

/// A live tile. Everything but `planes`, `version_tick` and `wake_mask` is derived and kept for speed.
struct Tile {
  TileCoordinate at;
  std::array<std::unique_ptr<PlaneCells>, kPlaneCount> planes;  // height is always there; others once not 0 everywhere
  std::unique_ptr<PlaneCells> bedrock;
  std::unique_ptr<TileCraters> craters;  // from the first crater on that fell on it while it was live
  std::int32_t version_tick = 0;         // the tick at which it last changed, or became live
  WakeMask wake_mask = 0;                // set by TileStore::setWake
  std::int32_t awake_index = -1;         // place in the store's list of awake tiles
  std::uint64_t hash = 0;                // sum of its cells' hashes; cells outside the world count too
  std::int64_t ground = 0;               // sum of its heights, 0.1 mm * cells
  std::int64_t initial = 0;              // the same of the base
  std::int64_t compacted_sum = 0;
  std::int64_t first_craters = 0;  // what craters and snowfalls had done to it when it became live
  std::int64_t first_snow = 0;

  PlaneCells& height() { return *planes[int(Plane::height)]; }
  const PlaneCells& height() const { return *planes[int(Plane::height)]; }
  /// Soil that was pressed together in each cell, >= 0, 0.1 mm; nullptr: none anywhere.
  PlaneCells* compacted() { return planes[int(Plane::compacted)].get(); }
  const PlaneCells* compacted() const { return planes[int(Plane::compacted)].get(); }
  /// The same, made where it was not there.
  PlaneCells& makeCompacted();
  /// Number of each cell's material; nullptr: 0 everywhere.
  const PlaneCells* material() const { return planes[int(Plane::material)].get(); }
};

/// Sums over live tiles, 0.1 mm * cells. Balanced where error() is 0.
struct Ledger {
  std::int64_t initial = 0;
  std::int64_t ground = 0;
  std::int64_t compacted = 0;
  std::int64_t craters = 0;
  std::int64_t events = 0;
  std::int64_t error() const { return initial + events + craters - ground - compacted; }
  bool operator==(const Ledger&) const = default;
};

/// A tile as it is at the moment it becomes live: dormant ground, and its materials. `at` must lie in the world
/// (asserted).
std::unique_ptr<Tile> makeTile(TileCoordinate at, const DormantGround& dormant, std::int32_t tick);

/// The cells of a tile, those outside the world too.
CellBox cellsOf(TileCoordinate at);

/// The box of cells, within the tile, that holds the boxes of all craters of a set from number `first_new` on; empty
/// where none meets it.
CellBox cratersWithin(TileCoordinate at, const ScenePack& pack, const CraterSet& craters, std::size_t first_new);

/// Changes heights of a tile as those craters do: by D(S) - D(S without them), never below bedrock.
/// @param known  of the tile, what the craters before did; made where it is not there, and brought up to date
/// @return       what the cells gained, 0.1 mm * cells
std::int64_t addCraters(TileCoordinate at, PlaneCells& height, const PlaneCells& bedrock, const CraterSet& craters,
                        std::size_t first_new, std::unique_ptr<TileCraters>& known);

/// The live tiles of a world. Dormant tiles are not here and cost nothing.
class TileStore {
 public:
  /// The tile, or nullptr where it is dormant.
  Tile* find(TileCoordinate at);
  const Tile* find(TileCoordinate at) const;

  /// Makes a dormant tile live. It must have been dormant (asserted).
  Tile& insert(std::unique_ptr<Tile> tile);

  /// Sets a tile's wake mask and keeps the list of awake tiles.
  void setWake(Tile& tile, WakeMask mask);
  /// Tiles whose wake mask is not 0, in no particular order: for filling ordered sets only.
  const std::vector<Tile*>& awake() const { return awake_; }

  /// Live tiles that take snow in a tick, should it snow (snowBeat), in no particular order.
  std::span<Tile* const> atBeat(std::int32_t tick) const;

  /// Live tiles in (y, x) order.
  std::vector<Tile*> sorted();
  std::vector<const Tile*> sorted() const;

  /// Live tiles that the boxes of craters meet, in (y, x) order, each once.
  std::vector<const Tile*> meeting(const ScenePack& pack, std::span<const Crater> craters) const;

  std::size_t size() const { return tiles_.size(); }
  /// Bytes held by live tiles.
  std::size_t memoryBytes() const;

 private:
  std::unordered_map<std::uint64_t, std::unique_ptr<Tile>> tiles_;
  std::vector<Tile*> awake_;
  std::array<std::vector<Tile*>, rules::kSnowBeat> by_beat_;  // by snowBeat of tick 0, negated
};

/// Sum of the hashes of the cells of one plane of the tile at `at`; nullptr: 0 everywhere.
std::uint64_t planeHash(TileCoordinate at, Plane plane, const PlaneCells* cells);
/// Sum of the hashes of a tile's cells over all planes, from the cells.
std::uint64_t tileHash(const Tile& tile);
/// What a tile adds to the state hash: its cells, that it is live, and its wake mask.
std::uint64_t tileStateHash(const Tile& tile);

/// Number of tiles along each side that the world touches.
TileCoordinate tileExtent(const ScenePack& pack);

}  // namespace spoor
