// Whole ticks: every backend against the oracle, on random worlds and bodies.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/scenes.h"

namespace spoor::test {
namespace {

/// No soil under bedrock; nothing above a body's underside but what found no room.
void checkCells(const Oracle& oracle) {
  const DenseWorld& cells = oracle.world();
  for (std::size_t i = 0; i < cells.height.size(); ++i) ASSERT_GE(cells.height[i], cells.bedrock[i]) << "cell " << i;
  if (oracle.activeTiles().empty() || oracle.parameters().displacement == Displacement::none) return;
  const auto overlap = oracleOverlap(cells, oracle.parameters().obstacle_threshold_q);
  for (std::size_t i = 0; i < overlap.size(); ++i) {
    const bool fine = overlap[i] <= 0 || std::ranges::binary_search(oracle.crowdedCells(), i);
    ASSERT_TRUE(fine) << "cell " << i << " reaches into a body";
  }
}

void checkCounts(const TickEffect& effect, const Oracle& oracle) {
  ASSERT_EQ(effect.active_cells, std::int64_t(oracle.activeTiles().size()) * rules::kTileCells);
  ASSERT_EQ(effect.penetrating_cells, oracle.penetratingCells());
  ASSERT_EQ(effect.kept_back, oracle.keptBack());
  if (oracle.parameters().slopes == SlopeRule::exchange) return;  // backends leave out pairs that are settled
  const int edges = oracle.parameters().slopes == SlopeRule::drift ? 2 : 4;  // of each cell
  ASSERT_EQ(effect.pairs_visited, edges * effect.active_cells * sweepsOf(oracle.parameters()));
}

void checkWorld(const BackendCase& backend_case, std::uint32_t seed) {
  const RandomWorld random = randomWorld(seed, backend_case.slow() ? 8 : backend_case.gl ? 12 : 20);
  SCOPED_TRACE(random.description);
  const World world(random.pack);
  Simulation simulation = world.simulateOn(backend_case);
  Oracle oracle(world.base, world.id);
  for (std::size_t tick = 0; tick < random.ticks.size(); ++tick) {
    const auto result =
        simulation.step(random.ticks[tick], random.changeAt(tick), random.cratersAt(tick), random.snowfallsAt(tick));
    ASSERT_TRUE(result) << result.error();
    oracle.step(random.ticks[tick], random.changeAt(tick), random.cratersAt(tick), random.snowfallsAt(tick));
    ASSERT_TRUE(sameState(simulation.state(), oracle)) << "tick " << result->update.tick;
    ASSERT_EQ(simulation.state().ledger.error(), 0) << "tick " << result->update.tick;
    ASSERT_NO_FATAL_FAILURE(checkCounts(result->effect, oracle));
    ASSERT_NO_FATAL_FAILURE(checkCells(oracle));
  }
  EXPECT_TRUE(recount(simulation.state()));
}

/// Twenty worlds on one backend; no two batches have a seed in common.
struct Batch {
  BackendCase backend_case;
  int number = 0;           // of the backend's batches
  std::uint32_t seeds = 0;  // the first of its seeds
};
void PrintTo(const Batch& batch, std::ostream* out) { *out << batch.backend_case.name << ", seed " << batch.seeds; }

constexpr std::uint32_t kWorldsPerBatch = 20;

std::vector<Batch> batches() {
  std::vector<Batch> result;
  for (const BackendCase& backend_case : backendCases())
    for (int i = 0; i < (backend_case.gl ? 2 : 5); ++i)
      result.push_back({backend_case, i, std::uint32_t(result.size()) * kWorldsPerBatch});
  return result;
}

class RandomWorlds : public ::testing::TestWithParam<Batch> {
 protected:
  void SetUp() override {
    if (const std::string& lack = lackOf(GetParam().backend_case); !lack.empty()) GTEST_SKIP() << lack;
  }
};

TEST_P(RandomWorlds, EqualTheOracleAndKeepEveryGrain) {
  for (std::uint32_t i = 0; i < kWorldsPerBatch && !HasFatalFailure(); ++i)
    checkWorld(GetParam().backend_case, GetParam().seeds + i);
}

class WholeTick : public OnEveryBackend {};

/// Runs poses on both and compares after every tick.
void checkTicks(const BackendCase& backend_case, const World& world, const std::vector<std::vector<Pose>>& ticks) {
  Simulation simulation = world.simulateOn(backend_case);
  Oracle oracle(world.base, world.id);
  for (const auto& poses : ticks) {
    ASSERT_TRUE(simulation.step(poses));
    oracle.step(poses);
    ASSERT_TRUE(sameState(simulation.state(), oracle)) << "tick " << simulation.state().tick;
    ASSERT_NO_FATAL_FAILURE(checkCells(oracle));
  }
}

TEST_P(WholeTick, AJoinedDomainReachesTilesThatNoBodyDoes) {
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
  checkTicks(GetParam(), world, ticks);
}

TEST_P(WholeTick, ABodyOfThreeTilesThatLeavesTheWorld) {
  ScenePack pack = noisePack(210, 75, 5, -800, 800, 3000);
  addBody(pack, archMesh(190000, 20000, 20000), 105000, 40000, 700);
  const World world(std::move(pack));
  std::vector<Pose> poses = initialState(world.id, world.base).poses;
  std::vector<std::vector<Pose>> ticks;
  for (int tick = 0; tick < 6; ++tick) {
    poses[0] = moved(poses[0], 0, 9000, 0, 100);
    ticks.push_back(poses);
  }
  checkTicks(GetParam(), world, ticks);
}

TEST_P(WholeTick, ABodyThatCoversTheWholeWorldLeavesTheSoilNowhereToGo) {
  ScenePack pack = flatPack(20, 15);
  addBody(pack, boxMesh(60000, 60000, 3000), 10000, 7000, 500);
  const World world(std::move(pack));
  const std::vector<Pose> poses = initialState(world.id, world.base).poses;
  Simulation simulation = world.simulateOn(GetParam());
  const auto result = simulation.step(poses);
  ASSERT_TRUE(result);
  EXPECT_EQ(result->effect.penetrating_cells, 300);
  EXPECT_EQ(simulation.state().ledger.error(), 0);
  for (int x = 0; x < 20; ++x) EXPECT_EQ(heightOf(simulation.state(), x, 7), 0);
  checkTicks(GetParam(), world, {poses, poses});
}

TEST_P(WholeTick, AFastBodyLeavesATrailWithoutGaps) {
  ScenePack pack = flatPack(120, 40);
  addBody(pack, boxMesh(3000, 3000, 3000), 10000, 20000, 600);
  pack.parameters.materials[0].slope_threshold_q = pack.parameters.materials[0].diagonal_threshold_q =
      5000;  // the trail keeps its walls
  const World world(std::move(pack));
  Simulation simulation = world.simulateOn(GetParam());
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

TEST_P(WholeTick, ABladeThinnerThanACellPressesWhereverItIs) {
  ScenePack pack = flatPack(60, 40);
  addBody(pack, bladeMesh(12000, 4000), 10000, 20000, 500);
  const World world(std::move(pack));
  Simulation simulation = world.simulateOn(GetParam());
  for (int tick = 0; tick < 30; ++tick) {
    ASSERT_TRUE(simulation.step(std::vector{moved(simulation.state().poses[0], 700, 0)}));
    const int x = simulation.state().poses[0].x_q / 1000;
    for (int y = 15; y < 26; ++y)
      ASSERT_LE(heightOf(simulation.state(), x, y), -500) << "tick " << tick << ", row " << y;
  }
}

TEST_P(WholeTick, CompactedSoilIsOnTheLedgerAndOnlyTilesThatHaveSomeHoldAPlaneOfIt) {
  ScenePack pack = flatPack(130, 20);
  pack.parameters.materials[0].compression_q16 = kOneQ16 / 4;
  pack.parameters.active_margin_cells = 40;
  addBody(pack, boxMesh(3000, 3000, 3000), 60500, 10500, 400);
  const World world(std::move(pack));
  Simulation simulation = world.simulateOn(GetParam());
  ASSERT_TRUE(simulation.step(simulation.state().poses));
  const TileStore& tiles = simulation.state().tiles;
  ASSERT_EQ(tiles.size(), 2u) << "the margin reaches into the second tile";
  EXPECT_EQ(tiles.find({1, 0})->compacted(), nullptr);
  const PlaneCells* compacted = tiles.find({0, 0})->compacted();
  ASSERT_NE(compacted, nullptr);
  EXPECT_EQ((*compacted)[10 * 64 + 60], 100);
  const Ledger& ledger = simulation.state().ledger;
  EXPECT_GE(ledger.compacted, 9 * 100);
  EXPECT_EQ(ledger.compacted % 100, 0);
  EXPECT_EQ(ledger.ground, -ledger.compacted) << "level ground at height 0 has lost what was pressed together";
  EXPECT_EQ(ledger.error(), 0);
  EXPECT_TRUE(recount(simulation.state()));
  std::vector<Pose> poses = initialState(world.id, world.base).poses;
  std::vector<std::vector<Pose>> ticks(1, poses);
  for (int tick = 0; tick < 6; ++tick) {
    poses[0] = moved(poses[0], 1300, 0, tick == 2 ? 900 : -100);
    ticks.push_back(poses);
  }
  checkTicks(GetParam(), world, ticks);
}

TEST_P(WholeTick, WithoutActiveAreasTheWholeWorldIsOneDomain) {
  ScenePack pack = flatPack(140, 70);
  pack.parameters.active_areas = 0;
  addBody(pack, boxMesh(3000, 3000, 3000), 20500, 10500, 400);
  addBody(pack, boxMesh(3000, 3000, 3000), 100500, 50500, 400);
  const World world(std::move(pack));
  Simulation simulation = world.simulateOn(GetParam());
  for (int tick = 0; tick < 2; ++tick) {
    const auto result = simulation.step(simulation.state().poses);
    ASSERT_TRUE(result);
    EXPECT_EQ(result->effect.active_cells, 3 * 2 * rules::kTileCells);
    EXPECT_EQ(result->effect.domain_cells, 140 * 70);
  }
}

std::string batchName(const ::testing::TestParamInfo<Batch>& info) {
  return info.param.backend_case.name + "Batch" + std::to_string(info.param.number);
}

INSTANTIATE_TEST_SUITE_P(On, RandomWorlds, ::testing::ValuesIn(batches()), batchName);
SPOOR_ON_EVERY_BACKEND(WholeTick);

}  // namespace
}  // namespace spoor::test
