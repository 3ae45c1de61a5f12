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

INSTANTIATE_TEST_SUITE_P(Seeds, RandomWorlds, ::testing::Range(0u, 10u));

}  // namespace
}  // namespace spoor::test
