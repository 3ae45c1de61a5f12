// Whole ticks: the native backend against the oracle, on random worlds and bodies.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/scenes.h"

namespace spoor::test {
namespace {

constexpr int kTicks = 20;

/// No soil under bedrock; nothing above a body's underside but what found no room.
void checkCells(const World& world, const Oracle& oracle) {
  const DenseWorld& cells = oracle.world();
  for (std::size_t i = 0; i < cells.height.size(); ++i) ASSERT_GE(cells.height[i], cells.bedrock[i]) << "cell " << i;
  if (oracle.activeTiles().empty()) return;
  const auto overlap = oracleOverlap(cells, world.pack.obstacle_threshold_q);
  for (std::size_t i = 0; i < overlap.size(); ++i) {
    const bool fine = overlap[i] <= 0 || std::ranges::binary_search(oracle.crowdedCells(), i);
    ASSERT_TRUE(fine) << "cell " << i << " reaches into a body";
  }
}

void checkWorld(std::uint32_t seed) {
  RandomWorld random = randomWorld(seed, kTicks);
  SCOPED_TRACE(random.description);
  const World world(std::move(random.pack));
  Simulation simulation = world.simulate({.thread_count = 1 + int(seed % 3)});
  Oracle oracle(world.base, world.id);
  for (const auto& poses : random.ticks) {
    const auto result = simulation.step(poses);
    ASSERT_TRUE(result) << result.error();
    oracle.step(poses);
    ASSERT_TRUE(sameState(simulation.state(), oracle)) << "tick " << result->update.tick;
    ASSERT_EQ(simulation.state().ledger.error(), 0) << "tick " << result->update.tick;
    ASSERT_EQ(result->effect.active_cells, std::int64_t(oracle.activeTiles().size()) * rules::kTileCells);
    ASSERT_NO_FATAL_FAILURE(checkCells(world, oracle));
  }
  EXPECT_TRUE(recount(simulation.state()));
}

class RandomWorlds : public ::testing::TestWithParam<std::uint32_t> {};

TEST_P(RandomWorlds, NativeEqualsTheOracleAndKeepsEveryGrain) {
  for (std::uint32_t i = 0; i < 20 && !HasFatalFailure(); ++i) checkWorld(GetParam() * 20 + i);
}

/// Runs poses on both and compares after every tick.
void checkTicks(const World& world, const std::vector<std::vector<Pose>>& ticks) {
  Simulation simulation = world.simulate();
  Oracle oracle(world.base, world.id);
  for (const auto& poses : ticks) {
    ASSERT_TRUE(simulation.step(poses));
    oracle.step(poses);
    ASSERT_TRUE(sameState(simulation.state(), oracle)) << "tick " << simulation.state().tick;
    ASSERT_NO_FATAL_FAILURE(checkCells(world, oracle));
  }
}

TEST(Tick, AJoinedDomainReachesTilesThatNoBodyDoes) {
  // Two bars that form an L over three tiles: the box of both reaches into the fourth, in its open corner.
  ScenePack pack = flatPack(200, 200);
  addBody(pack, boxMesh(80000, 4000, 3000), 60000, 10000, 500);
  addBody(pack, boxMesh(4000, 80000, 3000), 100000, 50000, 500);
  // A third stands in that tile, outside the box, and is drawn in by the domain.
  addBody(pack, boxMesh(3000, 3000, 3000), 40000, 110000, 500);
  const World world(std::move(pack));
  std::vector<Pose> poses = initialState(world.id, world.base).poses;
  std::vector<std::vector<Pose>> ticks(12, poses);
  for (int tick = 0; tick < 8; ++tick) {
    poses[0] = moved(poses[0], 0, 300);
    poses[1] = moved(poses[1], 200, 700);
    ticks.push_back(poses);
  }
  checkTicks(world, ticks);
}

TEST(Tick, ABodyOfThreeTilesThatLeavesTheWorld) {
  ScenePack pack = noisePack(210, 75, 5, -800, 800, 3000);
  addBody(pack, archMesh(190000, 20000, 20000), 105000, 40000, 700);
  const World world(std::move(pack));
  std::vector<Pose> poses = initialState(world.id, world.base).poses;
  std::vector<std::vector<Pose>> ticks;
  for (int tick = 0; tick < 6; ++tick) {
    poses[0] = moved(poses[0], 0, 9000, 0, 100);
    ticks.push_back(poses);
  }
  checkTicks(world, ticks);
}

TEST(Tick, ABodyThatCoversTheWholeWorldLeavesTheSoilNowhereToGo) {
  ScenePack pack = flatPack(20, 15);
  addBody(pack, boxMesh(60000, 60000, 3000), 10000, 7000, 500);
  const World world(std::move(pack));
  const std::vector<Pose> poses = initialState(world.id, world.base).poses;
  Simulation simulation = world.simulate();
  const auto result = simulation.step(poses);
  ASSERT_TRUE(result);
  EXPECT_EQ(result->effect.penetrating_cells, 300);
  EXPECT_EQ(simulation.state().ledger.error(), 0);
  for (int x = 0; x < 20; ++x) EXPECT_EQ(heightOf(simulation.state(), x, 7), 0);
  checkTicks(world, {poses, poses});
}

TEST(Tick, AFastBodyLeavesATrailWithoutGaps) {
  ScenePack pack = flatPack(120, 40);
  addBody(pack, boxMesh(3000, 3000, 3000), 10000, 20000, 600);
  pack.slope_threshold_q = pack.diagonal_threshold_q = 5000;  // the trail keeps its walls
  const World world(std::move(pack));
  Simulation simulation = world.simulate();
  ASSERT_TRUE(simulation.step(simulation.state().poses));
  for (int tick = 0; tick < 3; ++tick) {
    const auto result = simulation.step(std::vector{moved(simulation.state().poses[0], 30000, 0)});
    ASSERT_TRUE(result);
    EXPECT_FALSE(result->too_fast);
  }
  for (int x = 9; x <= 100; ++x) EXPECT_LE(heightOf(simulation.state(), x, 20), -600) << x;
  const auto result = simulation.step(std::vector{moved(simulation.state().poses[0], -33000, 0)});
  ASSERT_TRUE(result);
  EXPECT_TRUE(result->too_fast) << "33 cells in a tick are announced";
}

TEST(Tick, ABladeThinnerThanACellPressesWhereverItIs) {
  ScenePack pack = flatPack(60, 40);
  addBody(pack, bladeMesh(12000, 4000), 10000, 20000, 500);
  const World world(std::move(pack));
  Simulation simulation = world.simulate();
  for (int tick = 0; tick < 30; ++tick) {
    ASSERT_TRUE(simulation.step(std::vector{moved(simulation.state().poses[0], 700, 0)}));
    const int x = simulation.state().poses[0].x_q / 1000;
    for (int y = 15; y < 26; ++y)
      ASSERT_LE(heightOf(simulation.state(), x, y), -500) << "tick " << tick << ", row " << y;
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomWorlds, ::testing::Range(0u, 10u));

}  // namespace
}  // namespace spoor::test
