#pragma once

#include "shared/world/state.h"

namespace spoor {

/// Which live tiles take snow in a tick.
enum class SnowTiles { all, asleep, awake };

/// Live tiles that take snow in a tick (snowDue), in (y, x) order.
std::vector<Tile*> tilesInSnow(const WorldState& state, std::int32_t tick, SnowTiles which);

/// Takes a tile, its hash and sums and the state's over what falls on it in a tick.
void snowOnTile(Tile& tile, const ScenePack& pack, std::int32_t tick, WorldState& state);

/// The same of what has been found already.
/// @param gained  soil, 0.1 mm * cells
/// @param hash    of the tile with it
void commitSnow(Tile& tile, std::int64_t gained, std::uint64_t hash, WorldState& state);

/// The snow of a tick on live tiles. Those of them that were asleep are woken where it lies too steep to rest by the
/// state's parameters: within the tile, or towards a neighbour that is live and asleep too. Those that are awake are
/// looked after already. Bodies are not looked at: what one holds back wakes for a tick.
class SnowOfTick {
 public:
  /// Takes the tiles, their hashes, sums and wake masks, and the state's over it.
  SnowOfTick(WorldState& state, const ScenePack& pack, std::int32_t tick, SnowTiles which);

  /// The tiles that took it, in (y, x) order.
  std::vector<Tile*> tiles() const;
  /// Undoes it all. Only where nothing else has changed these tiles since.
  void takeBack(WorldState& state);

 private:
  struct Before {
    Tile* tile;
    PlaneCells height;
    std::uint64_t hash;
    std::int64_t ground;
    WakeMask wake_mask;
  };
  std::vector<Before> before_;
};

}  // namespace spoor
