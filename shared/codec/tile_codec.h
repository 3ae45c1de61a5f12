#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "shared/base/result.h"
#include "shared/world/state.h"

namespace spoor {

// A few bytes of a change can make a whole tile live (48 KiB), so changes are bounded in number: those of a tick by
// what a tick may simulate, those of a snapshot by what a client may hold. A tick's tiles, 16 KiB a plane, fit the
// storage block of 128 MiB that every OpenGL 4.5 gives.
inline constexpr std::size_t kTickTilesLimit = 1 << 13;
inline constexpr std::size_t kSnapshotTilesLimit = 1 << 17;

/// Version of a tile that was dormant: base, craters and snow.
inline constexpr std::int32_t kDormantVersion = -1;

/// What one tick (or the whole time since the base, in a snapshot) did to one tile.
struct TileChange {
  TileCoordinate at;
  std::int32_t base_version = kDormantVersion;  // version the difference is against, with this tick's craters and snow
                                                // in it; kDormantVersion: dormant ground
  std::int32_t new_version = 0;
  WakeMask wake_mask = 0;
  std::uint64_t hash = 0;  // the tile's hash afterwards
  // The box of cells that changed in any plane, within the tile, and new - old in it, row-major. width 0: none changed.
  std::uint8_t x = 0, y = 0, width = 0, height = 0;
  std::vector<std::int32_t> difference;       // of heights
  std::vector<std::int32_t> compaction = {};  // of compacted soil; empty: none changed
  std::vector<std::int32_t> material = {};    // of numbers of materials; the same
};

/// A tile's planes; nullptr: 0 everywhere.
using TilePlanes = std::array<const PlaneCells*, kPlaneCount>;
TilePlanes planesOf(const Tile& tile);

/// What leads from `before` to the tile's present cells; the box is the smallest that holds every changed cell.
TileChange differenceOf(const Tile& tile, const TilePlanes& before, std::int32_t base_version);

/// Canonical bytes of changes, meant to be compressed afterwards: zigzag differences split into byte planes.
std::vector<std::uint8_t> encodeTiles(std::span<const TileChange> changes);

/// Safe on untrusted bytes. Checks structure and ranges; tiles must lie in the pack's world, in (y, x) order, once
/// each.
Result<std::vector<TileChange>> decodeTiles(std::span<const std::uint8_t> bytes, const ScenePack& pack,
                                            std::size_t tile_limit = kTickTilesLimit);

/// Applies changes to a state's tiles, which have the snow of `tick` already, and keeps its sums. All is checked first
/// (versions, height range, every tile's hash, and that no live tile is left out that a new crater meets); on an error,
/// which names the tile, the state is untouched.
/// @param first_new_crater  those of the state's craters from here on have not changed its live tiles yet
[[nodiscard]] Status applyTiles(WorldState& state, const BaseTerrain& base, std::span<const TileChange> changes,
                                std::int32_t tick, std::size_t first_new_crater = kCratersLimit);

/// One tick as the server publishes it and the session file could replay it to a viewer.
struct TickUpdate {
  std::int32_t tick = 0;
  std::uint64_t state_hash = 0;
  std::vector<Pose> poses;                    // of every body after this tick
  std::vector<std::uint8_t> tiles;            // encodeTiles
  std::optional<Parameters> parameters = {};  // from this tick on, where they changed
  std::vector<Crater> craters = {};           // that came with this tick
  std::vector<Snowfall> snowfalls = {};       // the same
};

/// Takes a state from tick - 1 to tick. Safe on untrusted content. On an error the state is untouched, but where only
/// the state hash differs afterwards: then it has been applied and the error says both hashes.
[[nodiscard]] Status applyTick(WorldState& state, const BaseTerrain& base, const TickUpdate& update);

/// A whole state in bytes, meant to be compressed: tick, parameters, craters, snowfalls, poses and every live tile
/// against dormant ground.
std::vector<std::uint8_t> encodeSnapshot(const WorldState& state, const BaseTerrain& base);

/// Safe on untrusted bytes.
Result<WorldState> decodeSnapshot(std::span<const std::uint8_t> bytes, const PackId& id, const BaseTerrain& base);

}  // namespace spoor
