// Craters where it hurts, on every backend and against the oracle: a thousand on one spot, two at once, under a body,
// on the border of what is live, far from everybody, after all is asleep, too many.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>

#include "tests/scenes.h"

namespace spoor::test {
namespace {

constexpr int kSize = rules::kTileSize;

/// Level ground of 10 m soil, where the craters that a test wants are allowed.
ScenePack levelPack(int width, int height) {
  ScenePack pack = flatPack(width, height);
  pack.crater_limits = {.radius_q = 60000, .hash_cell_q = 20000};
  return pack;
}

Crater craterAt(int x_q, int y_q, int crest_radius_q, int rim_height_q, int depth_q) {
  return {.x_q = x_q,
          .y_q = y_q,
          .inner_radius_q = crest_radius_q / 3,
          .crest_radius_q = crest_radius_q,
          .rim_height_q = rim_height_q,
          .depth_q = depth_q};
}

class CraterHardCase : public OnEveryBackend {
 protected:
  /// Starts a session, and the oracle's of the same.
  void start(ScenePack pack) {
    world_ = std::make_unique<World>(std::move(pack));
    simulation_.emplace(world_->simulateOn(GetParam()));
    oracle_.emplace(world_->base, world_->id);
    poses_ = simulation_->state().poses;
  }

  /// One tick on both, which must be the same with every grain accounted for.
  void step(const std::vector<Crater>& craters = {}) {
    const auto result = simulation_->step(poses_, {}, craters);
    ASSERT_TRUE(result) << result.error();
    active_cells_ = result->effect.active_cells;
    ASSERT_EQ(result->ledger.error(), 0) << "tick " << result->update.tick;
    oracle_->step(poses_, {}, craters);
    ASSERT_TRUE(sameState(simulation_->state(), *oracle_)) << "tick " << result->update.tick;
    ASSERT_TRUE(recount(simulation_->state()));
  }

  /// The first tick, and what follows until all is at rest, with the body lifted off the ground.
  void restWithoutBody() {
    ASSERT_NO_FATAL_FAILURE(step());
    poses_[0].z_q += 90000;
    ASSERT_NO_FATAL_FAILURE(step());
    ASSERT_NO_FATAL_FAILURE(untilAllSleep());
  }

  void untilAllSleep() {
    for (int tick = 0; !simulation_->state().tiles.awake().empty(); ++tick) {
      ASSERT_LT(tick, 300) << "does not come to rest";
      ASSERT_NO_FATAL_FAILURE(step());
    }
  }

  const WorldState& state() const { return simulation_->state(); }
  const Tile* tileAt(int x, int y) const { return state().tiles.find({x, y}); }
  int height(int x, int y) const { return heightOf(state(), x, y); }

  std::unique_ptr<World> world_;
  std::optional<Simulation> simulation_;
  std::optional<Oracle> oracle_;
  std::vector<Pose> poses_;
  std::int64_t active_cells_ = 0;  // of the last tick
};

TEST_P(CraterHardCase, AThousandOnOneSpotInOneTickReachBedrockAndNoFurther) {
  ScenePack pack = levelPack(70, 66);
  pack.parameters.materials[0].slope_threshold_q = pack.parameters.materials[0].diagonal_threshold_q = kNeverSteep;
  addBody(pack, boxMesh(2000, 2000, 2000), 5000, 5000, 300);
  start(std::move(pack));
  ASSERT_NO_FATAL_FAILURE(step());
  const auto before = std::chrono::steady_clock::now();
  const std::vector<Crater> salvo(1000, craterAt(40500, 30500, 9000, 400, rules::kCraterHeightLimit));
  ASSERT_NO_FATAL_FAILURE(step(salvo));
  EXPECT_LT(std::chrono::steady_clock::now() - before, std::chrono::seconds(20));
  EXPECT_EQ(height(40, 30), -100000) << "bedrock";
  EXPECT_EQ(height(40 + 9, 30), 400) << "at the crest rims do not add up";
  EXPECT_EQ(height(40 + 16, 30), 0) << "beyond the end";
  EXPECT_EQ(state().craters.size(), 1000u);
  ASSERT_NO_FATAL_FAILURE(step(salvo));
  EXPECT_EQ(height(40, 30), -100000) << "sums at their limit change nothing any more";
  EXPECT_EQ(height(40 + 9, 30), 400);
}

TEST_P(CraterHardCase, AThousandOnOneSpotOneAfterAnotherEqualThoseOfOneTick) {
  ScenePack pack = levelPack(70, 66);
  pack.parameters.materials[0].slope_threshold_q = pack.parameters.materials[0].diagonal_threshold_q = kNeverSteep;
  addBody(pack, boxMesh(2000, 2000, 2000), 5000, 5000, 300);
  const World world(std::move(pack));
  const std::vector<Crater> salvo(GetParam().slow() ? 100 : 1000, craterAt(40500, 30500, 2500, 400, 110));
  Simulation at_once = world.simulateOn(GetParam()), one_by_one = world.simulateOn(GetParam());
  const std::vector<Pose> poses = at_once.state().poses;
  ASSERT_TRUE(at_once.step(poses) && one_by_one.step(poses));
  ASSERT_TRUE(at_once.step(poses, {}, salvo));
  for (const Crater& crater : salvo) {
    const auto result = one_by_one.step(poses, {}, {&crater, 1});
    ASSERT_TRUE(result) << result.error();
    ASSERT_EQ(result->ledger.error(), 0);
  }
  EXPECT_EQ(heightOf(at_once.state(), 40, 30), std::max(-100000, -110 * int(salvo.size())));
  for (const Tile* tile : at_once.state().tiles.sorted()) {
    const Tile* other = one_by_one.state().tiles.find(tile->at);
    ASSERT_NE(other, nullptr);
    EXPECT_EQ(tile->height(), other->height()) << tile->at.x << ", " << tile->at.y;
  }
  EXPECT_EQ(at_once.state().ledger.craters, one_by_one.state().ledger.craters);
  EXPECT_TRUE(recount(one_by_one.state()));
}

TEST_P(CraterHardCase, TwoAtTheSameTickAndPlaceAreTwiceAsDeepWithARimOnce) {
  ScenePack pack = levelPack(70, 66);
  pack.parameters.materials[0].slope_threshold_q = pack.parameters.materials[0].diagonal_threshold_q = kNeverSteep;
  addBody(pack, boxMesh(2000, 2000, 2000), 5000, 5000, 300);
  start(std::move(pack));
  ASSERT_NO_FATAL_FAILURE(step());
  const Crater crater = craterAt(40500, 30500, 9000, 400, 2000);
  ASSERT_NO_FATAL_FAILURE(step({crater, crater}));
  EXPECT_EQ(height(40, 30), -4000);
  EXPECT_EQ(height(49, 30), 400);
  EXPECT_EQ(height(40, 21), 400);
}

TEST_P(CraterHardCase, UnderABodyThatStandsTheSoilIsGoneAndTheRimIsPushedAside) {
  ScenePack pack = levelPack(140, 130);
  addBody(pack, boxMesh(12000, 12000, 4000), 40500, 40500, 600);
  start(std::move(pack));
  ASSERT_NO_FATAL_FAILURE(step());
  ASSERT_NO_FATAL_FAILURE(untilAllSleep());
  EXPECT_EQ(height(40, 40), -600) << "pressed down";
  // Deep beneath it, with a crest that rises under its edge.
  ASSERT_NO_FATAL_FAILURE(step({craterAt(40500, 40500, 5000, 500, 6000)}));
  EXPECT_GT(active_cells_, 0) << "the body takes part again";
  EXPECT_LT(height(40, 40), -2000);
  for (int y = 35; y <= 46; ++y)
    for (int x = 35; x <= 46; ++x) EXPECT_LE(height(x, y), -600) << "no rim within the body, at " << x << ", " << y;
  ASSERT_NO_FATAL_FAILURE(untilAllSleep());
  EXPECT_NE(state().ledger.craters, 0);
}

TEST_P(CraterHardCase, OnTheBorderOfLiveGroundWakesTheNeighbourWhereItRelaxes) {
  ScenePack pack = levelPack(3 * kSize, 2 * kSize);
  addBody(pack, boxMesh(2000, 2000, 2000), 10500, 30500, 300);
  start(std::move(pack));
  ASSERT_NO_FATAL_FAILURE(restWithoutBody());
  ASSERT_NE(tileAt(0, 0), nullptr);
  ASSERT_EQ(tileAt(1, 0), nullptr);
  // Its centre is on the border; its walls are steeper than what rests.
  ASSERT_NO_FATAL_FAILURE(step({craterAt(64000, 30500, 8000, 2000, 9000)}));
  EXPECT_EQ(tileAt(1, 0), nullptr) << "dormant ground has the crater, and is not live for it";
  EXPECT_NE(tileAt(0, 0)->wake_mask & 1 << 5, 0) << "the neighbour is woken for the next tick";
  const DormantGround dormant{&world_->base, &state().craters};
  EXPECT_LT(dormant.height(64, 30), -8000);
  const std::int64_t budget_before = state().ledger.craters;
  ASSERT_NO_FATAL_FAILURE(step());
  ASSERT_NE(tileAt(1, 0), nullptr) << "it became live";
  EXPECT_NE(state().ledger.craters, budget_before) << "and brought its share of the crater";
  ASSERT_NO_FATAL_FAILURE(untilAllSleep());
  EXPECT_EQ(steepestExcess(world_->pack, state().tiles), 0) << "across the border too";
  EXPECT_GT(height(64, 30), -9000) << "its walls have slid";
}

TEST_P(CraterHardCase, OfNoHeightStillWakesWhatItMeetsAndThatIsAll) {
  ScenePack pack = levelPack(140, 130);
  addBody(pack, boxMesh(2000, 2000, 2000), 10500, 10500, 300);
  start(std::move(pack));
  ASSERT_NO_FATAL_FAILURE(step());
  ASSERT_NO_FATAL_FAILURE(untilAllSleep());
  const std::uint64_t tiles_hash = tileHash(*tileAt(0, 0));
  ASSERT_NO_FATAL_FAILURE(step({craterAt(30500, 30500, 5000, 0, 0)}));
  EXPECT_EQ(active_cells_, rules::kTileCells);
  EXPECT_EQ(tileHash(*tileAt(0, 0)), tiles_hash);
  EXPECT_EQ(tileAt(0, 0)->wake_mask, kWakeSelf);
  ASSERT_NO_FATAL_FAILURE(step());
  EXPECT_TRUE(state().tiles.awake().empty());
}

TEST_P(CraterHardCase, FiftyKilometresAwayCostsARecordAndNothingElse) {
  ScenePack pack = flatPack(600000, 200);
  pack.crater_limits = {.radius_q = 300000, .hash_cell_q = 750000};
  addBody(pack, boxMesh(5000, 3000, 3000), 30000, 100000, 500);
  const World world(std::move(pack));
  Simulation near = world.simulateOn(GetParam()), both = world.simulateOn(GetParam());
  std::vector<Pose> poses = near.state().poses;
  const Crater far = craterAt(530000000, 100000, 100000, 9000, 50000);
  for (int tick = 1; tick <= 8; ++tick) {
    poses[0] = moved(poses[0], 1500, 0);
    std::vector<Crater> craters;
    if (tick % 2 == 0) craters.push_back(far);
    const auto expected = near.step(poses), result = both.step(poses, {}, craters);
    ASSERT_TRUE(expected && result) << result.error();
    ASSERT_EQ(result->effect.active_cells, expected->effect.active_cells);
    ASSERT_EQ(result->update.tiles, expected->update.tiles);
    ASSERT_EQ(result->ledger, expected->ledger);
    ASSERT_NE(result->update.state_hash == expected->update.state_hash, !both.state().craters.records().empty());
  }
  EXPECT_EQ(both.state().tiles.size(), near.state().tiles.size());
  EXPECT_EQ(both.state().tiles.memoryBytes(), near.state().tiles.memoryBytes());
  EXPECT_EQ(both.state().tiles.awake().size(), near.state().tiles.awake().size());
  EXPECT_EQ(both.state().tiles_hash, near.state().tiles_hash);
  // Four records, each in up to four hash cells, and the least table there is.
  EXPECT_EQ(both.state().craters.size(), 4u);
  EXPECT_LE(both.state().craters.memoryBytes(), 4096u);
  const DormantGround dormant{&world.base, &both.state().craters};
  EXPECT_EQ(dormant.height(530000, 100), -100000) << "four of 5 m each, down to bedrock at 10 m";
}

TEST_P(CraterHardCase, AfterAllIsAsleepWakesTheGroundAndItComesToRestAgain) {
  ScenePack pack = levelPack(140, 130);
  addBody(pack, boxMesh(3000, 3000, 3000), 40500, 40500, 500);
  start(std::move(pack));
  ASSERT_NO_FATAL_FAILURE(restWithoutBody());
  ASSERT_NO_FATAL_FAILURE(step());
  ASSERT_EQ(active_cells_, 0);
  ASSERT_NO_FATAL_FAILURE(step({craterAt(20500, 20500, 6000, 2500, 7000)}));
  EXPECT_GE(active_cells_, rules::kTileCells);
  EXPECT_FALSE(state().tiles.awake().empty());
  ASSERT_NO_FATAL_FAILURE(untilAllSleep());
  EXPECT_EQ(steepestExcess(world_->pack, state().tiles), 0);
  ASSERT_NO_FATAL_FAILURE(step());
  EXPECT_EQ(active_cells_, 0);
}

TEST_P(CraterHardCase, OverDormantGroundOfAMapWithoutBodiesMakesNothingLive) {
  start(levelPack(200, 130));
  for (int tick = 0; tick < 3; ++tick)
    ASSERT_NO_FATAL_FAILURE(step({craterAt(60000 + tick * 20000, 60000, 20000, 2000, 9000)}));
  EXPECT_EQ(state().tiles.size(), 0u);
  EXPECT_EQ(state().ledger, Ledger{});
  EXPECT_EQ(state().craters.size(), 3u);
}

TEST_P(CraterHardCase, OverTheBorderAndAtTheHeightLimit) {
  std::vector<std::int32_t> ground(70 * 66, (1 << 29) + (1 << 28) - 1);
  ScenePack pack = groundPack(70, 66, ground, (1 << 28) - 1);
  pack.crater_limits = {.radius_q = 60000, .hash_cell_q = 20000};
  pack.parameters.materials[0].slope_threshold_q = pack.parameters.materials[0].diagonal_threshold_q = kNeverSteep;
  addBody(pack, boxMesh(2000, 2000, 2000), 35000, 33000, 300);
  start(std::move(pack));
  ASSERT_NO_FATAL_FAILURE(step());
  Crater corner = craterAt(-5000, -5000, 20000, 1 << 20, 1 << 20), edge = craterAt(70000, 30000, 9000, 1 << 20, 0);
  edge.noise_q16 = corner.noise_q16 = 65535;
  ASSERT_NO_FATAL_FAILURE(step({corner, edge}));
  ASSERT_NO_FATAL_FAILURE(step({craterAt(70000 + 20000, 70000, 20001, 500, 500)}));
}

TEST_P(CraterHardCase, ThatCannotBeAreRefusedAndTheStateStaysAsItWas) {
  ScenePack pack = levelPack(140, 130);
  addBody(pack, boxMesh(2000, 2000, 2000), 40500, 40500, 300);
  start(std::move(pack));
  const Crater good = craterAt(40500, 40500, 6000, 500, 1000);
  ASSERT_NO_FATAL_FAILURE(step({good}));
  const std::uint64_t hash = stateHash(state());
  const auto bytes = encodeSnapshot(state(), world_->base);
  Crater huge = good;
  huge.crest_radius_q = INT32_MAX;
  Crater off_map = good;
  off_map.y_q = INT32_MIN;
  Crater no_radius = good;
  no_radius.crest_radius_q = no_radius.inner_radius_q = 0;
  const std::pair<std::vector<Crater>, const char*> wrong[] = {
      {std::vector<Crater>(kTickCratersLimit + 1, good), "65537 craters in one tick, the limit is 65536"},
      {{good, huge}, "the scene allows 6 m"},
      {{good, good, off_map}, "all of it lies off the map"},
      {{no_radius}, "R2 is 0 m"}};
  for (const auto& [craters, words] : wrong) {
    const auto refused = simulation_->step(poses_, {}, craters);
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().find(words), std::string::npos) << refused.error();
    EXPECT_EQ(stateHash(state()), hash);
    EXPECT_EQ(encodeSnapshot(state(), world_->base), bytes);
  }
  ASSERT_NO_FATAL_FAILURE(step({good}));
}

SPOOR_ON_EVERY_BACKEND(CraterHardCase);

}  // namespace
}  // namespace spoor::test
