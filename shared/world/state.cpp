#include "shared/world/state.h"

#include <numeric>

#include "shared/base/hash.h"
#include "shared/world/pose_bytes.h"
#include "shared/world/script.h"

namespace spoor {
Status validatePoses(const ScenePack& pack, std::span<const Pose> poses) {
  if (poses.size() != pack.bodies.size())
    return Error{std::to_string(poses.size()) + " poses for " + std::to_string(pack.bodies.size()) + " bodies"};
  constexpr std::int32_t edge = 1 << 24;  // a mesh reaches less far
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Pose& pose = poses[i];
    const bool inside = pose.x_q > INT32_MIN + edge && pose.x_q < INT32_MAX - edge && pose.y_q > INT32_MIN + edge &&
                        pose.y_q < INT32_MAX - edge && pose.z_q > -rules::kHeightLimit + edge &&
                        pose.z_q < rules::kHeightLimit - edge;
    if (!inside) return Error{"body " + std::to_string(i) + ": position out of range"};
    if (pose.scale_q16 < 1 || pose.scale_q16 > kFullScale)
      return Error{"body " + std::to_string(i) + ": scale " + std::to_string(pose.scale_q16) + " is not within 1 .. " +
                   std::to_string(kFullScale)};
  }
  return {};
}

std::uint64_t stateHash(const WorldState& state) {
  ByteWriter writer;
  writer.put(state.tick);
  writer.put(state.pack_id.low);
  writer.put(state.pack_id.high);
  putParameters(writer, state.parameters);
  writer.put(std::uint32_t(state.craters.size()));
  writer.put(state.craters.hash());
  writer.put(std::uint32_t(state.snowfalls.size()));
  for (const Snowfall& snowfall : state.snowfalls) putSnowfall(writer, snowfall);
  writer.put(std::uint32_t(state.poses.size()));
  for (const Pose& pose : state.poses) putPose(writer, pose);
  for (const Pose& pose : state.previous_poses) putPose(writer, pose);
  return state.tiles_hash + hashBytes(writer.bytes);
}

WorldState initialState(const PackId& id, const BaseTerrain& base) {
  WorldState state;
  state.pack_id = id;
  state.parameters = base.pack().parameters;
  state.craters = CraterSet(base.pack());
  state.snowfalls = base.pack().snowfalls;
  state.poses = Script(base).poses(0);
  state.previous_poses = state.poses;
  return state;
}

DormantGround dormantGround(const WorldState& state, const BaseTerrain& base) {
  return {&base, &state.craters, state.snowfalls, state.tick};
}

bool recount(const WorldState& state) {
  std::uint64_t tiles_hash = 0;
  Ledger ledger;
  ledger.craters = state.ledger.craters;  // of the past: only that it balances can be checked
  ledger.events = state.ledger.events;
  for (const Tile* tile : state.tiles.sorted()) {
    if (tileHash(*tile) != tile->hash) return false;
    tiles_hash += tileStateHash(*tile);
    ledger.initial += tile->initial;
    ledger.ground += std::accumulate(tile->height().begin(), tile->height().end(), std::int64_t(0));
    if (const PlaneCells* compacted = tile->compacted())
      ledger.compacted += std::accumulate(compacted->begin(), compacted->end(), std::int64_t(0));
  }
  return tiles_hash == state.tiles_hash && ledger == state.ledger && ledger.error() == 0;
}

}  // namespace spoor
