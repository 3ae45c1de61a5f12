#pragma once

#include <cstdint>
#include <vector>

#include "shared/world/tile_store.h"

namespace spoor {

/// All that steers the future of a session, and nothing else (DESIGN.md, "state").
struct WorldState {
  std::int32_t tick = 0;  // ticks completed
  PackId pack_id;
  Parameters parameters;
  std::vector<Pose> poses;           // of every body of the pack, after `tick`
  std::vector<Pose> previous_poses;  // and one tick earlier
  CraterSet craters;
  std::vector<Snowfall> snowfalls;  // in the order in which they came
  TileStore tiles;
  // Sums over live tiles, kept up to date by whoever changes one.
  std::uint64_t tiles_hash = 0;  // of tileStateHash
  Ledger ledger;
};

/// Checks poses from outside: one for each body, coordinates far enough from the integers' ends.
[[nodiscard]] Status validatePoses(const ScenePack& pack, std::span<const Pose> poses);

/// The session's hash: the tiles' sum plus a hash of the canonical bytes of the rest.
std::uint64_t stateHash(const WorldState& state);

/// The state before the first tick: every body where its path starts, every tile dormant.
WorldState initialState(const PackId& id, const BaseTerrain& base);

/// Ground that is dormant in a state. The state must live on.
DormantGround dormantGround(const WorldState& state, const BaseTerrain& base);

/// Recomputes tiles_hash and the ledger from the heights: the slow check on the incremental ones.
/// Returns false where they differ from what the state holds, or the ledger does not balance.
bool recount(const WorldState& state);

}  // namespace spoor
