// Snow on the gl backend: on tiles that are awake, asleep or wait, with craters in the same tick; against native.
#include <gtest/gtest.h>

#include <algorithm>

#include "shared/world/tile_snow.h"
#include "tests/gl_sessions.h"

namespace spoor::test {
namespace {

class GlSnow : public OnEveryBackend {};

constexpr int kTicks = 26;  // more than a beat and a half

/// Ground of 4 x 3 tiles and a body in every second one. Three snowfalls overlap; the second is so heavy that the
/// borders between beats slide; one ends and one begins on the way.
ScenePack snowyPack(int soil_depth) {
  ScenePack pack = noisePack(230, 150, 17, -600, 600, soil_depth);
  pack.parameters.materials[0].slope_threshold_q = 700;
  pack.parameters.materials[0].diagonal_threshold_q = 990;
  pack.parameters.sweeps_per_tick = 2;
  pack.crater_limits.radius_q = 40000;
  pack.crater_limits.hash_cell_q = 25000;
  for (int i = 0; i < 6; ++i)
    addBody(pack, boxMesh(5000, 5000, 4000), 32000 + i % 3 * 70000, i < 3 ? 20000 : 90000, 200);
  const std::int64_t one = std::int64_t(1) << 32;
  pack.snowfalls = {{{0, 0, 230, 150}, one * 7 / 3, 1, 1000, 5},
                    {{40, 10, 170, 110}, 70 * one + 12345, 1, 19, 77},
                    {{3, 5, 229, 141}, one / 100, 9, 30, 5}};
  return pack;
}

/// In every tick another body moves a little: its tiles wake, and sleep again before its next turn.
std::vector<std::vector<Pose>> inTurns(const World& world) {
  std::vector<Pose> poses = initialState(world.id, world.base).poses;
  std::vector<std::vector<Pose>> ticks;
  for (int tick = 0; tick < kTicks; ++tick) {
    Pose& pose = poses[std::size_t(tick % 6)];
    pose = moved(pose, tick % 4 * 200 - 300, 250, -40);
    ticks.push_back(poses);
  }
  return ticks;
}

/// A crater in every third tick, down to bedrock where soil is thin.
std::vector<Crater> cratersAt(int tick) {
  if (tick % 3 != 1) return {};
  Crater crater;
  crater.x_q = 30000 + tick * 6000;
  crater.y_q = 25000 + tick * 37 % 100 * 1000;
  crater.inner_radius_q = 5000;
  crater.crest_radius_q = 20000;
  crater.rim_height_q = 300;
  crater.depth_q = 1500;
  return {crater};
}

/// How often tiles of each kind took snow.
struct Taken {
  int awake = 0, asleep = 0;
};

void countTaken(const WorldState& state, std::int32_t tick, Taken& taken) {
  taken.awake += int(tilesInSnow(state, tick, SnowTiles::awake).size());
  taken.asleep += int(tilesInSnow(state, tick, SnowTiles::asleep).size());
}

/// @param ahead  each tick is begun before the one before is finished
void compareSessions(Simulation& simulation, const World& world, bool ahead, bool with_craters) {
  Simulation native = world.simulate();
  const auto ticks = inTurns(world);
  const auto cratersOf = [&](int tick) { return with_craters ? cratersAt(tick) : std::vector<Crater>{}; };
  Taken taken;
  int begun = 0;
  for (int i = 0; i < kTicks; ++i) {
    for (; begun < std::min(i + (ahead ? 2 : 1), kTicks); ++begun)
      ASSERT_TRUE(simulation.begin(ticks[std::size_t(begun)], {}, cratersOf(begun)));
    countTaken(native.state(), i + 1, taken);
    const auto expected = native.step(ticks[std::size_t(i)], {}, cratersOf(i));
    ASSERT_NO_FATAL_FAILURE(compareResults(simulation.finish(), expected));
  }
  ASSERT_TRUE(recount(simulation.state()));
  EXPECT_EQ(stateHash(simulation.state()), stateHash(native.state()));
  EXPECT_GE(taken.awake, 2);
  EXPECT_GE(taken.asleep, 2);
  EXPECT_GT(simulation.state().ledger.events, 0);
}

TEST_P(GlSnow, FallsOnTilesThatAreAwakeOrAsleepAsOnNative) {
  const World world(snowyPack(100000));
  for (const bool ahead : {false, true}) {
    if (GetParam().slow() && !ahead) continue;
    SCOPED_TRACE(ahead);
    Simulation simulation = world.simulateOn(GetParam());
    ASSERT_NO_FATAL_FAILURE(compareSessions(simulation, world, ahead, false));
  }
}

TEST_P(GlSnow, FallsBeforeCratersReachBedrock) {
  const World world(snowyPack(300));
  Simulation simulation = world.simulateOn(GetParam());
  compareSessions(simulation, world, true, true);
}

TEST_P(GlSnow, FallsOnTilesThatASmallPoolGaveUp) {
  ScenePack pack = snowyPack(300);
  pack.materials.push_back({"sand"});
  pack.parameters.materials.push_back(pack.parameters.materials[0]);
  pack.parameters.materials[1].slope_threshold_q = 60;
  pack.parameters.materials[1].compression_q16 = kOneQ16 / 3;
  pack.material_map.kind = MaterialMapKind::rules;
  pack.material_map.rules = {{1, 0, 1 << 20, 0, 1 << 20}};
  const World world(std::move(pack));
  GlOptions options = glOptionsOf(GetParam());
  options.pool_tiles = 2;
  Simulation simulation(world.base, world.id, makeOwnBackend(options));
  compareSessions(simulation, world, true, true);
}

TEST_P(GlSnow, FallsOnTilesThatWait) {
  ScenePack pack = snowyPack(3000);
  for (Snowfall& snowfall : pack.snowfalls) snowfall.rate_q32 = std::int64_t(400) << 32;  // most tiles never rest
  const World world(std::move(pack));
  constexpr std::size_t kLimit = 7;
  Simulation simulation(world.base, initialState(world.id, world.base), borrowBackend(GetParam()), kLimit);
  Simulation native(world.base, initialState(world.id, world.base), makeNativeBackend(), kLimit);
  const auto ticks = inTurns(world);
  ASSERT_TRUE(simulation.begin(ticks[0]));
  std::size_t waiting = 0;
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    if (i + 1 < ticks.size()) {
      ASSERT_TRUE(simulation.begin(ticks[i + 1]));
    }
    const auto expected = native.step(ticks[i]);
    ASSERT_NO_FATAL_FAILURE(compareResults(simulation.finish(), expected));
    waiting += expected->waiting_tiles;
  }
  EXPECT_TRUE(recount(simulation.state()));
  EXPECT_GT(waiting, 40u);
}

INSTANTIATE_TEST_SUITE_P(On, GlSnow, ::testing::ValuesIn(glCases()), caseName);

}  // namespace
}  // namespace spoor::test
