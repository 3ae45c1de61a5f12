// Materials and rule drift on the gl backend: stage by stage and tick by tick against native.
#include <gtest/gtest.h>

#include <random>

#include "tests/gl_sessions.h"
#include "tests/gl_stage_rig.h"

namespace spoor::test {
namespace {

using Ticks = std::vector<std::vector<Pose>>;

class GlMaterials : public OnEveryBackend {};

constexpr SlopeRule kRules[] = {SlopeRule::exchange, SlopeRule::flux, SlopeRule::interleaved, SlopeRule::scatter,
                                SlopeRule::drift};
constexpr DriftWeights kWeights[] = {DriftWeights::none, DriftWeights::displacement, DriftWeights::slope};

MaterialRules rulesOf(int threshold, int roughness_q16, int diffusion_q16, int repose_q16, int friction_inverse_q32) {
  MaterialRules rules;
  rules.slope_threshold_q = threshold;
  rules.diagonal_threshold_q = threshold == kNeverSteep ? kNeverSteep : threshold * 7 / 5;
  rules.roughness_q16 = roughness_q16;
  rules.diffusion_q16 = diffusion_q16;
  rules.repose_q16 = repose_q16;
  rules.friction_inverse_q32 = friction_inverse_q32;
  return rules;
}

/// Gives a pack materials that differ in everything, in patches so small that most edges are borders.
void addMaterials(ScenePack& pack, std::uint32_t seed) {
  pack.materials = {{"powder"}, {"loam"}, {"rock"}, {"slush"}};
  pack.parameters.materials = {rulesOf(700, 65536, 65536, 20000, 1 << 24), rulesOf(90, 30000, 9000, 3000, 1 << 30),
                               rulesOf(kNeverSteep, 0, 0, 62259, 0), rulesOf(0, 50000, 4 * 65536, 0, 1 << 27)};
  std::mt19937 engine(seed);
  pack.material_map.kind = MaterialMapKind::image;
  MaterialImage& image = pack.material_map.image;
  image.column_count = 37;
  image.row_count = 29;
  image.step_x_q32 = (std::int64_t(image.column_count) << 32) / pack.width_cells;
  image.step_y_q32 = (std::int64_t(image.row_count) << 32) / pack.height_cells;
  for (int i = 0; i < image.column_count * image.row_count; ++i) image.material.push_back(std::uint8_t(engine() % 4));
}

ScenePack mixedPack(int width, int height, std::uint32_t seed, int soil_depth = 6000) {
  ScenePack pack = noisePack(width, height, seed, -4000, 4000, soil_depth);
  addMaterials(pack, seed);
  pack.parameters.drift_step_q16 = 40000;
  pack.parameters.sweeps_per_tick = 3;
  return pack;
}

std::vector<Pose> initialPoses(const World& world) { return initialState(world.id, world.base).poses; }

/// Runs ticks on both and compares all that they tell. `ahead`: each is begun before the one before is finished.
void compareTicks(Simulation& simulation, Simulation& native, const Ticks& ticks, bool ahead = false) {
  std::size_t begun = 0;
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    for (; begun < std::min(i + (ahead ? 2 : 1), ticks.size()); ++begun) ASSERT_TRUE(simulation.begin(ticks[begun]));
    const auto expected = native.step(ticks[i]);
    ASSERT_NO_FATAL_FAILURE(compareResults(simulation.finish(), expected));
  }
  ASSERT_TRUE(recount(simulation.state()));
  ASSERT_EQ(stateHash(simulation.state()), stateHash(native.state()));
}

void compareWithNative(const BackendCase& backend_case, const World& world, const Ticks& ticks) {
  Simulation simulation = world.simulateOn(backend_case), native = world.simulate();
  compareTicks(simulation, native, ticks);
}

/// Ticks in which bodies wander, each its own way.
Ticks wander(const World& world, std::uint32_t seed, int count) {
  std::mt19937 engine(seed);
  const auto pick = [&engine](int low, int high) { return low + int(engine() % std::uint32_t(high - low + 1)); };
  std::vector<Pose> poses = initialPoses(world);
  Ticks ticks;
  for (int tick = 0; tick < count; ++tick) {
    for (Pose& pose : poses) pose = moved(pose, pick(-900, 2600), pick(-1500, 1700), pick(-90, 60), pick(-700, 700));
    ticks.push_back(poses);
  }
  return ticks;
}

/// Heights after sweeps over random ground, in part beneath undersides.
Cells swept(StageRig& rig, std::uint32_t seed, bool covered) {
  std::mt19937 engine(seed);
  Cells heights = rig.height();
  for (std::int32_t& height : heights)
    if (engine() % 3 == 0) height += int(engine() % 5000);
  rig.setHeight(heights);
  if (covered) coverAtRandom(rig, seed);
  rig.relax(0, 2);
  rig.relax(2, 1);
  return rig.tileHeights();
}

TEST_P(GlMaterials, BordersGiveAndTakeAsOnNativeByEveryRule) {
  std::uint32_t seed = 1;
  for (const SlopeRule rule : kRules)
    for (const DriftWeights weights : kWeights) {
      if (rule != SlopeRule::drift && weights != DriftWeights::none) continue;
      SCOPED_TRACE("rule " + std::to_string(int(rule)) + ", weights " + std::to_string(int(weights)));
      ScenePack pack = mixedPack(77, 131, ++seed);
      pack.parameters.slopes = rule;
      pack.parameters.drift_weights = weights;
      const World world(std::move(pack));
      for (const bool covered : {false, true}) {
        NativeStageRig native(world);
        const Cells expected = swept(native, seed, covered);
        const Cells untouched = NativeStageRig(world).tileHeights();
        EXPECT_NE(expected, untouched);
        EXPECT_EQ(swept(*makeGlStageRig(GetParam(), world, {}), seed, covered), expected) << covered;
      }
    }
}

/// Heights of two cells side by side, the first one's material being `first`, after a sweep.
Cells twoCells(const BackendCase& backend_case, SlopeRule rule, int first, int left, int right) {
  ScenePack pack = groundPack(2, 1, {left, right}, 100000);
  pack.materials = {{"loose"}, {"firm"}};
  pack.parameters.materials = {rulesOf(100, 65536, 65536, 0, 0), rulesOf(1000, 32768, 32768, 0, 0)};
  pack.parameters.slopes = rule;
  pack.parameters.drift_step_q16 = 8192;
  pack.material_map.kind = MaterialMapKind::image;
  pack.material_map.image = {
      2, 1, std::int64_t(1) << 32, std::int64_t(1) << 32, {std::uint8_t(first), std::uint8_t(1 - first)}};
  const World world(std::move(pack));
  const auto rig = makeGlStageRig(backend_case, world, {});
  rig->relax(0, 1);
  return rig->height();
}

TEST_P(GlMaterials, TheHigherCellsMaterialDecides) {
  // 2000 higher: of loose soil an excess of 1900 slides, of firm soil one of 1000, half of it by roughness.
  for (const int loose_first : {1, 0}) {
    const auto heights = [&](SlopeRule rule, bool loose_high) {
      const bool high_first = loose_high == (loose_first == 1);
      Cells cells = twoCells(GetParam(), rule, loose_first == 1 ? 0 : 1, high_first ? 2000 : 0, high_first ? 0 : 2000);
      return high_first ? cells : Cells{cells[1], cells[0]};
    };
    EXPECT_EQ(heights(SlopeRule::exchange, true), (Cells{1050, 950}));
    EXPECT_EQ(heights(SlopeRule::exchange, false), (Cells{1500, 500}));
    EXPECT_EQ(heights(SlopeRule::flux, true), (Cells{2000 - 1900 / 8, 1900 / 8}));
    EXPECT_EQ(heights(SlopeRule::flux, false), (Cells{2000 - 500 / 8, 500 / 8}));
    EXPECT_EQ(heights(SlopeRule::scatter, true), (Cells{0, 2000}));
    EXPECT_EQ(heights(SlopeRule::interleaved, false), (Cells{1000, 1000}));
  }
}

/// Bodies that push, of which two overlap from the beginning.
void addPushers(ScenePack& pack) {
  addBody(pack, boxMesh(9000, 14000, 4000), 20000, 30000, 700);
  addBody(pack, wedgeMesh(12000, 9000, 5000), 24000, 34000, 900);
  addBody(pack, tetrahedronMesh(14000), 50000, 20000, 1500);
  addBody(pack, bladeMesh(16000, 5000), 40000, 44000, 600);
  const int forces[] = {900, 1 << 26, 40000, 0};
  for (std::size_t i = 0; i < pack.bodies.size(); ++i) pack.bodies[i].force_n = forces[i];
}

TEST_P(GlMaterials, OverlappingBodiesPushAsOnNativeWithEveryWeight) {
  for (const DriftWeights weights : kWeights)
    for (const Displacement displacement : {Displacement::none, Displacement::direct}) {
      SCOPED_TRACE(std::to_string(int(weights)) + (displacement == Displacement::none ? ", none" : ""));
      ScenePack pack = mixedPack(90, 70, 9);
      pack.parameters.slopes = SlopeRule::drift;
      pack.parameters.drift_weights = weights;
      pack.parameters.displacement = displacement;
      pack.parameters.obstacle_threshold_q = 30;
      addPushers(pack);
      const World world(std::move(pack));
      ASSERT_NO_FATAL_FAILURE(compareWithNative(GetParam(), world, wander(world, 5, GetParam().slow() ? 3 : 5)));
    }
}

TEST_P(GlMaterials, APushIsSpreadOverContactsAndMovesSoilByItsFriction) {
  // 7 x 9 cells beneath a box that came one cell eastwards and presses on all of them.
  ScenePack pack = flatPack(40, 30);
  pack.parameters.slopes = SlopeRule::drift;
  pack.parameters.displacement = Displacement::none;
  pack.parameters.drift_weights = DriftWeights::none;
  pack.parameters.sweeps_per_tick = 1;
  pack.parameters.drift_step_q16 = 8192;
  pack.parameters.materials[0].friction_inverse_q32 = 1 << 30;
  addBody(pack, boxMesh(6800, 8800, 3000), 15500, 15500, 100);
  pack.bodies[0].force_n = 7 * 9;
  const World world(std::move(pack));
  std::vector<Pose> poses = initialPoses(world);
  Simulation simulation = world.simulateOn(GetParam()), native = world.simulate();
  ASSERT_NO_FATAL_FAILURE(compareTicks(simulation, native, {poses, {moved(poses[0], 1000, 0)}}));
  // A newton on each: a quarter of a cell in a unit of time, a 32nd in the step; half of it over the outer edges.
  const auto heights = [&](int x) { return heightOf(simulation.state(), x, 15); };
  EXPECT_NEAR(heights(12), -16, 1);
  EXPECT_NEAR(heights(13), -16, 1);
  EXPECT_NEAR(heights(16), 0, 1);
  EXPECT_NEAR(heights(19), 16, 1);
  EXPECT_NEAR(heights(20), 16, 1);
}

TEST_P(GlMaterials, WithoutDisplacementUndersidesStopNothingButTheWorldsBorderDoes) {
  for (const SlopeRule rule : kRules) {
    SCOPED_TRACE(int(rule));
    ScenePack pack = mixedPack(71, 67, 3, 9000);
    pack.parameters.slopes = rule;
    pack.parameters.displacement = Displacement::none;
    pack.parameters.sweeps_per_tick = 5;
    for (MaterialRules& own : pack.parameters.materials) own.slope_threshold_q = own.diagonal_threshold_q = 20;
    addBody(pack, boxMesh(30000, 30000, 3000), 66000, 60000, 1200);
    addBody(pack, boxMesh(9000, 9000, 3000), 30000, 30000, -10);
    const World world(std::move(pack));
    ASSERT_NO_FATAL_FAILURE(compareWithNative(GetParam(), world, wander(world, 3, GetParam().slow() ? 2 : 4)));
  }
}

TEST_P(GlMaterials, SoilIsPressedTogetherByItsMaterial) {
  ScenePack pack = mixedPack(90, 70, 6);
  const int shares[] = {0, 20000, 65536, 50000}, limits[] = {0, 0, 9000, 30000};
  for (std::size_t i = 0; i < 4; ++i) {
    pack.parameters.materials[i].compression_q16 = shares[i];
    pack.parameters.materials[i].compaction_limit_q16 = limits[i];
  }
  addPushers(pack);
  const World world(std::move(pack));
  Simulation simulation = world.simulateOn(GetParam()), native = world.simulate();
  ASSERT_NO_FATAL_FAILURE(compareTicks(simulation, native, wander(world, 8, GetParam().slow() ? 3 : 6)));
  EXPECT_GT(simulation.state().ledger.compacted, 0);
}

TEST_P(GlMaterials, StayWithTilesThatLeaveASmallPool) {
  ScenePack pack = mixedPack(256, 60, 12, 20000);
  pack.parameters.sweeps_per_tick = 2;
  addBody(pack, boxMesh(9000, 20000, 5000), 30000, 30000, 800);
  const World world(std::move(pack));
  Ticks ticks;
  std::vector<Pose> poses = initialPoses(world);
  for (const int dx : {40000, 60000, -60000, -40000}) ticks.push_back(poses = {moved(poses[0], dx, 170, -10)});
  GlOptions options = glOptionsOf(GetParam());
  options.pool_tiles = 2;
  Simulation simulation(world.base, world.id, makeOwnBackend(options)), native = world.simulate();
  compareTicks(simulation, native, ticks, true);
}

TEST_P(GlMaterials, BodiesThatGrowAndShrinkPressAsOnNative) {
  ScenePack pack = mixedPack(70, 60, 4);
  addPushers(pack);
  const World world(std::move(pack));
  Ticks ticks = wander(world, 2, 4);
  const int scales[] = {65536, 30000, 900, 50000};
  for (std::size_t tick = 0; tick < ticks.size(); ++tick)
    for (std::size_t i = 0; i < 4; ++i) ticks[tick][i].scale_q16 = scales[(i + tick) % 4];
  compareWithNative(GetParam(), world, ticks);
}

INSTANTIATE_TEST_SUITE_P(On, GlMaterials, ::testing::ValuesIn(glCases()), caseName);

}  // namespace
}  // namespace spoor::test
