// Hard cases, on every backend and for several ways to move soil, against the oracle: worlds without room, bodies where
// none should be, parameters at the ends of their ranges, ground at the ends of its.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <random>

#include "tests/scenes.h"
#include "tests/stage_rig.h"

namespace spoor::test {
namespace {

/// One choice of each kind; together all of them.
struct Way {
  const char* name;
  Displacement displacement;
  NearestSearch nearest;
  Metric metric;
  SlopeRule slopes;
  double compression;
};
constexpr Way kWays[] = {
    {"direct, exact, exchange", Displacement::direct, NearestSearch::exact, Metric::euclidean, SlopeRule::exchange, 0},
    {"iterative, JFA, interleaved", Displacement::iterative, NearestSearch::jump_flooding, Metric::euclidean,
     SlopeRule::interleaved, 0},
    {"spread, JFA+2, scatter, compaction", Displacement::spread, NearestSearch::jump_flooding_plus_2, Metric::manhattan,
     SlopeRule::scatter, 0.5},
    {"spread, exact, flux, compaction", Displacement::spread, NearestSearch::exact, Metric::chebyshev, SlopeRule::flux,
     0.3},
    {"iterative, exact, exchange, compaction", Displacement::iterative, NearestSearch::exact, Metric::manhattan,
     SlopeRule::exchange, 0.7}};

ScenePack withWay(ScenePack pack, const Way& way) {
  Parameters& parameters = pack.parameters;
  parameters.displacement = way.displacement;
  parameters.nearest = way.nearest;
  parameters.metric = way.metric;
  parameters.slopes = way.slopes;
  parameters.materials[0].compression_q16 = std::int32_t(way.compression * kOneQ16);
  parameters.materials[0].compaction_limit_q16 = kOneQ16 / 2;
  parameters.spread_cells = 5;
  return pack;
}

class HardCase : public OnEveryBackend {
 protected:
  /// Runs poses on the backend and the oracle; every tick must be the same, and no soil be lost.
  void check(const World& world, const std::vector<std::vector<Pose>>& ticks) {
    Simulation simulation = world.simulateOn(GetParam());
    Oracle oracle(world.base, world.id);
    kept_back_ = 0;
    for (const auto& poses : ticks) {
      const auto result = simulation.step(poses);
      ASSERT_TRUE(result) << result.error();
      oracle.step(poses);
      kept_back_ += result->effect.kept_back;
      ASSERT_TRUE(sameState(simulation.state(), oracle)) << "tick " << result->update.tick;
      ASSERT_EQ(result->ledger.error(), 0) << "tick " << result->update.tick;
    }
    ASSERT_TRUE(recount(simulation.state()));
    state_hash_ = stateHash(simulation.state());
  }

  /// The same for each way.
  void checkWays(const ScenePack& pack, const std::vector<std::vector<Pose>>& ticks) {
    for (const Way& way : kWays) {
      SCOPED_TRACE(way.name);
      const World world(withWay(pack, way));
      ASSERT_NO_FATAL_FAILURE(check(world, ticks));
    }
  }

  std::int64_t kept_back_ = 0;    // of the last check()
  std::uint64_t state_hash_ = 0;  // at its end
};

std::vector<Pose> startPoses(const ScenePack& pack) { return initialState({}, BaseTerrain(pack)).poses; }

/// A body that goes the same way in every tick.
std::vector<std::vector<Pose>> straight(const ScenePack& pack, int tick_count, int dx_q, int dy_q) {
  std::vector<Pose> poses = startPoses(pack);
  std::vector<std::vector<Pose>> ticks;
  for (int tick = 0; tick < tick_count; ++tick) {
    for (Pose& pose : poses) pose = moved(pose, dx_q, dy_q);
    ticks.push_back(poses);
  }
  return ticks;
}

std::vector<std::vector<Pose>> standing(const ScenePack& pack, int tick_count) {
  return std::vector<std::vector<Pose>>(std::size_t(tick_count), startPoses(pack));
}

TEST_P(HardCase, WithoutAFreeCellAnywhereNothingMovesAndItIsSaid) {
  ScenePack pack = flatPack(20, 15);
  addBody(pack, boxMesh(60000, 60000, 3000), 10000, 7000, 500);
  for (const Way& way : kWays) {
    SCOPED_TRACE(way.name);
    ScenePack changed = withWay(pack, way);
    changed.parameters.materials[0].compression_q16 = 0;
    const World world(std::move(changed));
    ASSERT_NO_FATAL_FAILURE(check(world, standing(world.pack, 1)));
    EXPECT_EQ(kept_back_, 20 * 15 * 500);
    Simulation simulation = world.simulateOn(GetParam());
    ASSERT_TRUE(simulation.step(startPoses(world.pack)));
    for (int x = 0; x < 20; ++x) EXPECT_EQ(heightOf(simulation.state(), x, 7), 0);
  }
}

TEST_P(HardCase, OneFreeCellUnderATrillionUnitsOfDemandTakesWhatFits) {
  constexpr int kSide = 64;
  constexpr int kDeep = (1 << 28) - 1;
  ScenePack pack = groundPack(kSide, kSide, std::vector<std::int32_t>(kSide * kSide, 0), kDeep);
  Cells underside(kSide * kSide, -kDeep);
  const std::size_t hole = 20 * kSide + 33;
  underside[hole] = rules::kNoUnderside;
  const std::int64_t demand = std::int64_t(kDeep) * (kSide * kSide - 1);
  ASSERT_GT(demand, 1'000'000'000'000);
  for (const Displacement displacement : {Displacement::direct, Displacement::spread, Displacement::iterative}) {
    pack.parameters.displacement = displacement;
    const World world{ScenePack(pack)};
    const auto rig = makeStageRig(GetParam(), world);
    rig->setUnderside(underside);
    DenseWorld dense = denseCopy(*rig);
    rig->moveSoil();
    const Cells after = rig->height();
    EXPECT_EQ(std::accumulate(after.begin(), after.end(), std::int64_t(0)), 0) << "nothing is lost";
    EXPECT_LE(after[hole], rules::kHeightLimit);
    if (displacement == Displacement::iterative) continue;  // its soil is on the way
    // Every source gets floor(request * room / total); what rounding leaves is less than a unit each.
    EXPECT_GT(after[hole], rules::kHeightLimit - kSide * kSide);
    EXPECT_EQ(rig->keptBack(), demand - after[hole]);
    const std::int64_t share = std::int64_t(__int128(kDeep) * rules::kHeightLimit / demand);
    EXPECT_EQ(after[0], -share);
    EXPECT_EQ(after[kSide * kSide - 1], -share);
  }
}

TEST_P(HardCase, ABodyOverTheWholeMapOverItsEdgeAndOffIt) {
  ScenePack pack = noisePack(45, 38, 3, -500, 500, 3000);
  addBody(pack, boxMesh(30000, 20000, 9000), 22000, 19000, 400);
  std::vector<std::vector<Pose>> ticks = straight(pack, 12, 3500, 1200);  // out over the corner
  ASSERT_GT(ticks.back()[0].x_q, 45000 + 15000);
  ASSERT_NO_FATAL_FAILURE(checkWays(pack, ticks));
}

TEST_P(HardCase, ABodyThinnerThanACell) {
  ScenePack pack = noisePack(50, 44, 4, -300, 300, 4000);
  addBody(pack, bladeMesh(9000, 4000), 8000, 20000, 700);
  ASSERT_NO_FATAL_FAILURE(checkWays(pack, straight(pack, 8, 900, 200)));
}

TEST_P(HardCase, FortyMetresASecondAcrossCellsOfFiveCentimetres) {
  ScenePack pack = noisePack(140, 30, 5, -200, 200, 3000);
  pack.cell_q = 500;
  pack.parameters.sweeps_per_tick = 14;
  addBody(pack, boxMesh(4000, 3000, 3000), 6000, 7500, 400);
  ASSERT_NO_FATAL_FAILURE(checkWays(pack, straight(pack, GetParam().slow() ? 2 : 6, 6667, 0)));  // 60 ticks a second
}

TEST_P(HardCase, ThresholdsRoughnessCompressionAndIterationsAtTheirEnds) {
  ScenePack pack = noisePack(37, 29, 6, -2000, 2000, 2500);
  addBody(pack, boxMesh(8000, 6000, 5000), 12000, 14000, 600);
  const auto ticks = straight(pack, GetParam().slow() ? 2 : 4, 700, 300);
  std::vector<std::pair<const char*, void (*)(Parameters&)>> ends = {
      {"threshold 0",
       [](Parameters& p) { p.materials[0].slope_threshold_q = p.materials[0].diagonal_threshold_q = 0; }},
      {"threshold never",
       [](Parameters& p) { p.materials[0].slope_threshold_q = p.materials[0].diagonal_threshold_q = kNeverSteep; }},
      {"roughness 0", [](Parameters& p) { p.materials[0].roughness_q16 = 0; }},
      {"roughness 1", [](Parameters& p) { p.materials[0].roughness_q16 = kOneQ16; }},
      {"compression 0", [](Parameters& p) { p.materials[0].compression_q16 = 0; }},
      {"compression 1", [](Parameters& p) { p.materials[0].compression_q16 = kOneQ16; }},
      {"compression 1 without memory",
       [](Parameters& p) { p.materials[0].compression_q16 = kOneQ16, p.materials[0].compaction_limit_q16 = 0; }},
      {"0 iterations", [](Parameters& p) { p.displace_iterations = p.sweeps_per_tick = 0; }}};
  for (const auto& [name, change] : ends) {
    SCOPED_TRACE(name);
    ScenePack changed = pack;
    for (const Way& way : kWays) {
      SCOPED_TRACE(way.name);
      changed = withWay(pack, way);
      change(changed.parameters);
      const World world{ScenePack(changed)};
      ASSERT_NO_FATAL_FAILURE(check(world, ticks));
    }
  }
}

TEST_P(HardCase, AThousandIterations) {
  if (GetParam().slow()) GTEST_SKIP() << "fused sweeps by the thousand take minutes on a software renderer";
  ScenePack pack = noisePack(23, 21, 7, -1500, 1500, 2500);
  addBody(pack, boxMesh(9000, 7000, 5000), 11000, 10000, 600);
  pack.parameters.displace_iterations = pack.parameters.sweeps_per_tick = 1000;
  ASSERT_NO_FATAL_FAILURE(checkWays(pack, standing(pack, 1)));
}

TEST_P(HardCase, ASpikeAtTheHeightLimitBesideAHole) {
  // The base ends at 2^29; the spike is set in the stages themselves.
  constexpr int kColumns = 9, kRows = 7;
  ScenePack pack = groundPack(kColumns, kRows, std::vector<std::int32_t>(kColumns * kRows, 0), (1 << 28) - 1);
  for (const SlopeRule rule : {SlopeRule::exchange, SlopeRule::flux, SlopeRule::interleaved, SlopeRule::scatter})
    for (const int threshold : {1, 700}) {
      pack.parameters.slopes = rule;
      pack.parameters.materials[0].slope_threshold_q = pack.parameters.materials[0].diagonal_threshold_q = threshold;
      const World world{ScenePack(pack)};
      const auto rig = makeStageRig(GetParam(), world);
      Cells height(kColumns * kRows, 0);
      height[3 * kColumns + 4] = rules::kHeightLimit;
      height[3 * kColumns + 5] = -(1 << 28) + 1;
      height[2 * kColumns + 4] = -(1 << 28) + 1;
      rig->setHeight(height);
      DenseWorld dense = denseCopy(*rig);
      const auto before = std::accumulate(height.begin(), height.end(), std::int64_t(0));
      rig->relax(0, 12);
      oracleRelax(dense, world.pack.parameters, 12);
      const Cells after = rig->height();
      ASSERT_EQ(after, insideCells(dense, dense.height)) << "rule " << int(rule) << ", threshold " << threshold;
      ASSERT_EQ(std::accumulate(after.begin(), after.end(), std::int64_t(0)), before);
    }
}

TEST_P(HardCase, ACheckerboardAndOneUnitOfNoise) {
  constexpr int kColumns = 31, kRows = 27;
  std::mt19937 engine(9);
  Cells board, noise;
  for (int i = 0; i < kColumns * kRows; ++i) {
    board.push_back((i % kColumns + i / kColumns) % 2 * 5000);
    noise.push_back(int(engine() % 3) - 1);
  }
  for (const Cells& ground : {board, noise})
    for (const SlopeRule rule : {SlopeRule::exchange, SlopeRule::flux, SlopeRule::interleaved, SlopeRule::scatter})
      for (const int threshold : {0, 1, 300}) {
        ScenePack pack = groundPack(kColumns, kRows, ground, 10000);
        pack.parameters.slopes = rule;
        pack.parameters.materials[0].slope_threshold_q = threshold;
        pack.parameters.materials[0].diagonal_threshold_q = threshold * 14 / 10;
        const World world(std::move(pack));
        const auto rig = makeStageRig(GetParam(), world);
        DenseWorld dense = denseCopy(*rig);
        rig->relax(0, 5);
        oracleRelax(dense, world.pack.parameters, 5);
        ASSERT_EQ(rig->height(), insideCells(dense, dense.height)) << "rule " << int(rule) << ", " << threshold;
      }
}

TEST_P(HardCase, ThresholdsOfOneTwoAndThreeUnitsComeToRest) {
  for (const int threshold : {1, 2, 3}) {
    ScenePack pack = flatPack(33, 35);
    pack.parameters.materials[0].slope_threshold_q = threshold;
    pack.parameters.materials[0].diagonal_threshold_q = std::max(1, threshold * 14 / 10);
    pack.parameters.sweeps_per_tick = 64;
    addBody(pack, boxMesh(3000, 3000, 3000), 16000, 17000, 40);
    const World world(std::move(pack));
    Simulation simulation = world.simulateOn(GetParam());
    std::vector<Pose> poses = simulation.state().poses;
    ASSERT_TRUE(simulation.step(poses));
    poses[0].z_q += 5000;  // and up again
    int ticks = 0;
    do {
      ASSERT_TRUE(simulation.step(poses));
    } while (!simulation.state().tiles.awake().empty() && ++ticks < 200);
    EXPECT_LT(ticks, 200) << "threshold " << threshold;
    EXPECT_EQ(steepestExcess(world.pack, simulation.state().tiles), 0) << "threshold " << threshold;
    EXPECT_EQ(simulation.state().ledger.error(), 0);
  }
}

TEST_P(HardCase, WorldsOfOneCellAcross) {
  for (const auto& [columns, rows] : {std::pair{1, 90}, {90, 1}, {1, 1}}) {
    ScenePack pack = noisePack(columns, rows, 11, -900, 900, 2000);
    addBody(pack, boxMesh(4000, 4000, 3000), columns * 300, rows * 300, 500);
    SCOPED_TRACE(columns);
    ASSERT_NO_FATAL_FAILURE(checkWays(pack, straight(pack, 4, columns > 1 ? 800 : 0, rows > 1 ? 800 : 0)));
  }
}

TEST_P(HardCase, AHundredBodiesOnTheSameCellsInAnyOrder) {
  ScenePack pack = noisePack(40, 36, 12, -400, 400, 3000);
  std::mt19937 engine(13);
  for (int i = 0; i < 100; ++i) {
    const int size = 1000 + int(engine() % 5000);
    addBody(pack, i % 2 == 0 ? boxMesh(size, size, 4000) : wedgeMesh(size, size, 4000), 18000 + int(engine() % 4000),
            16000 + int(engine() % 4000), int(engine() % 900));
  }
  for (const Way& way : kWays) {
    SCOPED_TRACE(way.name);
    std::vector<std::uint64_t> tiles_hashes;
    ScenePack ordered = withWay(pack, way);
    for (int order = 0; order < 3; ++order) {
      const World world{ScenePack(ordered)};
      Simulation simulation = world.simulateOn(GetParam());
      for (const auto& poses : straight(world.pack, 2, 300, -200)) {
        const auto result = simulation.step(poses);
        ASSERT_TRUE(result) << result.error();
        ASSERT_EQ(result->ledger.error(), 0);
      }
      tiles_hashes.push_back(simulation.state().tiles_hash);
      std::ranges::shuffle(ordered.bodies, engine);
    }
    EXPECT_EQ(tiles_hashes[1], tiles_hashes[0]);
    EXPECT_EQ(tiles_hashes[2], tiles_hashes[0]);
  }
}

/// Where the soil that a blade displaced lies, after 3 m at a speed: the share of it ahead of the blade.
double shareAhead(const BackendCase& backend_case, int q_per_tick, int sweeps_per_tick) {
  ScenePack pack = flatPack(128, 64);
  pack.cell_q = 500;
  pack.parameters.sweeps_per_tick = sweeps_per_tick;
  pack.parameters.materials[0].slope_threshold_q = 350;
  pack.parameters.materials[0].diagonal_threshold_q = 494;
  addBody(pack, bladeMesh(16000, 6000), 15000, 16000, 600);
  const World world(std::move(pack));
  Simulation simulation = world.simulateOn(backend_case);
  std::vector<Pose> poses = simulation.state().poses;
  EXPECT_TRUE(simulation.step(poses));
  const int end_q = poses[0].x_q + 30000;
  while (poses[0].x_q < end_q) {
    poses[0].x_q = std::min(poses[0].x_q + q_per_tick, end_q);
    EXPECT_TRUE(simulation.step(poses));
  }
  double ahead = 0, all = 0;
  for (const Tile* tile : simulation.state().tiles.sorted())
    for (int i = 0; i < rules::kTileCells; ++i) {
      const int x = tile->at.x * rules::kTileSize + i % rules::kTileSize;
      const double heaped = std::max(tile->height()[std::size_t(i)], 0);  // the ground lay at 0
      all += heaped;
      if (x > end_q / 500) ahead += heaped;
    }
  return ahead / all;
}

TEST_P(HardCase, ABladeAtFortyMetresASecondKeepsItsSoilAhead) {
  if (GetParam().slow()) GTEST_SKIP() << "fused sweeps take minutes on a software renderer";
  // 40 m/s at 60 ticks a second is 13.3 cells of 5 cm a tick: 40 sweeps then are 3 a cell.
  const double fast = shareAhead(GetParam(), 6667, 40);
  const double slow = shareAhead(GetParam(), 500, 3);
  EXPECT_GT(slow, 0.1);
  EXPECT_NEAR(fast / slow, 1, 0.05) << "ahead " << fast << " of the soil, a cell a tick " << slow;
  RecordProperty("ahead_fast", std::to_string(fast));
  RecordProperty("ahead_slow", std::to_string(slow));
}

SPOOR_ON_EVERY_BACKEND(HardCase);

// 10^4 ticks; SPOOR_SOAK_TICKS says another number (./test --soak: 10^6 on native).
class Soak : public OnEveryBackend {};

std::vector<BackendCase> soakCases() {
  std::vector<BackendCase> cases;
  for (const BackendCase& backend_case : backendCases())
    if (backend_case.gl ? backend_case.group == 64 && !backend_case.fused : backend_case.thread_count > 1)
      cases.push_back(backend_case);
  return cases;
}

TEST_P(Soak, TheLedgerIsEqualAtEveryTick) {
  const char* asked = std::getenv("SPOOR_SOAK_TICKS");
  const int tick_count = asked == nullptr ? 10000 : std::atoi(asked);
  ASSERT_GT(tick_count, 0);
  if (GetParam().gl && tick_count > 100000) GTEST_SKIP() << "the long soak is native's";
  ScenePack pack = noisePack(60, 50, 14, -600, 600, 3000);
  addBody(pack, boxMesh(5000, 3000, 3000), 20000, 20000, 500);
  addBody(pack, tetrahedronMesh(4000), 40000, 30000, 900);
  const World world(std::move(pack));
  Simulation simulation = world.simulateOn(GetParam());
  const std::vector<Pose> start = simulation.state().poses;
  std::mt19937 engine(15);
  std::vector<Pose> poses = start;
  for (int tick = 1; tick <= tick_count; ++tick) {
    for (std::size_t i = 0; i < poses.size(); ++i) {
      // Round about where it began, a little deeper or higher each time.
      const auto drawn = [&engine](int range) { return int(engine() % std::uint32_t(2 * range + 1)) - range; };
      poses[i] = moved(poses[i], drawn(1500), drawn(1500), drawn(100), drawn(500));
      poses[i].x_q = std::clamp(poses[i].x_q, 5000, 55000);
      poses[i].y_q = std::clamp(poses[i].y_q, 5000, 45000);
      poses[i].z_q = std::clamp(poses[i].z_q, start[i].z_q - 800, start[i].z_q + 500);
    }
    std::optional<Parameters> parameters;
    if (tick % 250 == 1) {
      const Way& way = kWays[std::size_t(tick / 250) % std::size(kWays)];
      parameters = withWay(world.pack, way).parameters;
    }
    const auto result = simulation.step(poses, parameters);
    ASSERT_TRUE(result) << result.error();
    ASSERT_EQ(result->ledger.error(), 0) << "tick " << tick;
    if (tick % 1000 == 0) {
      ASSERT_TRUE(recount(simulation.state())) << "tick " << tick;
    }
  }
  EXPECT_GT(simulation.state().ledger.compacted, 0);
  RecordProperty("state_hash", std::to_string(stateHash(simulation.state())));
}

INSTANTIATE_TEST_SUITE_P(On, Soak, ::testing::ValuesIn(soakCases()), caseName);

}  // namespace
}  // namespace spoor::test
