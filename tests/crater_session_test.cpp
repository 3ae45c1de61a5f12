// Craters made when they are looked at equal craters made at once: whole sessions with bodies that drive before,
// between and after, mirrors, snapshots, replays; and what is refused from outside.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <functional>
#include <random>

#include "shared/codec/session.h"
#include "tests/scenes.h"

namespace spoor::test {
namespace {

constexpr int kSize = rules::kTileSize;

/// 11 x 6 tiles, the last ones not whole, three bodies in the west. No slope gives way, or it
/// would wake its neighbours, and they theirs, to the east end of the map.
ScenePack drivenPack() {
  ScenePack pack = noisePack(650, 370, 21, -3000, 3000, 9000);
  pack.crater_limits = {.radius_q = 30000, .hash_cell_q = 11000};
  pack.parameters.sweeps_per_tick = 2;
  pack.parameters.materials[0].slope_threshold_q = pack.parameters.materials[0].diagonal_threshold_q = kNeverSteep;
  addBody(pack, boxMesh(9000, 6000, 4000), 70000, 60000, 700);
  addBody(pack, wedgeMesh(7000, 9000, 5000), 190000, 130000, 1500);
  addBody(pack, tetrahedronMesh(6000), 100000, 60000, 2000);
  return pack;
}

/// The input of a session.
struct Inputs {
  std::vector<std::vector<Pose>> poses;
  std::vector<std::vector<Crater>> craters;
};

/// Bodies that drive and stand, in turns of six ticks. Craters all over the map and some under the bodies: hundreds in
/// every ninth tick, a few or none in the others.
Inputs randomInputs(const World& world, int tick_count, int crater_count, std::uint32_t seed) {
  std::mt19937 engine(seed);
  Inputs inputs;
  std::vector<Pose> poses = initialState(world.id, world.base).poses;
  int left = crater_count;
  for (int tick = 0; tick < tick_count; ++tick) {
    if (tick / 6 % 2 == 0)
      poses = {moved(poses[0], 1100, 300), moved(poses[1], -700, -900), moved(poses[2], 100, 1400)};
    inputs.poses.push_back(poses);
    const int ticks_left = (tick_count - tick + 8) / 9;
    int count = tick % 9 == 1 ? left / ticks_left : int(engine() % 4);
    if (tick == tick_count - 1) count = left;
    inputs.craters.emplace_back();
    for (int i = 0; i < std::min(count, left); ++i) {
      Crater crater = randomCrater(world.pack, std::uint32_t(engine()), engine() % 8 == 0 ? 30000 : 6000);
      if (engine() % 50 == 0) {
        crater.x_q = poses[engine() % 3].x_q;
        crater.y_q = poses[0].y_q;
      }
      inputs.craters.back().push_back(crater);
    }
    left -= std::min(count, left);
  }
  return inputs;
}

/// What all craters do to every cell of a map as long as nobody is there: kept for all of it, crater by crater.
class EagerGround {
 public:
  explicit EagerGround(const World& world)
      : pack_(world.pack), cells_(std::size_t(pack_.width_cells) * std::size_t(pack_.height_cells)) {
    for (int y = 0; y < pack_.height_cells; ++y)
      for (int x = 0; x < pack_.width_cells; ++x) cells_[at(x, y)].base = world.base.height(x, y);
  }

  void add(const Crater& crater) {
    const rules::CraterShape shape = shapeOf(crater);
    const auto reach = int(crater.outerRadius() / pack_.cell_q + 2);
    const int centre_x = crater.x_q / pack_.cell_q, centre_y = crater.y_q / pack_.cell_q;
    for (int y = std::max(centre_y - reach, 0); y <= std::min(centre_y + reach, pack_.height_cells - 1); ++y)
      for (int x = std::max(centre_x - reach, 0); x <= std::min(centre_x + reach, pack_.width_cells - 1); ++x) {
        const int change = rules::craterDisplacement(shape, x * pack_.cell_q + pack_.cell_q / 2 - crater.x_q,
                                                     y * pack_.cell_q + pack_.cell_q / 2 - crater.y_q);
        Cell& cell = cells_[at(x, y)];
        if (change < 0) cell.depths -= change;
        if (change <= 0) continue;
        cell.rims += change;
        cell.highest = std::max({cell.highest, std::int64_t(change), std::int64_t(crater.rim_height_q)});
      }
  }

  std::int32_t height(int x, int y) const {
    if (x >= pack_.width_cells || y >= pack_.height_cells) return 0;
    const Cell& cell = cells_[at(x, y)];
    const std::int64_t ground = cell.base + std::min(cell.rims, cell.highest) - cell.depths;
    return std::int32_t(std::max(ground, std::int64_t(cell.base) - pack_.soil_depth_q));
  }

 private:
  struct Cell {
    std::int32_t base = 0;
    std::int64_t depths = 0, rims = 0, highest = 0;
  };
  std::size_t at(int x, int y) const { return std::size_t(y) * std::size_t(pack_.width_cells) + std::size_t(x); }

  const ScenePack& pack_;
  std::vector<Cell> cells_;
};

/// Somebody who looks at dormant ground now and then, one way or the other.
class Onlooker {
 public:
  explicit Onlooker(const World& world) : world_(world), extent_(tileExtent(world.pack)) {}

  void look(const WorldState& state) {
    const DormantGround dormant{&world_.base, &state.craters};
    PlaneCells heights;
    for (int i = int(engine_() % 4); i > 0; --i) {
      const TileCoordinate at{int(engine_() % std::uint32_t(extent_.x)), int(engine_() % std::uint32_t(extent_.y))};
      if (engine_() % 2 == 0) {
        dormant.fillHeights(at, heights);
      } else {
        heights = makeTile(at, dormant, state.tick)->height();
      }
      seen_ += heights[engine_() % heights.size()];
    }
  }

  std::int64_t seen() const { return seen_; }

 private:
  const World& world_;
  TileCoordinate extent_;
  std::mt19937 engine_{17};
  std::int64_t seen_ = 0;
};

void checkDormant(const World& world, const WorldState& state, const EagerGround& eager) {
  const DormantGround dormant{&world.base, &state.craters};
  const TileCoordinate extent = tileExtent(world.pack);
  PlaneCells heights;
  for (int y = 0; y < extent.y; ++y)
    for (int x = 0; x < extent.x; ++x) {
      dormant.fillHeights({x, y}, heights);
      for (int i = 0; i < rules::kTileCells; ++i)
        ASSERT_EQ(heights[std::size_t(i)], eager.height(x * kSize + i % kSize, y * kSize + i / kSize))
            << "tick " << state.tick << ", cell " << x * kSize + i % kSize << ", " << y * kSize + i / kSize;
    }
}

struct Recorded {
  std::vector<TickUpdate> updates;
  std::vector<Ledger> ledgers;
  std::vector<std::uint8_t> snapshot;  // halfway
};

/// Runs a session to which nobody looks.
Recorded runUnseen(Simulation simulation, const World& world, const Inputs& inputs) {
  Recorded recorded;
  for (std::size_t i = 0; i < inputs.poses.size(); ++i) {
    auto result = simulation.step(inputs.poses[i], {}, inputs.craters[i]);
    EXPECT_TRUE(result) << result.error();
    if (!result) break;
    EXPECT_EQ(result->ledger.error(), 0) << "tick " << i + 1;
    recorded.ledgers.push_back(result->ledger);
    recorded.updates.push_back(std::move(result->update));
    if (i == inputs.poses.size() / 2) recorded.snapshot = encodeSnapshot(simulation.state(), world.base);
  }
  EXPECT_TRUE(recount(simulation.state()));
  return recorded;
}

/// The session on one native thread: what all else is compared with. Run once.
struct Reference {
  World world{drivenPack()};
  Inputs inputs = randomInputs(world, 36, 10000, 31);
  Recorded recorded = runUnseen(world.simulate(), world, inputs);
};
const Reference& reference() {
  static const Reference kept;
  return kept;
}

class CraterSession : public OnEveryBackend {};

TEST_P(CraterSession, LookedAtAllTheTimeEqualsNeverLookedAtAndCratersMadeAtOnce) {
  const Reference& wanted = reference();
  Simulation simulation = wanted.world.simulateOn(GetParam());
  EagerGround eager(wanted.world);
  Onlooker onlooker(wanted.world);
  const std::size_t tick_count = GetParam().slow() ? 10 : wanted.inputs.poses.size();
  std::size_t crater_count = 0;
  for (std::size_t i = 0; i < tick_count; ++i) {
    const auto result = simulation.step(wanted.inputs.poses[i], {}, wanted.inputs.craters[i]);
    ASSERT_TRUE(result) << result.error();
    ASSERT_EQ(result->update.state_hash, wanted.recorded.updates[i].state_hash) << "tick " << i + 1;
    ASSERT_EQ(result->update.tiles, wanted.recorded.updates[i].tiles) << "tick " << i + 1;
    ASSERT_EQ(result->ledger, wanted.recorded.ledgers[i]);
    ASSERT_EQ(result->ledger.error(), 0);
    for (const Crater& crater : result->update.craters) eager.add(crater);
    crater_count += result->update.craters.size();
    onlooker.look(simulation.state());
    if (i % 9 == 4) {
      ASSERT_NO_FATAL_FAILURE(checkDormant(wanted.world, simulation.state(), eager));
    }
  }
  ASSERT_NO_FATAL_FAILURE(checkDormant(wanted.world, simulation.state(), eager));
  std::printf("%zu tiles are live\n", simulation.state().tiles.size());
  EXPECT_TRUE(recount(simulation.state()));
  EXPECT_NE(onlooker.seen(), 0);
  EXPECT_NE(simulation.state().ledger.craters, 0);
  const TileCoordinate extent = tileExtent(wanted.world.pack);
  EXPECT_LT(simulation.state().tiles.size(), std::size_t(extent.x) * std::size_t(extent.y)) << "some are dormant";
  if (tick_count == wanted.inputs.poses.size()) {
    EXPECT_EQ(crater_count, 10000u);
  }
}

TEST_P(CraterSession, EqualsTheOracle) {
  ScenePack pack = noisePack(200, 140, 22, -3000, 3000, 4000);
  pack.crater_limits = {.radius_q = 30000, .hash_cell_q = 9000};
  pack.parameters.sweeps_per_tick = 3;
  for (int i = 0; i < 3; ++i) addBody(pack, boxMesh(5000, 5000, 3000), 30000 + i * 20000, 70000 - i * 20000, 700);
  const World world(std::move(pack));
  const Inputs inputs = randomInputs(world, GetParam().slow() ? 6 : 20, 250, 33);
  Simulation simulation = world.simulateOn(GetParam());
  Oracle oracle(world.base, world.id);
  const DormantGround dormant{&world.base, &simulation.state().craters};
  for (std::size_t i = 0; i < inputs.poses.size(); ++i) {
    const auto result = simulation.step(inputs.poses[i], {}, inputs.craters[i]);
    ASSERT_TRUE(result) << result.error();
    oracle.step(inputs.poses[i], {}, inputs.craters[i]);
    ASSERT_TRUE(sameState(simulation.state(), oracle)) << "tick " << result->update.tick;
    const DenseWorld& dense = oracle.world();
    for (int y = 0; y < dense.inside_rows; y += 3)
      for (int x = 0; x < dense.inside_columns; x += 5) {
        if (oracle.isLive({x / kSize, y / kSize})) continue;
        ASSERT_EQ(dormant.height(x, y), dense.height[dense.at(x, y)]) << x << ", " << y;
      }
  }
}

SPOOR_ON_EVERY_BACKEND(CraterSession);

TEST(CraterMirror, FromTheStartAndOneThatJoinsLateHoldTheSameGround) {
  const Reference& server = reference();
  WorldState from_start = initialState(server.world.id, server.world.base);
  auto late = decodeSnapshot(server.recorded.snapshot, server.world.id, server.world.base);
  ASSERT_TRUE(late) << late.error();
  EagerGround eager(server.world);
  for (const TickUpdate& update : server.recorded.updates) {
    for (const Crater& crater : update.craters) eager.add(crater);
    Status status = applyTick(from_start, server.world.base, update);
    ASSERT_TRUE(status) << status.error();
    ASSERT_EQ(from_start.ledger, server.recorded.ledgers[std::size_t(update.tick) - 1]);
    if (update.tick <= late->tick) continue;
    status = applyTick(*late, server.world.base, update);
    ASSERT_TRUE(status) << status.error();
    ASSERT_EQ(late->ledger, from_start.ledger);
  }
  for (const WorldState* state : {&from_start, &*late}) {
    EXPECT_EQ(stateHash(*state), server.recorded.updates.back().state_hash);
    EXPECT_TRUE(recount(*state));
    EXPECT_EQ(state->craters.size(), 10000u);
    ASSERT_NO_FATAL_FAILURE(checkDormant(server.world, *state, eager));
  }
}

TEST(CraterMirror, ASnapshotHoldsEveryRecordAndEncodesTheSameAgain) {
  const Reference& server = reference();
  const auto state = decodeSnapshot(server.recorded.snapshot, server.world.id, server.world.base);
  ASSERT_TRUE(state) << state.error();
  EXPECT_EQ(encodeSnapshot(*state, server.world.base), server.recorded.snapshot);
  std::vector<Crater> expected;
  for (const TickUpdate& update : server.recorded.updates)
    if (update.tick <= state->tick) expected.insert(expected.end(), update.craters.begin(), update.craters.end());
  EXPECT_TRUE(std::ranges::equal(state->craters.records(), expected));
  EXPECT_NE(state->ledger.craters, 0);
}

TEST(CraterReplay, OfASessionFileHasTheRecordedHashesAndLedgers) {
  const Reference& server = reference();
  const std::filesystem::path path =
      std::filesystem::path(::testing::TempDir()) / ("spoor_craters_" + std::to_string(getpid()) + ".sprs");
  {
    auto writer = SessionWriter::create(path.string(), encodePack(server.world.pack));
    ASSERT_TRUE(writer) << writer.error();
    for (std::size_t i = 0; i < server.recorded.updates.size(); ++i) {
      const TickUpdate& update = server.recorded.updates[i];
      (*writer)->append({.tick = update.tick,
                         .poses = update.poses,
                         .state_hash = update.state_hash,
                         .ledger = server.recorded.ledgers[i],
                         .craters = update.craters});
    }
    ASSERT_TRUE((*writer)->close());
  }
  auto reader = SessionReader::open(path.string());
  ASSERT_TRUE(reader) << reader.error();
  const BaseTerrain base((*reader)->pack());
  Simulation replay(base, (*reader)->id(), makeNativeBackend({.thread_count = 2}));
  for (std::size_t i = 0; i < server.recorded.updates.size(); ++i) {
    const auto record = (*reader)->next();
    ASSERT_TRUE(record && record->has_value());
    ASSERT_EQ((*record)->craters, server.recorded.updates[i].craters);
    const auto result = replay.step((*record)->poses, (*record)->parameters, (*record)->craters);
    ASSERT_TRUE(result) << result.error();
    ASSERT_EQ(result->update.state_hash, (*record)->state_hash) << "tick " << i + 1;
    ASSERT_EQ(result->ledger, (*record)->ledger);
  }
  std::filesystem::remove(path);
}

/// A short session whose third tick brings craters to live tiles and dormant ones.
class HostileCraters : public ::testing::Test {
 protected:
  HostileCraters() : inputs_(randomInputs(world_, 3, 0, 1)) {
    inputs_.craters[1] = {randomCrater(world_.pack, 5, 20000)};
    Crater near{.x_q = 70000,
                .y_q = 60000,
                .inner_radius_q = 1000,
                .crest_radius_q = 8000,
                .rim_height_q = 900,
                .depth_q = 2000};
    inputs_.craters[2] = {near, near};
    inputs_.craters[2][1].x_q = 290000;
    Simulation simulation = world_.simulate();
    for (std::size_t i = 0; i < 3; ++i) {
      if (i == 2) before_ = encodeSnapshot(simulation.state(), world_.base);
      good_ = simulation.step(inputs_.poses[i], {}, inputs_.craters[i])->update;
    }
    after_ = encodeSnapshot(simulation.state(), world_.base);
  }

  /// What applyTick says of a changed update; checks that it left the state as it was, and that the good one still
  /// works.
  std::string refusal(const std::function<void(TickUpdate&)>& change) const {
    auto decoded = decodeSnapshot(before_, world_.id, world_.base);
    WorldState& state = *decoded;
    const std::uint64_t hash = stateHash(state);
    const Ledger ledger = state.ledger;
    TickUpdate update = good_;
    change(update);
    const Status refused = applyTick(state, world_.base, update);
    EXPECT_FALSE(refused);
    EXPECT_EQ(stateHash(state), hash);
    EXPECT_EQ(state.ledger, ledger);
    EXPECT_EQ(state.craters.size(), 1u);
    EXPECT_TRUE(recount(state));
    EXPECT_EQ(encodeSnapshot(state, world_.base), before_);
    const Status good = applyTick(state, world_.base, good_);
    EXPECT_TRUE(good) << good.error();
    EXPECT_EQ(encodeSnapshot(state, world_.base), after_);
    return refused ? "" : refused.error();
  }

  World world_{drivenPack()};
  Inputs inputs_;
  TickUpdate good_;
  std::vector<std::uint8_t> before_, after_;  // snapshots
};

TEST_F(HostileCraters, WithAnotherIdTickOrSizeAreRefusedAndLeaveTheStateAsItWas) {
  const auto says = [this](const char* words, const std::function<void(TickUpdate&)>& change) {
    const std::string said = refusal(change);
    EXPECT_NE(said.find(words), std::string::npos) << said;
  };
  says("tick 3: crater 1 has another id or tick", [](TickUpdate& u) { u.craters[0].id = 0; });
  says("tick 3: crater 2 has another id or tick", [](TickUpdate& u) { u.craters[1].id = 1; });
  says("tick 3: crater 2 has another id or tick", [](TickUpdate& u) { u.craters[1].id = UINT32_MAX; });
  says("tick 3: crater 1 has another id or tick", [](TickUpdate& u) { u.craters[0].tick = 2; });
  says("tick 3: crater 1 has another id or tick", [](TickUpdate& u) { std::swap(u.craters[0], u.craters[1]); });
  says("tick 3: crater: R2 is 0 m, not above 0", [](TickUpdate& u) { u.craters[1].crest_radius_q = 0; });
  says("crater: R3 = 2 R2 - R1 is ", [](TickUpdate& u) { u.craters[1].crest_radius_q = INT32_MAX; });
  says("crater: D5 is ", [](TickUpdate& u) { u.craters[1].depth_q = INT32_MIN; });
  says("all of it lies off the map", [](TickUpdate& u) { u.craters[1].x_q = INT32_MAX; });
  says("65537 craters in one tick", [](TickUpdate& u) { u.craters.resize(65537, u.craters[0]); });
}

TEST_F(HostileCraters, ThatTheTilesDoNotBearOutAreRefused) {
  EXPECT_NE(refusal([](TickUpdate& u) { u.craters.clear(); }).find(": hash "), std::string::npos);
  EXPECT_NE(refusal([](TickUpdate& u) { ++u.craters[0].depth_q; }).find(": hash "), std::string::npos);
  EXPECT_NE(refusal([](TickUpdate& u) { u.craters[0].noise_q16 = 65535; }).find(": hash "), std::string::npos);
}

TEST_F(HostileCraters, OnALiveTileThatTheUpdateLeavesOutAreRefused) {
  auto changes = decodeTiles(good_.tiles, world_.pack);
  ASSERT_TRUE(changes);
  ASSERT_FALSE(changes->empty());
  const auto live = std::ranges::find_if(*changes, [](const TileChange& c) { return c.at == TileCoordinate{1, 0}; });
  ASSERT_NE(live, changes->end());
  ASSERT_NE(live->base_version, kDormantVersion);
  changes->erase(live);
  const std::string said = refusal([&](TickUpdate& u) { u.tiles = encodeTiles(*changes); });
  EXPECT_NE(said.find("a new crater meets it, and it is left out"), std::string::npos) << said;
}

TEST_F(HostileCraters, InASnapshotAreRefused) {
  const auto said = [this](const std::vector<std::uint8_t>& bytes) {
    const auto state = decodeSnapshot(bytes, world_.id, world_.base);
    return state ? std::string() : state.error();
  };
  ASSERT_EQ(said(after_), "");
  // Tick, hash and parameters; then the budgets of craters and events, the count and the records.
  constexpr std::size_t kBudget = 4 + 8 + parametersBytes(1), kCount = kBudget + 16, kRecords = kCount + 4;
  const auto changed = [this](std::size_t at, auto value) {
    std::vector<std::uint8_t> bytes = after_;
    std::memcpy(bytes.data() + at, &value, sizeof value);
    return bytes;
  };
  std::uint32_t count = 0;
  std::memcpy(&count, after_.data() + kCount, sizeof count);
  ASSERT_EQ(count, 3u);
  EXPECT_EQ(said(changed(kCount, UINT32_MAX)), "snapshot: 4294967295 craters announced, more than there can be");
  EXPECT_EQ(said(changed(kCount, std::uint32_t(1) << 20)),
            "snapshot: 1048576 craters announced, more than there can be");
  for (const std::uint32_t wrong : {0u, 1u, 2u, 4u, 5u}) EXPECT_NE(said(changed(kCount, wrong)), "") << wrong;
  const auto record = [](std::size_t i, std::size_t offset) { return kRecords + i * kCraterBytes + offset; };
  EXPECT_EQ(said(changed(record(1, 32), std::uint32_t(7))), "snapshot: crater 1 is out of order");
  EXPECT_EQ(said(changed(record(2, 28), std::int32_t(1))), "snapshot: crater 2 is out of order");
  EXPECT_EQ(said(changed(record(2, 28), std::int32_t(4))), "snapshot: crater 2 is out of order");
  EXPECT_EQ(said(changed(record(0, 28), std::int32_t(0))), "snapshot: crater 0 is out of order");
  EXPECT_EQ(said(changed(record(1, 12), std::int32_t(-4))), "snapshot: crater 1: crater: R2 is -0.0004 m, not above 0");
  EXPECT_NE(said(changed(record(1, 0), std::int32_t(70001))), "") << "another place has another hash";
  std::int64_t budget = 0;
  std::memcpy(&budget, after_.data() + kBudget, sizeof budget);
  EXPECT_EQ(said(changed(kBudget, budget + 5)), "snapshot: its ledger is off by 5");
  for (const std::int64_t hostile : {INT64_MAX, INT64_MIN}) {
    EXPECT_NE(said(changed(kBudget, hostile)), "");
    std::vector<std::uint8_t> both = changed(kBudget, hostile);
    std::memcpy(both.data() + kBudget + 8, &hostile, sizeof hostile);
    EXPECT_NE(said(both), "");
  }
  for (std::size_t size = 0; size < after_.size(); size += size < kRecords + 200 ? 1 : 97)
    ASSERT_NE(said(std::vector(after_.begin(), after_.begin() + std::ptrdiff_t(size))), "") << size;
}

}  // namespace
}  // namespace spoor::test
