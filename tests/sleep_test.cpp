// Whatever is set in motion comes to rest, and what rests costs nothing and stays as it is.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "tests/scenes.h"

namespace spoor::test {
namespace {

class Sleep : public OnEveryBackend {};

/// Ticks until nothing is active any more, the bodies standing where they are; -1 if that takes over `limit`.
int ticksToSleep(Simulation& simulation, int limit) {
  for (int tick = 0; tick <= limit; ++tick) {
    const auto result = simulation.step(simulation.state().poses);
    EXPECT_TRUE(result);
    EXPECT_EQ(simulation.state().ledger.error(), 0);
    if (result->effect.active_cells == 0) return tick;
  }
  return -1;
}

/// A column of soil on level ground, and a needle beside it whose prick wakes the tile.
ScenePack columnPack(int size, int column_height, int threshold) {
  std::vector<std::int32_t> ground(std::size_t(size * size), 0);
  ground[std::size_t(size / 2 * size + size / 2)] = column_height;
  ScenePack pack = groundPack(size, size, ground, column_height + 100000);
  pack.parameters.materials[0].slope_threshold_q = threshold;
  pack.parameters.materials[0].diagonal_threshold_q = threshold * 99 / 70;  // times the root of 2
  addBody(pack, boxMesh(200, 200, 200), size / 2 * 1000 - 2500, size / 2 * 1000 + 500, 10);
  return pack;
}

/// Pricks, and takes the needle away.
void wakeColumn(Simulation& simulation) {
  const std::vector<Pose> poses = simulation.state().poses;
  ASSERT_TRUE(simulation.step(poses));
  ASSERT_TRUE(simulation.step(std::vector{moved(poses[0], 0, 0, 1 << 28)}));
}

TEST_P(Sleep, AColumnOfSandComesToRestWithEverySlopeAtMostItsThreshold) {
  for (const int threshold : {1, 7, 700}) {
    const World world(columnPack(90, 60000 * std::min(threshold, 70) / 70 + 500, threshold));
    Simulation simulation = world.simulateOn(GetParam());
    wakeColumn(simulation);
    const int ticks = ticksToSleep(simulation, 2000);
    ASSERT_GE(ticks, 0) << "threshold " << threshold;
    EXPECT_EQ(steepestExcess(world.pack, simulation.state().tiles), 0) << "threshold " << threshold;
  }
}

TEST_P(Sleep, APileIsRoundAndCentred) {
  const World world(columnPack(64, 4000000, 700));
  Simulation simulation = world.simulateOn(GetParam());
  wakeColumn(simulation);
  ASSERT_GE(ticksToSleep(simulation, 3000), 0);
  // Radius along the axes and the diagonals, and the first moment.
  const auto isHigh = [&](int x, int y) { return heightOf(simulation.state(), x, y) > 200; };
  int axis = 0, diagonal = 0;
  while (isHigh(32 + axis, 32)) ++axis;
  while (isHigh(32 + diagonal, 32 + diagonal)) ++diagonal;
  EXPECT_GT(axis, 10);
  EXPECT_NEAR(diagonal * std::sqrt(2.0) / axis, 1.0, 0.15);
  double moment_x = 0, moment_y = 0, mass = 0;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const double height = heightOf(simulation.state(), x, y);
      moment_x += height * (x - 32);
      moment_y += height * (y - 32);
      mass += height;
    }
  EXPECT_LT(std::abs(moment_x / mass), 1.0);
  EXPECT_LT(std::abs(moment_y / mass), 1.0);
}

/// Scenes whose bodies run for a while and then stand.
struct Scene {
  const char* name;
  ScenePack pack;
  std::vector<std::array<int, 4>> speed;  // of every body: dx, dy, dz, turn per tick
  int running_ticks;
};

std::vector<Scene> allScenes() {
  std::vector<Scene> result;
  {
    Scene scene{"a box that ploughs", noisePack(200, 90, 3, -900, 900, 20000), {{900, 0, 0, 0}}, 100};
    addBody(scene.pack, boxMesh(6000, 9000, 4000), 40000, 45000, 1500);
    result.push_back(std::move(scene));
  }
  {
    Scene scene{"a blade that turns across tiles", flatPack(140, 140), {{0, 0, 0, 400}}, 120};
    addBody(scene.pack, bladeMesh(60000, 6000), 66000, 63000, 3000);
    result.push_back(std::move(scene));
  }
  {
    Scene scene{"bodies that meet over thin soil",
                noisePack(190, 100, 4, -500, 500, 900),
                {{1700, 0, 0, 0}, {-1600, 30, 0, 10}},
                40};
    addBody(scene.pack, wedgeMesh(5000, 8000, 3000), 50000, 50000, 1200);
    addBody(scene.pack, boxMesh(7000, 5000, 3000), 140000, 48000, 800);
    result.push_back(std::move(scene));
  }
  {
    Scene scene{"a stamp that digs", flatPack(100, 100), {{0, 0, -200, 0}}, 60};
    addBody(scene.pack, archMesh(20000, 10000, 8000), 50000, 50000, 0);
    result.push_back(std::move(scene));
  }
  {
    Scene scene{"a body that leaves the world", flatPack(80, 80), {{2500, 600, 0, 90}}, 60};
    addBody(scene.pack, tetrahedronMesh(9000), 30000, 30000, 4000);
    result.push_back(std::move(scene));
  }
  return result;
}

/// All scenes; in a slow case every other one, for a while.
std::vector<Scene> scenesFor(const BackendCase& backend_case) {
  std::vector<Scene> scenes = allScenes(), chosen;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    if (backend_case.slow() && (i % 2 == 1) != backend_case.reversed) continue;
    if (backend_case.slow()) scenes[i].running_ticks = 12;
    chosen.push_back(std::move(scenes[i]));
  }
  return chosen;
}

TEST_P(Sleep, EverySceneSleepsWithin300TicksOnceItsBodiesStand) {
  for (Scene& scene : scenesFor(GetParam())) {
    SCOPED_TRACE(scene.name);
    const World world(std::move(scene.pack));
    Simulation simulation = world.simulateOn(GetParam());
    for (int tick = 0; tick < scene.running_ticks; ++tick) {
      std::vector<Pose> poses = simulation.state().poses;
      for (std::size_t i = 0; i < poses.size(); ++i) {
        const auto& [dx, dy, dz, turn] = scene.speed[i];
        poses[i] = moved(poses[i], dx, dy, dz, turn);
      }
      ASSERT_TRUE(simulation.step(poses));
    }
    const int ticks = ticksToSleep(simulation, 300);
    ASSERT_GE(ticks, 0);
    EXPECT_TRUE(simulation.state().tiles.awake().empty());
    const std::uint64_t hash = simulation.state().tiles_hash;
    for (int tick = 0; tick < 5; ++tick) {
      const auto result = simulation.step(simulation.state().poses);
      ASSERT_TRUE(result);
      EXPECT_EQ(result->effect.active_cells, 0);
      EXPECT_TRUE(result->effect.changes.empty());
    }
    EXPECT_EQ(simulation.state().tiles_hash, hash);
  }
}

TEST_P(Sleep, WhatSleepsWouldNotMoveIfItWereAwake) {
  for (Scene& scene : scenesFor(GetParam())) {
    SCOPED_TRACE(scene.name);
    const World world(std::move(scene.pack));
    Simulation simulation = world.simulateOn(GetParam());
    for (int tick = 0; tick < (GetParam().slow() ? 8 : 20); ++tick) {
      std::vector<Pose> poses = simulation.state().poses;
      for (std::size_t i = 0; i < poses.size(); ++i)
        poses[i] = moved(poses[i], scene.speed[i][0], scene.speed[i][1], scene.speed[i][2]);
      ASSERT_TRUE(simulation.step(poses));
    }
    ASSERT_GE(ticksToSleep(simulation, 300), 0);
    auto state = decodeSnapshot(encodeSnapshot(simulation.state(), world.base), world.id, world.base);
    ASSERT_TRUE(state);
    for (Tile* tile : state->tiles.sorted()) state->tiles.setWake(*tile, kWakeSelf);
    Simulation awake(world.base, std::move(*state), borrowBackend(GetParam()));
    const auto result = awake.step(simulation.state().poses);
    ASSERT_TRUE(result);
    EXPECT_GE(result->effect.active_cells, std::int64_t(simulation.state().tiles.size()) * rules::kTileCells);
    for (const Tile* tile : simulation.state().tiles.sorted())
      ASSERT_EQ(awake.state().tiles.find(tile->at)->hash, tile->hash)
          << "tile (" << tile->at.x << ", " << tile->at.y << ")";
  }
}

TEST_P(Sleep, AStandingBodyPressesOnlyInTheFirstTick) {
  ScenePack pack = flatPack(60, 60);
  addBody(pack, boxMesh(4000, 4000, 4000), 30000, 30000, 500);
  const World world(std::move(pack));
  Simulation simulation = world.simulateOn(GetParam());
  const auto first = simulation.step(simulation.state().poses);
  ASSERT_TRUE(first);
  EXPECT_GT(first->effect.penetrating_cells, 0);
  EXPECT_EQ(heightOf(simulation.state(), 30, 30), -500);
  ASSERT_GE(ticksToSleep(simulation, 10), 0);
  EXPECT_EQ(heightOf(simulation.state(), 30, 30), -500);
}

TEST_P(Sleep, SoilThatABodyHeldUpFallsOnceItIsGone) {
  ScenePack pack = flatPack(60, 60);
  addBody(pack, boxMesh(8000, 8000, 4000), 30000, 30000, 6000);
  const World world(std::move(pack));
  Simulation simulation = world.simulateOn(GetParam());
  ASSERT_GE(ticksToSleep(simulation, 300), 0);
  EXPECT_EQ(heightOf(simulation.state(), 30, 30), -6000) << "the body keeps its hole open";
  ASSERT_TRUE(simulation.step(std::vector{moved(simulation.state().poses[0], 0, 0, 20000)}));
  ASSERT_GE(ticksToSleep(simulation, 300), 0);
  EXPECT_GT(heightOf(simulation.state(), 30, 30), -6000);
  EXPECT_EQ(steepestExcess(world.pack, simulation.state().tiles), 0);
}

/// Ticks of at most `tile_limit` tiles: a needle pricks a column, is taken away, and all comes to rest.
struct CrowdedRun {
  WorldState state;
  std::size_t waiting_ticks = 0;
  bool asleep = false;
};

/// An awake tile, and the bits of its wake mask whose tiles wait.
using Kept = std::pair<TileCoordinate, WakeMask>;

std::vector<Kept> keptWaiting(const WorldState& state, const std::vector<TileCoordinate>& waiting) {
  std::vector<Kept> kept;
  for (const Tile* tile : state.tiles.awake()) {
    WakeMask bits = 0;
    for (int bit = 0; bit < 9; ++bit)
      if ((tile->wake_mask >> bit & 1) != 0 &&
          std::ranges::count(waiting, TileCoordinate{tile->at.x + bit % 3 - 1, tile->at.y + bit / 3 - 1}) > 0)
        bits = WakeMask(bits | 1 << bit);
    kept.push_back({tile->at, bits});
  }
  return kept;
}

void runCrowded(const World& world, Backend& backend, std::size_t tile_limit, CrowdedRun& run) {
  backend.forget();
  run.state = initialState(world.id, world.base);
  const std::vector<std::int32_t> reach = bodyReaches(world.pack);
  std::vector<Pose> poses = run.state.poses;
  for (int tick = 1; tick <= 3000 && !run.asleep; ++tick) {
    if (tick == 2) poses[0] = moved(poses[0], 0, 0, 1 << 28);
    auto plan = planTick(world.pack, reach, run.state, poses, run.state.parameters, {}, tile_limit);
    ASSERT_TRUE(plan) << plan.error();
    ASSERT_LE(plan->active.size(), tile_limit);
    run.waiting_ticks += plan->waiting.empty() ? 0 : 1;
    run.asleep = plan->active.empty();
    const std::vector<Kept> kept = keptWaiting(run.state, plan->waiting);
    ASSERT_TRUE(backend.submit(std::move(*plan), world.base, run.state));
    auto effect = backend.settle(run.state);
    ASSERT_TRUE(effect) << effect.error();
    run.state.tick = tick;
    run.state.previous_poses = std::exchange(run.state.poses, poses);
    ASSERT_TRUE(backend.collect(run.state, effect->changes));
    ASSERT_EQ(run.state.ledger.error(), 0);
    for (const auto& [at, bits] : kept)
      ASSERT_EQ(run.state.tiles.find(at)->wake_mask & bits, bits)
          << "tile " << at.x << ", " << at.y << " forgot, tick " << tick;
  }
}

TEST_P(Sleep, TilesThatAreTooManyForATickWaitAndComeToRestAllTheSame) {
  const World world(columnPack(200, 40000000, 2000));
  CrowdedRun run, native;
  ASSERT_NO_FATAL_FAILURE(runCrowded(world, *borrowBackend(GetParam()), 3, run));
  EXPECT_TRUE(run.asleep);
  EXPECT_GT(run.waiting_ticks, 10u);
  EXPECT_GT(run.state.tiles.size(), 3u);
  EXPECT_EQ(steepestExcess(world.pack, run.state.tiles), 0);
  EXPECT_TRUE(recount(run.state));
  ASSERT_NO_FATAL_FAILURE(runCrowded(world, *borrowBackend(backendCases().front()), 3, native));
  EXPECT_EQ(stateHash(run.state), stateHash(native.state));
}

SPOOR_ON_EVERY_BACKEND(Sleep);

}  // namespace
}  // namespace spoor::test
