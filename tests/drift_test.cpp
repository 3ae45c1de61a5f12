// Rule drift: every grain kept on the hardest ground, no matter how steps, bodies and threads are chosen, and rest at
// the angle of repose.
#include "shared/sim/drift.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "tests/stage_rig.h"

namespace spoor::test {
namespace {

constexpr DriftWeights kWeights[] = {DriftWeights::none, DriftWeights::displacement, DriftWeights::slope};

std::int64_t sumOf(const Cells& cells) { return std::accumulate(cells.begin(), cells.end(), std::int64_t(0)); }

/// Ground to try a rule on.
struct Ground {
  std::string name;
  int columns = 0, rows = 0, soil_depth = 0;
  Cells heights;
  std::int32_t threshold_q = 700;
};

std::vector<Ground> hardGrounds() {
  std::vector<Ground> grounds;
  Ground spike{"a spike on thin soil", 40, 35, 30, Cells(40 * 35, 0)};
  spike.heights[17 * 40 + 20] = 400000;
  grounds.push_back(spike);
  Ground board{"a checkerboard", 33, 70, 5000, {}};
  for (int i = 0; i < 33 * 70; ++i) board.heights.push_back((i % 33 + i / 33) % 2 * 5000);
  grounds.push_back(board);
  board.name = "a checkerboard that is never too steep";
  board.threshold_q = kNeverSteep;
  grounds.push_back(board);
  Ground cliffs{"cliffs of bedrock", 66, 20, 1, {}};
  for (int i = 0; i < 66 * 20; ++i) cliffs.heights.push_back(i % 66 / 5 % 2 * 300000);
  grounds.push_back(cliffs);
  Ground high{"heights near their limit", 20, 20, (1 << 28) - 1, {}};
  for (int i = 0; i < 400; ++i) high.heights.push_back((1 << 29) + (1 << 28) - 9 - i * 7919 % 100000);
  grounds.push_back(high);
  grounds.push_back({"one cell", 1, 1, 100, {50}});
  grounds.push_back({"one row", 70, 1, 900, Cells(70, 0)});
  grounds.back().heights[69] = 90000;
  return grounds;
}

ScenePack driftPack(const Ground& ground) {
  ScenePack pack = groundPack(ground.columns, ground.rows, ground.heights, ground.soil_depth);
  pack.parameters.slopes = SlopeRule::drift;
  pack.parameters.materials[0].slope_threshold_q = ground.threshold_q;
  pack.parameters.materials[0].repose_q16 = kOneQ16 / 3;
  pack.parameters.materials[0].friction_inverse_q32 = 1 << 24;
  return pack;
}

/// How long steps are, and how much spreads in one.
struct Pace {
  double dt, diffusion;
};
constexpr Pace kPaces[] = {{0.05, 1}, {0.25, 1}, {1, 0}, {1, 4}, {10, 1}, {10, 4}};

/// Sets it; fewer sweeps where a sweep takes many steps.
void setPace(Parameters& parameters, DriftWeights weights, const Pace& pace) {
  parameters.drift_weights = weights;
  parameters.drift_step_q16 = std::int32_t(pace.dt * kOneQ16);
  parameters.materials[0].diffusion_q16 = std::int32_t(pace.diffusion * kOneQ16);
  parameters.sweeps_per_tick = std::max(1, 10 / driftSteps(parameters));
}

std::string nameOf(const Ground& ground, DriftWeights weights, const Pace& pace) {
  return ground.name + ", weights " + std::to_string(int(weights)) + ", dt " + std::to_string(pace.dt) + ", D " +
         std::to_string(pace.diffusion);
}

/// Two bodies press on the ground's middle and push with all their force, in opposite directions and out of the world.
std::vector<std::vector<Pose>> pushed(ScenePack& pack, Displacement displacement) {
  pack.parameters.displacement = displacement;
  const int x = pack.width_cells * 500, y = pack.height_cells * 500;
  addBody(pack, boxMesh(7000, 9000, 3000), x, y, 400);
  addBody(pack, wedgeMesh(9000, 7000, 3000), x + 2500, y + 1500, 900);
  for (Body& body : pack.bodies) body.force_n = kForceLimit;
  std::vector<Pose> poses = initialState({}, BaseTerrain(pack)).poses;
  std::vector<std::vector<Pose>> ticks(1, poses);
  for (int tick = 0; tick < 8; ++tick) {
    poses = {moved(poses[0], 700, 300, -40), moved(poses[1], -900, 2100, 0, 500)};
    ticks.push_back(poses);
  }
  return ticks;
}

/// Runs ticks; after each the ledger is even and nothing lies below bedrock.
std::vector<std::uint64_t> hashesOf(const World& world, const NativeOptions& options,
                                    const std::vector<std::vector<Pose>>& ticks) {
  Simulation simulation = world.simulate(options);
  std::vector<std::uint64_t> hashes;
  for (const auto& poses : ticks) {
    const auto result = simulation.step(poses);
    EXPECT_TRUE(result) << result.error();
    hashes.push_back(result->update.state_hash);
    EXPECT_TRUE(recount(simulation.state()));
    for (const Tile* tile : simulation.state().tiles.sorted())
      for (int i = 0; i < rules::kTileCells; ++i) {
        const bool inside =
            tile->at.x * 64 + i % 64 < world.pack.width_cells && tile->at.y * 64 + i / 64 < world.pack.height_cells;
        if (tile->height()[std::size_t(i)] < (*tile->bedrock)[std::size_t(i)] ||
            (!inside && tile->height()[std::size_t(i)] != 0)) {
          ADD_FAILURE() << "cell " << i << " of tile (" << tile->at.x << ", " << tile->at.y << ") is "
                        << tile->height()[std::size_t(i)];
          return hashes;
        }
      }
  }
  return hashes;
}

TEST(Drift, KeepsEveryGrainOnHardGroundAtAnyPace) {
  for (const Ground& ground : hardGrounds())
    for (const DriftWeights weights : kWeights)
      for (const Pace& pace : kPaces) {
        SCOPED_TRACE(nameOf(ground, weights, pace));
        ScenePack pack = driftPack(ground);
        setPace(pack.parameters, weights, pace);
        const World world(std::move(pack));
        NativeStageRig rig(world);
        const Cells before = rig.height();
        const std::int32_t highest = std::ranges::max(before);
        const std::int32_t lowest = std::ranges::min(before);
        constexpr int kRounded = 4;  // a unit over each edge may be rounded up
        for (int sweep = 0; sweep < 40; sweep += 8) {
          rig.relax(sweep, 8);
          const Cells now = rig.height();
          ASSERT_EQ(sumOf(now), sumOf(before));
          for (std::size_t i = 0; i < now.size(); ++i) ASSERT_GE(now[i], before[i] - ground.soil_depth) << "cell " << i;
          // Diffusion levels: nothing comes to stand above the highest or below the lowest.
          ASSERT_LE(std::ranges::max(now), highest + kRounded);
          ASSERT_GE(std::ranges::min(now), lowest - kRounded);
        }
      }
}

TEST(Drift, BodiesThatPushKeepEveryGrainWhateverTheOrder) {
  int moved_count = 0;
  for (const Ground& ground : hardGrounds())
    for (const DriftWeights weights : kWeights)
      for (const Pace& pace : {kPaces[0], kPaces[4]})
        for (const Displacement displacement : {Displacement::direct, Displacement::none}) {
          SCOPED_TRACE(nameOf(ground, weights, pace) + ", displacement " + std::to_string(int(displacement)));
          ScenePack pack = driftPack(ground);
          setPace(pack.parameters, weights, pace);
          const auto ticks = pushed(pack, displacement);
          const World world(std::move(pack));
          const auto expected = hashesOf(world, {.thread_count = 1}, ticks);
          ASSERT_FALSE(::testing::Test::HasFailure());
          moved_count += expected.front() != expected.back() ? 1 : 0;
          if (weights != DriftWeights::slope && ground.columns > 40) continue;
          ASSERT_EQ(
              hashesOf(world, {.thread_count = 3, .kernels = availableKernels()[0], .skip_settled = false}, ticks),
              expected);
        }
  EXPECT_GT(moved_count, 20);
}

TEST(Drift, BySlopeAPileComesToRestAtItsThresholdExactly) {
  for (const int threshold : {1, 30, 700}) {
    Ground ground{"pile", 47, 45, 1000000, Cells(47 * 45, 0), threshold};
    for (int y = 21; y < 24; ++y)
      for (int x = 22; x < 25; ++x) ground.heights[std::size_t(y * 47 + x)] = 30 * threshold;
    const World world(driftPack(ground));
    NativeStageRig rig(world);
    Cells now = rig.height(), before;
    int sweeps = 0;
    // What would move by less than a unit moves now and then: at rest is what does not change for a long time.
    for (int quiet = 0; quiet < 600 && sweeps < 6000; sweeps += 20) {
      before = now;
      rig.relax(sweeps, 20);
      now = rig.height();
      quiet = now == before ? quiet + 20 : 0;
    }
    EXPECT_LT(sweeps, 6000) << "threshold " << threshold;
    int steepest = 0;
    for (int y = 0; y < 45; ++y)
      for (int x = 0; x < 47; ++x) {
        const auto i = std::size_t(y * 47 + x);
        if (x + 1 < 47) steepest = std::max(steepest, std::abs(now[i] - now[i + 1]));
        if (y + 1 < 45) steepest = std::max(steepest, std::abs(now[i] - now[i + 47]));
      }
    EXPECT_EQ(steepest, threshold) << "as steep as it may be somewhere, and nowhere steeper";
    EXPECT_EQ(sumOf(now), sumOf(ground.heights));
    std::printf("threshold %d: at rest after %d sweeps\n", threshold, sweeps - 600);
  }
}

TEST(Drift, BySlopeWhatSleepsIsAtRest) {
  Ground ground{"pile", 47, 45, 1000000, Cells(47 * 45, 0), 700};
  ground.heights[22 * 47 + 23] = 90000;
  ScenePack pack = driftPack(ground);
  addBody(pack, boxMesh(200, 200, 200), 26500, 22500, 10);  // its prick wakes the tile
  const World world(std::move(pack));
  Simulation simulation = world.simulate();
  int ticks = 0;
  for (; ticks < 1000; ++ticks) {
    const auto result =
        simulation.step(std::vector{moved(simulation.state().poses[0], 0, 0, ticks == 1 ? 1 << 28 : 0)});
    ASSERT_TRUE(result) << result.error();
    if (result->effect.active_cells == 0) break;
  }
  EXPECT_LT(ticks, 300);
  int steepest = 0;
  for (int y = 0; y < 44; ++y)
    for (int x = 0; x < 46; ++x) {
      const int here = heightOf(simulation.state(), x, y);
      steepest = std::max({steepest, std::abs(here - heightOf(simulation.state(), x + 1, y)),
                           std::abs(here - heightOf(simulation.state(), x, y + 1))});
    }
  EXPECT_EQ(steepest, 700);
}

TEST(Drift, UnweightedEverythingLevels) {
  Ground ground{"step", 12, 9, 100000, {}};
  for (int i = 0; i < 12 * 9; ++i) ground.heights.push_back(i % 12 < 6 ? 3000 : 0);
  ScenePack pack = driftPack(ground);
  pack.parameters.drift_weights = DriftWeights::none;
  const World world(std::move(pack));
  NativeStageRig rig(world);
  rig.relax(0, 4000);
  const Cells now = rig.height();
  EXPECT_LE(std::ranges::max(now) - std::ranges::min(now), 11 + 8) << "neighbours differ by a unit at most";
  EXPECT_EQ(sumOf(now), sumOf(ground.heights));
}

TEST(Drift, ByDisplacementASlopeRestsWhereItsTangentIsAlphaByD) {
  // alpha = pi/6 and D = 1/2: at rest up to pi/3 * 1000 units a cell.
  const auto movesAt = [](int step_q) {
    Ground ground{"ramp", 20, 5, 1000000, {}};
    for (int i = 0; i < 100; ++i) ground.heights.push_back(i % 20 * step_q);
    ScenePack pack = driftPack(ground);
    pack.parameters.drift_weights = DriftWeights::displacement;
    pack.parameters.materials[0].diffusion_q16 = kOneQ16 / 2;
    const World world(std::move(pack));
    NativeStageRig rig(world);
    rig.relax(0, 20);
    return rig.height() != ground.heights;
  };
  const double rests_q = std::numbers::pi / 3 * 1000;
  EXPECT_FALSE(movesAt(int(rests_q) - 8));
  EXPECT_TRUE(movesAt(int(rests_q) + 60));
}

/// What equation 4 says, in real numbers.
double weightOf(double moved_q8, double repose, double quarter_q8) {
  return std::clamp((std::min(moved_q8 / quarter_q8, 1.0) - repose) / (1 - repose), 0.0, 1.0);
}

TEST(Drift, WeightsByDisplacementAreThoseOfEquation4) {
  std::mt19937 engine(5);
  double worst = 0;
  for (int round = 0; round < 20000; ++round) {
    ScenePack pack = flatPack(4, 4);
    pack.cell_q = 1000 + int(engine() % (round % 3 == 0 ? 100 : 999000));
    Parameters& parameters = pack.parameters;
    parameters.drift_weights = DriftWeights::displacement;
    parameters.drift_step_q16 = 1 + int(engine() % kOneQ16);
    parameters.materials[0].repose_q16 = int(engine() % (kReposeLimit + 1));
    const DriftSweep sweep = driftSweep(pack, parameters);
    const double quarter_q8 = std::numbers::pi / 2 * pack.cell_q * sweep.step.step / 256;  // 8 bits below the unit
    if (quarter_q8 < 4096) continue;  // where a unit in 2^8 is much of a right angle
    const int moved = int(double(engine() % 65536) / 40000 * quarter_q8);
    const int weight = rules::driftWeight(sweep.step, moved, sweep.materials[0].rest, sweep.materials[0].inverse);
    const double expected = weightOf(moved, parameters.materials[0].repose_q16 / 65536.0, quarter_q8);
    const double slack = 1 - parameters.materials[0].repose_q16 / 65536.0;  // what rounding is magnified by
    worst = std::max(worst, std::abs(weight / 65536.0 - expected) * slack);
  }
  EXPECT_LT(worst, 1.0 / 1024) << worst;
}

TEST(Drift, AFlowIsOddInItsCellsAndWithinAQuarterOfSoilAndRoom) {
  std::mt19937 engine(6);
  const auto pick = [&engine](int low, int high) { return low + int(engine() % std::uint32_t(high - low + 1)); };
  const auto cell = [&] {
    rules::DriftCell made;
    made.height = engine() % 2 == 0 ? pick(-5000, 5000) : pick(-(1 << 29), 1 << 29) * 2 - 1;
    made.soil = engine() % 2 == 0 ? pick(0, 900) : pick(0, rules::kHeightLimit);
    made.room = engine() % 2 == 0 ? pick(0, 900) : pick(0, rules::kHeightLimit);
    made.rest = pick(1, 65535);
    made.rate = pick(0, 1 << 14);
    made.inverse = 0xffffffffu / rules::uint(65536 - std::min(made.rest, 62259));
    return made;
  };
  for (int round = 0; round < 100000; ++round) {
    ScenePack pack = flatPack(4, 4);
    pack.parameters.drift_weights = kWeights[round % 3];
    pack.parameters.drift_step_q16 = pick(1, kOneQ16);
    const rules::DriftStep step = driftSweep(pack, pack.parameters).step;
    const rules::DriftCell a = cell(), b = cell();
    const int push = round % 4 == 0 ? 0 : pick(-rules::kDriftMost, rules::kDriftMost), dither = pick(0, 255);
    const int flow = rules::driftFlow(step, a, b, push, dither);
    ASSERT_EQ(rules::driftFlow(step, b, a, -push, dither), -flow);
    ASSERT_LE(std::abs(std::int64_t(flow)) * 4, std::min(flow > 0 ? a.soil : b.soil, flow > 0 ? b.room : a.room));
  }
}

TEST(Drift, DitherRoundsUpAsOftenAsTheFractionSays) {
  // Of 256 consecutive sweeps an edge's dither takes nearly every value once.
  for (const int tick : {1, 77, 1 << 20})
    for (const int x : {0, 63, 12345}) {
      std::array<int, 256> seen{};
      for (int sweep = 0; sweep < 1024; ++sweep)
        ++seen[std::size_t(rules::driftDither(x, x / 3, 0, rules::driftPhase(tick, sweep)))];
      EXPECT_LE(std::ranges::max(seen), 6);
      EXPECT_GE(std::ranges::min(seen), 2);
    }
}

TEST(Drift, ABodyThatPushesHeapsSoilUpAheadOfIt) {
  Ground ground{"level", 60, 40, 20000, Cells(60 * 40, 0)};
  ScenePack pack = driftPack(ground);
  pack.parameters.displacement = Displacement::none;
  pack.parameters.obstacle_threshold_q = 20;
  addBody(pack, boxMesh(4000, 8000, 4000), 20000, 20000, 500);
  pack.bodies[0].force_n = 20000;
  const World world(std::move(pack));
  Simulation simulation = world.simulate();
  for (int tick = 0; tick < 20; ++tick)
    ASSERT_TRUE(simulation.step(std::vector{moved(simulation.state().poses[0], 500, 0)}));
  std::int64_t ahead = 0, behind = 0, aside = 0;
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 60; ++x) {
      const std::int64_t height = heightOf(simulation.state(), x, y);
      if (x >= 32) ahead += height;
      if (x < 20) behind += height;
      if (y < 10) aside += height - heightOf(simulation.state(), x, 39 - y);
    }
  EXPECT_GT(ahead, 1000);
  EXPECT_LE(behind, 0) << "none is thrown back";
  EXPECT_LT(std::abs(aside), 2000) << "as much to the left as to the right, but for dither";
}

}  // namespace
}  // namespace spoor::test
