// What only the gl backend has: groups, batches, schedules, a pool of tiles, a context; against native tick by tick.
#include "shaders/host/gl_backend.h"

#include <epoxy/egl.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <thread>

#include "shaders/host/gl_context.h"
#include "shaders/host/shader_loader.h"
#include "tests/gl_sessions.h"

namespace spoor::test {
namespace {

using Ticks = std::vector<std::vector<Pose>>;
using Changes = std::map<std::size_t, Parameters>;  // by index of the tick from which on they hold

/// What ticks are given besides poses.
struct Events {
  Changes changes;
  std::vector<std::vector<Crater>> craters;      // of every tick; empty: none in any
  std::vector<std::vector<Snowfall>> snowfalls;  // the same
};

Events eventsOf(const RandomWorld& random) {
  return {random.change == SIZE_MAX ? Changes{} : Changes{{random.change, random.changed}}, random.craters,
          random.snowfalls};
}

/// Calls step or begin of a simulation.
template <typename Call>
auto callAt(Call call, const std::vector<Pose>& poses, const Events& events, std::size_t tick) {
  const auto change = events.changes.find(tick);
  return call(poses, change == events.changes.end() ? std::nullopt : std::optional(change->second),
              events.craters.empty() ? std::vector<Crater>() : events.craters[tick],
              events.snowfalls.empty() ? std::vector<Snowfall>() : events.snowfalls[tick]);
}

Result<TickResult> stepAt(Simulation& simulation, const Ticks& ticks, const Events& events, std::size_t tick) {
  return callAt([&](auto&&... inputs) { return simulation.step(inputs...); }, ticks[tick], events, tick);
}

Status beginAt(Simulation& simulation, const Ticks& ticks, const Events& events, std::size_t tick) {
  return callAt([&](auto&&... inputs) { return simulation.begin(inputs...); }, ticks[tick], events, tick);
}

class GlBackends : public OnEveryBackend {};

/// Runs ticks on both and compares all that they tell.
void compareTicks(Simulation& simulation, Simulation& native, const Ticks& ticks, const Events& events = {}) {
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    const auto expected = stepAt(native, ticks, events, i);
    ASSERT_NO_FATAL_FAILURE(compareResults(stepAt(simulation, ticks, events, i), expected));
  }
  ASSERT_TRUE(recount(simulation.state()));
}

void compareWithNative(const BackendCase& backend_case, const World& world, const Ticks& ticks,
                       const Events& events = {}) {
  Simulation simulation = world.simulateOn(backend_case), native = world.simulate();
  compareTicks(simulation, native, ticks, events);
}

std::vector<Pose> initialPoses(const World& world) { return initialState(world.id, world.base).poses; }

/// Ticks in which every body moves and turns like this from where it is.
Ticks drive(std::vector<Pose> poses, int count, int dx, int dy, int dz = 0, int turn = 0) {
  Ticks ticks;
  for (int tick = 0; tick < count; ++tick) {
    for (Pose& pose : poses) pose = moved(pose, dx, dy, dz, turn);
    ticks.push_back(poses);
  }
  return ticks;
}

TEST_P(GlBackends, RandomWorldsHaveNativesHashesChangesAndCounts) {
  for (std::uint32_t seed = 1; seed < (GetParam().slow() ? 7 : 20); ++seed) {
    RandomWorld random = randomWorld(seed, 10);
    SCOPED_TRACE(random.description);
    const World world(std::move(random.pack));
    ASSERT_NO_FATAL_FAILURE(compareWithNative(GetParam(), world, random.ticks, eventsOf(random)));
  }
}

TEST_P(GlBackends, WorldsOfAnyShape) {
  for (const auto& [columns, rows] : {std::pair{1, 200}, {200, 1}, {1, 1}, {77, 131}, {65, 63}, {64, 128}}) {
    SCOPED_TRACE(std::to_string(columns) + " x " + std::to_string(rows));
    ScenePack pack = noisePack(columns, rows, 7, -2000, 2000, 5000);
    pack.parameters.obstacle_threshold_q = 20;
    addBody(pack, boxMesh(5000, 7000, 4000), columns * 400, rows * 300, 900);
    addBody(pack, tetrahedronMesh(9000), columns * 700, rows * 600, 2500);
    addBody(pack, bladeMesh(20000, 5000), columns * 500, rows * 500, 700);
    const World world(std::move(pack));
    ASSERT_NO_FATAL_FAILURE(compareWithNative(
        GetParam(), world,
        drive(initialPoses(world), GetParam().slow() ? 2 : 5, columns < 9 ? 90 : 1700, 1100, -30, 300)));
  }
}

TEST_P(GlBackends, ATickWithoutAnActiveTileAsksNothingOfTheDevice) {
  ScenePack pack = flatPack(70, 70);
  addBody(pack, boxMesh(3000, 3000, 3000), 20000, 30000, 400);
  const World world(std::move(pack));
  Simulation simulation = world.simulateOn(GetParam()), native = world.simulate();
  const std::vector<Pose> poses = initialPoses(world);
  compareTicks(simulation, native, Ticks(20, poses));
  const auto expected = native.step(poses), asleep = simulation.step(poses);
  ASSERT_NO_FATAL_FAILURE(compareResults(asleep, expected));
  EXPECT_EQ(asleep->effect.active_cells, 0);
  EXPECT_EQ(asleep->effect.dispatches, 0);
  EXPECT_EQ(asleep->effect.bytes_to_device, 0);
  EXPECT_EQ(asleep->effect.bytes_from_device, 0);
  compareTicks(simulation, native, drive(poses, 3, 800, 0));
}

/// Two boxes over a whole world, but for the last `free_cells` cells of its last row.
void coverAllBut(ScenePack& pack, int free_cells) {
  const int width = pack.width_cells * 1000, height = pack.height_cells * 1000;
  addBody(pack, boxMesh(width + 20000, 90000, 3000), width / 2, height - 1001 - 45000, 500);
  addBody(pack, boxMesh(90000, 800, 3000), width - free_cells * 1000 - 1 - 45000 + (free_cells > 0 ? 0 : 9000),
          height - 500, 500);
}

TEST_P(GlBackends, BodiesOverTheWholeWorldLeaveNoCellOrOneCellFree) {
  for (const int free_cells : {0, 1}) {
    SCOPED_TRACE(free_cells);
    ScenePack pack = flatPack(70, 66);
    pack.parameters.obstacle_threshold_q = 3;
    coverAllBut(pack, free_cells);
    const World world(std::move(pack));
    const std::vector<Pose> poses = initialPoses(world);
    Simulation simulation = world.simulateOn(GetParam()), native = world.simulate();
    const auto expected = native.step(poses);
    ASSERT_NO_FATAL_FAILURE(compareResults(simulation.step(poses), expected));
    EXPECT_EQ(expected->effect.penetrating_cells, 70 * 66 - free_cells);
    compareTicks(simulation, native, drive(poses, 4, 0, 0, -300));
  }
}

/// Ground as high and soil as deep as a pack may have, and a few free cells for what the bodies push.
void checkHeightLimit(const BackendCase& backend_case, int width, int height, int threshold) {
  constexpr int kSoil = (1 << 28) - 1, kHighest = (1 << 29) + kSoil;
  std::vector<std::int32_t> ground;
  for (int i = 0; i < width * height; ++i) ground.push_back(kHighest - i * 7919 % 1000);
  ScenePack pack = groundPack(width, height, ground, kSoil);
  pack.parameters.materials[0].slope_threshold_q = pack.parameters.materials[0].diagonal_threshold_q = 1;
  pack.parameters.obstacle_threshold_q = threshold;
  coverAllBut(pack, 4);
  const World world(std::move(pack));
  Simulation simulation = world.simulateOn(backend_case), native = world.simulate();
  const Ticks pressed = drive(initialPoses(world), 3, 0, 0, -(1 << 26));
  ASSERT_NO_FATAL_FAILURE(compareTicks(simulation, native, pressed));
  EXPECT_GT(heightOf(native.state(), width - 2, height - 1), rules::kHeightLimit - 5000);
  // And without bodies.
  ASSERT_NO_FATAL_FAILURE(compareTicks(simulation, native, drive(pressed.back(), 1, 1 << 28, 0)));
  compareTicks(simulation, native, Ticks(3, native.state().poses));
}

TEST_P(GlBackends, RoomEndsAtTheHeightLimit) {
  for (const int threshold : {0, 500})
    for (const auto& [width, height] : {std::pair{70, 66}, {64, 64}}) {
      SCOPED_TRACE(std::to_string(width) + " x " + std::to_string(height) + ", " + std::to_string(threshold));
      ASSERT_NO_FATAL_FAILURE(checkHeightLimit(GetParam(), width, height, threshold));
    }
}

TEST_P(GlBackends, LargeObstacleThresholdsShutWideGaps) {
  for (const int threshold : {1500, 20000, 1 << 20}) {
    SCOPED_TRACE(threshold);
    ScenePack pack = noisePack(100, 70, 3, -3000, 3000, 9000);
    pack.parameters.obstacle_threshold_q = threshold;
    addBody(pack, archMesh(30000, 20000, 9000), 40000, 30000, 700);
    addBody(pack, wedgeMesh(9000, 12000, 9000), 60000, 40000, 2000);
    const World world(std::move(pack));
    ASSERT_NO_FATAL_FAILURE(compareWithNative(GetParam(), world, drive(initialPoses(world), 5, 900, 400, -100, 200)));
  }
}

TEST_P(GlBackends, FastBodiesTakeManySubSteps) {
  ScenePack pack = noisePack(200, 90, 4, -900, 900, 20000);
  addBody(pack, boxMesh(4000, 9000, 4000), 20000, 30000, 900);
  addBody(pack, bladeMesh(12000, 4000), 30000, 60000, 600);
  const World world(std::move(pack));
  Ticks ticks = drive(initialPoses(world), 2, 31000, 2000);
  for (const auto& poses : drive(ticks.back(), 2, 7300, -4000, 0, 4000)) ticks.push_back(poses);
  for (const auto& poses : drive(ticks.back(), 1, -50000, 900)) ticks.push_back(poses);  // faster than sub-steps allow
  compareWithNative(GetParam(), world, ticks);
}

TEST_P(GlBackends, SoilThatALaterSubStepPushesAmongQuietRowsIsRelaxed) {
  // The box ends with row 7: what it pushes northwards lands in rows that no body covers and nothing has moved yet. The
  // world is of whole tiles: its border limits nothing.
  ScenePack pack = flatPack(64, 64);
  addBody(pack, boxMesh(4000, 3000, 4000), 8500, 6499, -3000);
  const World world(std::move(pack));
  const std::vector<Pose> poses = initialPoses(world);
  // Halfway through the second tick it is still above the ground.
  compareWithNative(GetParam(), world, {poses, {moved(poses[0], 2000, 0, -5000)}});
}

TEST_P(GlBackends, SoilThatIsPushedUpDoesNotFlowIntoARoof) {
  // As above, but a roof begins behind the first row of quiet ones: higher than any cell was before the tick.
  ScenePack pack = flatPack(64, 64);
  addBody(pack, boxMesh(4000, 3000, 4000), 8500, 6499, 6000);
  addBody(pack, boxMesh(12000, 4000, 4000), 8500, 11500, -1000);
  const World world(std::move(pack));
  Simulation native = world.simulate();
  const std::vector<Pose> poses = initialPoses(world);
  ASSERT_TRUE(native.step(poses));
  EXPECT_EQ(heightOf(native.state(), 8, 9), 1000) << "up to the roof";
  compareWithNative(GetParam(), world, {poses, poses});
}

TEST_P(GlBackends, RowsOfAFewGroupsDispatchTheSame) {
  GlOptions options = glOptionsOf(GetParam());
  options.shape.groups_per_row = 3;
  for (std::uint32_t seed = 300; seed < (GetParam().slow() ? 303 : 310); ++seed) {
    RandomWorld random = randomWorld(seed, 8);
    SCOPED_TRACE(random.description);
    const World world(std::move(random.pack));
    Simulation simulation(world.base, world.id, makeOwnBackend(options)), native = world.simulate();
    ASSERT_NO_FATAL_FAILURE(compareTicks(simulation, native, random.ticks, eventsOf(random)));
  }
}

TEST(GlDispatch, MoreGroupsThanARowOfADispatchHolds) {
  const BackendCase backend_case = glCases()[0];
  if (const std::string& lack = lackOf(backend_case); !lack.empty()) GTEST_SKIP() << lack;
  // As many tiles as a tick may have, with rods across them: 8 groups a tile, one for 8 rows, take away the undersides
  // first. The last group's rows are under the last rod.
  constexpr int kColumns = 256, kRows = 32, kTilesPerRod = 16;
  ScenePack pack = flatPack(kColumns * 64, kRows * 64);
  pack.parameters.sweeps_per_tick = 1;
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kColumns; column += kTilesPerRod)
      addBody(pack, boxMesh(kTilesPerRod * 64000 - 2000, 1000, 1000), (column + kTilesPerRod / 2) * 64000,
              row * 64000 + 60500, 300);
  const World world(std::move(pack));
  const std::vector<Pose> poses = initialPoses(world);
  Simulation simulation = world.simulateOn(backend_case), native = world.simulate();
  const auto expected = native.step(poses);
  ASSERT_NO_FATAL_FAILURE(compareResults(simulation.step(poses), expected));
  EXPECT_EQ(expected->effect.active_cells, std::int64_t(kColumns) * kRows * rules::kTileCells);
}

/// A car of one box that drives out along a row of tiles, and back.
struct RoundTrip {
  RoundTrip() : world(makePack()) {
    ticks = drive(initialPoses(world), 3, 60000, 200);
    for (const auto& poses : drive(ticks.back(), 3, -60000, -150, -20)) ticks.push_back(poses);
  }
  static ScenePack makePack() {
    ScenePack pack = noisePack(256, 60, 12, -2000, 2000, 20000);
    pack.parameters.sweeps_per_tick = 2;
    pack.parameters.materials[0].slope_threshold_q = 3000;  // the trail comes to rest soon
    pack.parameters.materials[0].diagonal_threshold_q = 4242;
    addBody(pack, boxMesh(9000, 20000, 5000), 30000, 30000, 800);
    return pack;
  }
  World world;
  Ticks ticks;
};

/// The lines that a backend with few slots says of its pool.
std::vector<std::string> runInPoolOf(const BackendCase& backend_case, int pool_tiles, const World& world,
                                     const Ticks& ticks) {
  std::vector<std::string> said;
  GlOptions options = glOptionsOf(backend_case);
  options.pool_tiles = pool_tiles;
  options.say = [&said](const std::string& line) {
    if (line.find("pool") != std::string::npos) said.push_back(line);
  };
  Simulation simulation(world.base, world.id, makeOwnBackend(options)), native = world.simulate();
  compareTicks(simulation, native, ticks);
  return said;
}

TEST_P(GlBackends, TilesThatLeaveASmallPoolComeBackAsTheyWere) {
  const RoundTrip trip;
  const auto said = runInPoolOf(GetParam(), 2, trip.world, trip.ticks);
  ASSERT_EQ(said.size(), 1u) << "said once";
  EXPECT_NE(said[0].find("full at "), std::string::npos) << said[0];
}

TEST_P(GlBackends, ATickWithMoreTilesThanThePoolMakesItLarger) {
  ScenePack pack = noisePack(300, 250, 13, -2000, 2000, 20000);
  pack.parameters.sweeps_per_tick = 2;
  addBody(pack, boxMesh(200000, 150000, 5000), 150000, 120000, 600);
  const World world(std::move(pack));
  runInPoolOf(GetParam(), 2, world, drive(initialPoses(world), GetParam().slow() ? 1 : 3, 900, 100));
}

TEST_P(GlBackends, APoolThatHoldsAllSaysNothing) {
  const RoundTrip trip;
  const Ticks way_out(trip.ticks.begin(), trip.ticks.begin() + 2);
  EXPECT_TRUE(runInPoolOf(GetParam(), 1 << 16, trip.world, way_out).empty());
}

/// Begins every tick before the one before it is finished.
void compareOverlapped(Simulation& simulation, Simulation& native, const Ticks& ticks, const Events& events = {}) {
  ASSERT_TRUE(beginAt(simulation, ticks, events, 0));
  for (std::size_t i = 1; i <= ticks.size(); ++i) {
    if (i < ticks.size()) {
      const Status begun = beginAt(simulation, ticks, events, i);
      ASSERT_TRUE(begun) << begun.error();
    }
    const auto expected = stepAt(native, ticks, events, i - 1);
    ASSERT_NO_FATAL_FAILURE(compareResults(simulation.finish(), expected));
  }
  ASSERT_TRUE(recount(simulation.state()));
  EXPECT_EQ(stateHash(simulation.state()), stateHash(native.state()));
}

class OverlappedTicks : public OnEveryBackend {};

TEST_P(OverlappedTicks, EqualTicksOneByOne) {
  for (std::uint32_t seed = 500; seed < (GetParam().slow() ? 504 : 520); ++seed) {
    RandomWorld random = randomWorld(seed, 12);
    SCOPED_TRACE(random.description);
    const World world(std::move(random.pack));
    Simulation simulation = world.simulateOn(GetParam()), native = world.simulate();
    ASSERT_NO_FATAL_FAILURE(compareOverlapped(simulation, native, random.ticks, eventsOf(random)));
  }
}

TEST_P(OverlappedTicks, EqualTicksOneByOneWhereTheGroundSleepsInBetween) {
  ScenePack pack = flatPack(70, 70);
  addBody(pack, boxMesh(3000, 3000, 3000), 20000, 30000, 400);
  const World world(std::move(pack));
  Ticks ticks(12, initialPoses(world));
  for (const auto& poses : drive(ticks.back(), 2, 900, 0)) ticks.push_back(poses);
  ticks.insert(ticks.end(), 12, ticks.back());
  for (const auto& poses : drive(ticks.back(), 2, 900, 0)) ticks.push_back(poses);
  Simulation simulation = world.simulateOn(GetParam()), native = world.simulate();
  compareOverlapped(simulation, native, ticks);
}

TEST_P(GlBackends, OverlappedTicksInASmallPoolEqualTicksOneByOne) {
  const RoundTrip trip;
  GlOptions options = glOptionsOf(GetParam());
  options.pool_tiles = 2;
  Simulation simulation(trip.world.base, trip.world.id, makeOwnBackend(options)), native = trip.world.simulate();
  compareOverlapped(simulation, native, trip.ticks);
}

TEST_P(GlBackends, CompactionThatBeginsAndEndsInOverlappedTicksInASmallPool) {
  const RoundTrip trip;
  Parameters compacting = trip.world.pack.parameters, not_compacting = compacting;
  compacting.materials[0].compression_q16 = kOneQ16 / 3;
  compacting.materials[0].compaction_limit_q16 = kOneQ16 / 4;
  const Events events = {{{1, compacting}, {3, not_compacting}, {4, compacting}}, {}, {}};
  for (const int pool_tiles : {2, 1 << 16}) {
    SCOPED_TRACE(std::to_string(pool_tiles) + " tiles");
    GlOptions options = glOptionsOf(GetParam());
    options.pool_tiles = pool_tiles;
    Simulation simulation(trip.world.base, trip.world.id, makeOwnBackend(options)), native = trip.world.simulate();
    ASSERT_NO_FATAL_FAILURE(compareOverlapped(simulation, native, trip.ticks, events));
    EXPECT_GT(simulation.state().ledger.compacted, 0);
  }
}

TEST_P(GlBackends, LargeFloodsAndLaterRoundsOverTheWholeWorld) {
  ScenePack pack = noisePack(300, 260, 14, -3000, 3000, 20000);
  pack.parameters.active_areas = 0;
  pack.parameters.nearest = NearestSearch::jump_flooding_plus_1;
  pack.parameters.sweeps_per_tick = 1;
  addBody(pack, wedgeMesh(120000, 160000, 12000), 110000, 130000, 3000);
  addBody(pack, archMesh(60000, 50000, 20000), 230000, 120000, 4000);
  const World world(std::move(pack));
  compareWithNative(GetParam(), world, drive(initialPoses(world), 2, 800, 300, -200));
}

TEST_P(GlBackends, AnyThreadMayRunATick) {
  RandomWorld random = randomWorld(26, 9);
  const World world(std::move(random.pack));
  std::unique_ptr<Backend> backend;
  std::thread([&] { backend = makeOwnBackend(glOptionsOf(GetParam())); }).join();
  Simulation simulation(world.base, world.id, std::move(backend)), native = world.simulate();
  for (std::size_t i = 0; i < random.ticks.size(); i += 3) {
    const Ticks part(random.ticks.begin() + std::ptrdiff_t(i), random.ticks.begin() + std::ptrdiff_t(i + 3));
    if (i % 2 == 0)
      std::thread([&] { compareTicks(simulation, native, part); }).join();
    else
      compareTicks(simulation, native, part);
    ASSERT_FALSE(HasFatalFailure());
  }
}

TEST_P(GlBackends, AMethodWhoseShaderDoesNotCompileFailsTheTickThatWantsItAndNoOther) {
  namespace fs = std::filesystem;
  const fs::path copy = fs::path(::testing::TempDir()) / ("spoor-shaders-" + GetParam().name);
  fs::remove_all(copy);
  fs::copy(shaderFolder(), copy, fs::copy_options::recursive);
  std::ofstream(copy / "sim" / "flood_pass.comp") << "#version 450 core\nvoid main() { nonsense }\n";
  ASSERT_EQ(setenv("SPOOR_SHADERS", copy.c_str(), 1), 0);
  const RoundTrip trip;
  Simulation simulation(trip.world.base, trip.world.id, makeOwnBackend(glOptionsOf(GetParam())));
  EXPECT_TRUE(simulation.step(trip.ticks[0]));
  Parameters flooding = trip.world.pack.parameters;
  flooding.nearest = NearestSearch::jump_flooding;
  const auto failed = simulation.step(trip.ticks[1], flooding);
  unsetenv("SPOOR_SHADERS");
  fs::remove_all(copy);
  ASSERT_FALSE(failed);
  EXPECT_NE(failed.error().find("flood_pass.comp:2"), std::string::npos) << failed.error();
}

TEST_P(GlBackends, TwoBackendsInOneThreadDoNotMeet) {
  RandomWorld first = randomWorld(28, 8), second = randomWorld(33, 8);
  const World world(std::move(first.pack)), other(std::move(second.pack));
  Simulation simulation = world.simulateOn(GetParam()), other_simulation = other.simulateOn(GetParam());
  Simulation native = world.simulate(), other_native = other.simulate();
  for (std::size_t i = 0; i < 8; ++i) {
    ASSERT_TRUE(simulation.begin(first.ticks[i]));
    ASSERT_TRUE(other_simulation.begin(second.ticks[i]));
    const auto expected = native.step(first.ticks[i]), other_expected = other_native.step(second.ticks[i]);
    ASSERT_NO_FATAL_FAILURE(compareResults(simulation.finish(), expected));
    ASSERT_NO_FATAL_FAILURE(compareResults(other_simulation.finish(), other_expected));
  }
}

TEST_P(GlBackends, ABackendThatForgetsTakesUpAnotherSession) {
  RandomWorld first = randomWorld(28, 6), second = randomWorld(33, 6);
  const World world(std::move(first.pack)), other(std::move(second.pack));
  for (int round = 0; round < 2; ++round) {
    Simulation unfinished = world.simulateOn(GetParam());
    ASSERT_TRUE(unfinished.begin(first.ticks[0]));
    ASSERT_TRUE(unfinished.begin(first.ticks[1]));
    { const Simulation goes_back = std::move(unfinished); }
    ASSERT_NO_FATAL_FAILURE(compareWithNative(GetParam(), other, second.ticks));
    ASSERT_NO_FATAL_FAILURE(compareWithNative(GetParam(), world, first.ticks));
  }
}

TEST_P(GlBackends, WhatIsCurrentOnTheThreadStaysCurrent) {
  RandomWorld random = randomWorld(26, 4);
  const World world(std::move(random.pack));
  auto renderer = openHeadlessContext();
  ASSERT_TRUE(renderer) << renderer.error();
  const EGLContext current = eglGetCurrentContext();
  ASSERT_NE(current, EGL_NO_CONTEXT);
  {
    Simulation simulation(world.base, world.id, makeOwnBackend(glOptionsOf(GetParam())));
    EXPECT_EQ(eglGetCurrentContext(), current) << "after it was made";
    for (const auto& poses : random.ticks) {
      ASSERT_TRUE(simulation.begin(poses));
      EXPECT_EQ(eglGetCurrentContext(), current);
      ASSERT_TRUE(simulation.finish());
      EXPECT_EQ(eglGetCurrentContext(), current);
    }
  }
  EXPECT_EQ(eglGetCurrentContext(), current) << "after it was destroyed";
  EXPECT_TRUE((*renderer)->isCurrent());
}

INSTANTIATE_TEST_SUITE_P(On, GlBackends, ::testing::ValuesIn(glCases()), caseName);
SPOOR_ON_EVERY_BACKEND(OverlappedTicks);

}  // namespace
}  // namespace spoor::test
