#include "shared/base/bytes.h"
#include "shared/base/json.h"
#include "shared/codec/tile_codec.h"
#include "shared/world/pose_bytes.h"

namespace spoor {
namespace {

// Far more than craters and events can give, or take from, as many tiles as there may be; far less than overflows.
constexpr std::int64_t kBudgetLimit = std::int64_t(1) << 61;

Status readCraters(ByteReader& reader, const ScenePack& pack, WorldState& state) {
  const std::size_t count = reader.get<std::uint32_t>();
  if (count > kCratersLimit || count * kCraterBytes > reader.left())
    return Error{std::to_string(count) + " craters announced, more than there can be"};
  std::vector<Crater> craters;
  craters.reserve(count);
  std::int64_t hash_cells = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Crater& crater = craters.emplace_back(getCrater(reader));
    const std::int32_t before = i > 0 ? craters[i - 1].tick : 1;
    if (crater.id != i || crater.tick < before || crater.tick > state.tick)
      return Error{"crater " + std::to_string(i) + " is out of order"};
    if (Status status = validateCrater(pack, crater); !status)
      return Error{"crater " + std::to_string(i) + ": " + status.error()};
    hash_cells += hashCellsOf(pack, crater);
    if (hash_cells > kCraterHashCellsLimit)
      return Error{"its craters are in more than " + std::to_string(kCraterHashCellsLimit) + " hash cells"};
  }
  state.craters = CraterSet(pack);
  state.craters.add(craters);
  return {};
}

Status readSnowfalls(ByteReader& reader, const ScenePack& pack, WorldState& state) {
  const std::size_t count = reader.get<std::uint32_t>();
  if (count > kSnowfallsLimit || count * kSnowfallBytes > reader.left())
    return Error{std::to_string(count) + " snowfalls announced, more than there can be"};
  for (std::size_t i = 0; i < count; ++i) state.snowfalls.push_back(getSnowfall(reader));
  return validateNewSnowfalls(pack, state.snowfalls, 1, 0);
}

}  // namespace

std::vector<std::uint8_t> encodeSnapshot(const WorldState& state, const BaseTerrain& base) {
  ByteWriter writer;
  writer.put(state.tick);
  writer.put(stateHash(state));
  putParameters(writer, state.parameters);
  writer.put(state.ledger.craters);
  writer.put(state.ledger.events);
  writer.put(std::uint32_t(state.craters.size()));
  for (const Crater& crater : state.craters.records()) putCrater(writer, crater);
  writer.put(std::uint32_t(state.snowfalls.size()));
  for (const Snowfall& snowfall : state.snowfalls) putSnowfall(writer, snowfall);
  writer.put(std::uint32_t(state.poses.size()));
  for (const Pose& pose : state.poses) putPose(writer, pose);
  for (const Pose& pose : state.previous_poses) putPose(writer, pose);
  std::vector<TileChange> changes;
  const DormantGround dormant = dormantGround(state, base);
  for (const Tile* tile : state.tiles.sorted()) {
    const auto before = makeTile(tile->at, dormant, state.tick);
    changes.push_back(differenceOf(*tile, planesOf(*before), kDormantVersion));
  }
  writer.putBytes(encodeTiles(changes));
  return std::move(writer.bytes);
}

Result<WorldState> decodeSnapshot(std::span<const std::uint8_t> bytes, const PackId& id, const BaseTerrain& base) {
  ByteReader reader(bytes);
  WorldState state;
  state.pack_id = id;
  state.tick = reader.get<std::int32_t>();
  const auto state_hash = reader.get<std::uint64_t>();
  state.parameters = getParameters(reader);
  const auto crater_budget = reader.get<std::int64_t>();
  const auto event_budget = reader.get<std::int64_t>();
  for (const std::int64_t budget : {crater_budget, event_budget})
    if (budget > kBudgetLimit || budget < -kBudgetLimit)
      return Error{"snapshot: a budget of " + std::to_string(budget) + " is more than its tiles can hold"};
  if (Status status = validateParameters(base.pack(), state.parameters); !status)
    return Error{"snapshot: " + status.error()};
  if (Status status = readCraters(reader, base.pack(), state); !status) return Error{"snapshot: " + status.error()};
  if (Status status = readSnowfalls(reader, base.pack(), state); !status) return Error{"snapshot: " + status.error()};
  const std::size_t count = reader.get<std::uint32_t>();
  if (reader.failed() || state.tick < 0 || state.tick > 1 << 30) return Error{"snapshot: no tick"};
  if (count != base.pack().bodies.size() || count * 2 * kPoseBytes > reader.left())
    return Error{"snapshot: " + std::to_string(count) + " poses for " + std::to_string(base.pack().bodies.size()) +
                 " bodies"};
  for (std::size_t i = 0; i < count; ++i) state.poses.push_back(getPose(reader));
  for (std::size_t i = 0; i < count; ++i) state.previous_poses.push_back(getPose(reader));
  for (const auto* poses : {&state.poses, &state.previous_poses})
    if (Status status = validatePoses(base.pack(), *poses); !status) return Error{"snapshot: " + status.error()};
  auto changes = decodeTiles(reader.getBytes(reader.left()), base.pack(), kSnapshotTilesLimit);
  if (!changes) return Error{"snapshot: " + changes.error()};
  for (const TileChange& change : *changes)
    if (change.base_version != kDormantVersion || change.new_version > state.tick)
      return Error{"snapshot: a tile is not against the base"};
  if (Status status = applyTiles(state, base, *changes, state.tick, state.craters.size()); !status)
    return Error{"snapshot: " + status.error()};
  state.ledger.craters = crater_budget;
  state.ledger.events = event_budget;
  if (state.ledger.error() != 0) return Error{"snapshot: its ledger is off by " + std::to_string(state.ledger.error())};
  if (const std::uint64_t hash = stateHash(state); hash != state_hash)
    return Error{"snapshot: state hash " + hexText(hash) + " here, " + hexText(state_hash) + " announced"};
  return state;
}

}  // namespace spoor
