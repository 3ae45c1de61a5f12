// The parameters as people name them: [thesis] in scenes, presets, thresholds, assignments as text, descriptions.
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <sstream>

#include "server/import/importer.h"
#include "server/named_parameters.h"
#include "shared/base/bytes.h"
#include "shared/world/base_terrain.h"
#include "tests/import_fixture.h"

#ifndef SPOOR_SCENES_DIR
#define SPOOR_SCENES_DIR "scenes"
#endif

namespace spoor {
namespace {

using Thesis = Import;

const char* const kGround = "[base]\nkind = \"noise\"\nfrequency_per_m = 0.1\nhighest_m = 1.0\n";

/// A scene of one square metre in cells of 0.05 m with the given lines in [thesis], and `more` before that.
std::string thesisScene(const std::string& lines, const std::string& more = "") {
  return more + "[world]\ncells = [20, 20]\ncell_m = 0.05\n" + kGround + "[thesis]\n" + lines;
}

Parameters parametersOf(const Result<ImportedScene>& scene) {
  EXPECT_TRUE(scene) << scene.error();
  return scene ? scene->pack.parameters : Parameters{};
}

/// What a scene without any table for it gets.
Parameters defaults() {
  Parameters parameters;
  parameters.obstacle_threshold_q = 10;
  parameters.materials[0].slope_threshold_q = 350;  // tan 35 * 500
  parameters.materials[0].diagonal_threshold_q = 495;
  parameters.materials[0].repose_q16 = 25486;  // 35 / 90
  return parameters;
}

/// Applies assignments to the default settings; fails the test where they do not go.
Parameters compiled(const std::string& assignments, std::int32_t cell_q = 500) {
  NamedSettings settings;
  std::vector<NamedValue> values;
  std::stringstream list(assignments);
  for (std::string assignment; std::getline(list, assignment, ',');) {
    const auto value = parseNamed(assignment);
    EXPECT_TRUE(value) << value.error();
    if (value) values.push_back(*value);
  }
  std::vector<std::string> notes;
  const auto error = applyNamed(values, cell_q, settings, notes);
  EXPECT_FALSE(error) << error->parameter->name << ": " << error->why;
  return settings.parameters;
}

TEST_F(Thesis, WithoutTheTableAllIsAsItWas) {
  EXPECT_EQ(parametersOf(importScene(write("scene.toml", thesisScene("")))), defaults());
}

TEST_F(Thesis, EveryKeyHasItsInteger) {
  const struct {
    const char* line;
    void (*expect)(ScenePack&);
  } cases[] = {
      {"numVerticesPerRow = 64", [](ScenePack& p) { p.patches_per_row = 64; }},
      {"numIterationsBlurNormals = 3", [](ScenePack& p) { p.normal_blur_passes = 3; }},
      {"compression = 0.9", [](ScenePack& p) { p.parameters.materials[0].compression_q16 = 58982; }},  // 58982.4
      {"compression = 1e-9", [](ScenePack& p) { p.parameters.materials[0].compression_q16 = 1; }},     // not 0
      {"roughness = 0", [](ScenePack& p) { p.parameters.materials[0].roughness_q16 = 0; }},
      {"roughness = 0.6", [](ScenePack& p) { p.parameters.materials[0].roughness_q16 = 39322; }},  // 39321.6
      {"slopeThreshold = 1.9",
       [](ScenePack& p) {
         p.parameters.materials[0].slope_threshold_q = 952;      // 10^4 tan(1.9 * 0.05) = 952.87
         p.parameters.materials[0].diagonal_threshold_q = 1346;  // 952 sqrt 2 = 1346.3
         p.parameters.materials[0].repose_q16 = 45359;           // atan(952 / 500) * 2 / pi = 0.69208
       }},
      {"angleOfRepose = 45",
       [](ScenePack& p) {
         p.parameters.materials[0].slope_threshold_q = 500;
         p.parameters.materials[0].diagonal_threshold_q = 707;
         p.parameters.materials[0].repose_q16 = 32768;
       }},
      {"numIterationsDisplaceMaterialToContour = 7", [](ScenePack& p) { p.parameters.displace_iterations = 7; }},
      {"numIterationsEvenOutSlopes = 1000", [](ScenePack& p) { p.parameters.sweeps_per_tick = 1000; }},
      {"penetrationDivider = 250", [](ScenePack& p) { p.parameters.penetration_divider_q = 250; }},
      {"activeAreaMargin = 0.3", [](ScenePack& p) { p.parameters.active_margin_cells = 6; }},
      {"activeAreaMargin = 0.3001", [](ScenePack& p) { p.parameters.active_margin_cells = 7; }},
      {"frustumHeight = 2.5", [](ScenePack& p) { p.parameters.frustum_height_q = 25000; }},
      {"obstacleThreshold = 1000", [](ScenePack& p) { p.parameters.obstacle_threshold_q = 1000; }},
      {"displacement = \"iterative\"", [](ScenePack& p) { p.parameters.displacement = Displacement::iterative; }},
      {"displacement = \"spread\"", [](ScenePack& p) { p.parameters.displacement = Displacement::spread; }},
      {"nearest = \"jump_flooding\"", [](ScenePack& p) { p.parameters.nearest = NearestSearch::jump_flooding; }},
      {"nearest = \"jump_flooding\"\njumpFloodingVariant = \"JFA\"",
       [](ScenePack& p) { p.parameters.nearest = NearestSearch::jump_flooding; }},
      {"nearest = \"jump_flooding\"\njumpFloodingVariant = \"JFA+1\"",
       [](ScenePack& p) { p.parameters.nearest = NearestSearch::jump_flooding_plus_1; }},
      {"nearest = \"jump_flooding\"\njumpFloodingVariant = \"JFA+2\"",
       [](ScenePack& p) { p.parameters.nearest = NearestSearch::jump_flooding_plus_2; }},
      {"jumpFloodingVariant = \"1+JFA\"\nnearest = \"jump_flooding\"",
       [](ScenePack& p) { p.parameters.nearest = NearestSearch::one_plus_jump_flooding; }},
      {"nearest = \"jump_flooding\"\njumpFloodingVariant = \"JFA^2\"",
       [](ScenePack& p) { p.parameters.nearest = NearestSearch::jump_flooding_squared; }},
      {"metric = \"manhattan\"", [](ScenePack& p) { p.parameters.metric = Metric::manhattan; }},
      {"metric = \"chebyshev\"", [](ScenePack& p) { p.parameters.metric = Metric::chebyshev; }},
      {"slopes = \"flux\"", [](ScenePack& p) { p.parameters.slopes = SlopeRule::flux; }},
      {"slopes = \"interleaved\"", [](ScenePack& p) { p.parameters.slopes = SlopeRule::interleaved; }},
      {"slopes = \"scatter\"", [](ScenePack& p) { p.parameters.slopes = SlopeRule::scatter; }},
      {"slopes = \"drift\"", [](ScenePack& p) { p.parameters.slopes = SlopeRule::drift; }},
      {"displacement = \"none\"", [](ScenePack& p) { p.parameters.displacement = Displacement::none; }},
      {"driftWeights = \"none\"", [](ScenePack& p) { p.parameters.drift_weights = DriftWeights::none; }},
      {"driftWeights = \"displacement\"",
       [](ScenePack& p) { p.parameters.drift_weights = DriftWeights::displacement; }},
      {"driftStep = 0.3", [](ScenePack& p) { p.parameters.drift_step_q16 = 19661; }},              // 19660.8
      {"diffusion = 0.9", [](ScenePack& p) { p.parameters.materials[0].diffusion_q16 = 58982; }},  // 58982.4
      {"frictionInverse = 6e-4",
       [](ScenePack& p) { p.parameters.materials[0].friction_inverse_q32 = 2576980; }},  // 2576980.4
      {"compactionLimit = 0.25", [](ScenePack& p) { p.parameters.materials[0].compaction_limit_q16 = 16384; }},
      {"spreadCells = 64", [](ScenePack& p) { p.parameters.spread_cells = 64; }},
      {"capacityRounds = 1", [](ScenePack& p) { p.parameters.capacity_rounds = 1; }},
      {"activeAreas = false", [](ScenePack& p) { p.parameters.active_areas = 0; }},
  };
  const Result<ImportedScene> plain = importScene(write("scene.toml", thesisScene("")));
  ASSERT_TRUE(plain) << plain.error();
  for (const auto& given : cases) {
    const Result<ImportedScene> scene = importScene(write("scene.toml", thesisScene(given.line)));
    ASSERT_TRUE(scene) << scene.error();
    ScenePack expected = plain->pack;
    given.expect(expected);
    EXPECT_EQ(scene->pack.parameters, expected.parameters) << given.line;
    EXPECT_NE(encodePack(scene->pack), encodePack(plain->pack)) << given.line << " changes nothing";
    EXPECT_EQ(encodePack(scene->pack), encodePack(expected)) << given.line;
    const Result<ScenePack> again = decodePack(encodePack(scene->pack));
    ASSERT_TRUE(again) << again.error();
    EXPECT_EQ(again->parameters, expected.parameters) << given.line;
    EXPECT_TRUE(scene->notes.empty()) << scene->notes.front();
  }
}

TEST_F(Thesis, APackWithParametersOutOfRangeIsRefused) {
  const auto scene = importScene(write("scene.toml", thesisScene("")));
  ASSERT_TRUE(scene) << scene.error();
  const std::vector<std::uint8_t> bytes = encodePack(scene->pack);
  ByteWriter block;
  putParameters(block, scene->pack.parameters);
  const auto at = std::search(bytes.begin(), bytes.end(), block.bytes.begin(), block.bytes.end()) - bytes.begin();
  ASSERT_LT(std::size_t(at), bytes.size());
  const char* const names[] = {"displacement", "nearest", "metric", "slopes", "drift_weights", "active_areas"};
  const std::size_t count_at = 6 + 9 * 4;  // of the byte that counts materials
  for (std::size_t i = 0; i < parametersBytes(1); ++i) {
    if (i >= 6 && i < count_at && (i - 6) % 4 != 3) continue;
    if (i > count_at && (i - count_at - 1) % 4 != 3)
      continue;  // the highest byte of each number: negative, or too large
    std::vector<std::uint8_t> wrong = bytes;
    wrong[std::size_t(at) + i] = 0xff;
    const auto refused = decodePack(wrong);
    ASSERT_FALSE(refused) << i;
    const std::string part = i == count_at ? "pack: truncated" : "pack: parameters: ";
    EXPECT_TRUE(contains(refused.error(), part + std::string(i < 6 ? names[i] : ""))) << refused.error();
  }
}

TEST_F(Thesis, TerrainSizeAndHeightmapSizeAreTheWorld) {
  const Result<ImportedScene> exact =
      importScene(write("scene.toml", std::string(kGround) + "[thesis]\nterrainSize = 25.6\nheightmapSize = 512\n"));
  ASSERT_TRUE(exact) << exact.error();
  EXPECT_EQ(exact->pack.cell_q, 500);
  EXPECT_EQ(exact->pack.width_cells, 512);
  EXPECT_EQ(exact->pack.height_cells, 512);
  EXPECT_TRUE(exact->notes.empty());
  const Result<ImportedScene> rounded =
      importScene(write("scene.toml", std::string(kGround) + "[thesis]\nterrainSize = 200\nheightmapSize = 4096\n"));
  ASSERT_TRUE(rounded) << rounded.error();
  EXPECT_EQ(rounded->pack.cell_q, 488);  // 488.28
  EXPECT_EQ(rounded->pack.width_cells, 4096);
  ASSERT_EQ(rounded->notes.size(), 1u);
  EXPECT_TRUE(contains(rounded->notes[0], "200 m become 199.8848 m")) << rounded->notes[0];
}

TEST_F(Thesis, PresetsAreTable5_1) {
  Parameters iterative = defaults();
  iterative.displacement = Displacement::iterative;
  iterative.slopes = SlopeRule::interleaved;
  iterative.nearest = NearestSearch::jump_flooding;
  iterative.capacity_rounds = 1;
  iterative.obstacle_threshold_q = 1000;
  Parameters ssbo = iterative, multiple = iterative;
  ssbo.displacement = Displacement::direct;
  multiple.displacement = Displacement::spread;
  ssbo.slopes = multiple.slopes = SlopeRule::scatter;
  const auto withPreset = [&](const std::string& name, const std::string& more = "") {
    return parametersOf(importScene(write("scene.toml", thesisScene("preset = \"" + name + "\"\n" + more))));
  };
  EXPECT_EQ(withPreset("thesis-iterative"), iterative);
  EXPECT_EQ(withPreset("thesis-ssbo"), ssbo);
  EXPECT_EQ(withPreset("thesis-ssbo-multiple"), multiple);
}

TEST_F(Thesis, KeysBesideAPresetOverrideIt) {
  const std::string lines =
      "slopes = \"flux\"\njumpFloodingVariant = \"JFA+2\"\ncapacityRounds = 3\npreset = \"thesis-ssbo\"\n"
      "compactionLimit = 0.5\nmetric = \"chebyshev\"\n";
  const Parameters own = parametersOf(importScene(write("scene.toml", thesisScene(lines + "obstacleThreshold = 7\n"))));
  EXPECT_EQ(own.slopes, SlopeRule::flux);
  EXPECT_EQ(own.nearest, NearestSearch::jump_flooding_plus_2);
  EXPECT_EQ(own.capacity_rounds, 3);
  EXPECT_EQ(own.materials[0].compaction_limit_q16, 32768);
  EXPECT_EQ(own.metric, Metric::chebyshev);
  EXPECT_EQ(own.obstacle_threshold_q, 7);
  const Parameters soil = parametersOf(importScene(
      write("scene.toml", thesisScene(lines, "[soil]\nobstacle_threshold_m = 0.002\nsweeps_per_tick = 900\n"))));
  EXPECT_EQ(soil.obstacle_threshold_q, 20);
  EXPECT_EQ(soil.sweeps_per_tick, 900);
}

TEST_F(Thesis, WrongKeysNameLineKeyAndReason) {
  const struct {
    std::string scene;
    std::vector<std::string> parts;
  } cases[] = {
      {thesisScene("colour = 1"), {"scene.toml:9: ", "thesis.colour", "unknown key"}},
      {thesisScene("compression = 1.01"), {":9: ", "thesis.compression", "1.01 is not within 0 .. 1"}},
      {thesisScene("compression = -0.1"), {"thesis.compression", "-0.1 is not within"}},
      {thesisScene("roughness = \"a\""), {"thesis.roughness", "must be a number", "not a text"}},
      {thesisScene("slopeThreshold = -1"), {"thesis.slopeThreshold", "0 .. 20000 radians per metre"}},
      {thesisScene("slopeThreshold = nan"), {"thesis.slopeThreshold", "nan"}},
      {thesisScene("numVerticesPerRow = 4097"), {"thesis.numVerticesPerRow", "0 .. 4096 patches"}},
      {thesisScene("numIterationsBlurNormals = 17"), {"thesis.numIterationsBlurNormals", "0 .. 16"}},
      {thesisScene("numIterationsEvenOutSlopes = 1001"), {"thesis.numIterationsEvenOutSlopes", "0 .. 1000"}},
      {thesisScene("numIterationsEvenOutSlopes = 1.5"), {"thesis.numIterationsEvenOutSlopes", "integer"}},
      {thesisScene("numIterationsDisplaceMaterialToContour = -1"), {"ToContour", "0 .. 1000"}},
      {thesisScene("penetrationDivider = 0"), {"thesis.penetrationDivider", "1 .. 536870912 units of 0.1 mm"}},
      {thesisScene("obstacleThreshold = -1"), {"thesis.obstacleThreshold"}},
      {thesisScene("frustumHeight = 53001"), {"thesis.frustumHeight", "0 .. 53000 m"}},
      {thesisScene("activeAreaMargin = 204.81"), {"thesis.activeAreaMargin", "4097 cells, the limit is 4096"}},
      {thesisScene("activeAreas = 1"), {"thesis.activeAreas", "true or false"}},
      {thesisScene("displacement = \"up\""), {"thesis.displacement", "none of: direct, iterative, spread, none"}},
      {thesisScene("nearest = \"far\""), {"thesis.nearest", "exact, jump_flooding"}},
      {thesisScene("jumpFloodingVariant = \"JFA\""), {"thesis.jumpFloodingVariant", "nearest is exact"}},
      {thesisScene("nearest = \"jump_flooding\"\njumpFloodingVariant = \"JFA+3\""), {":10: ", "JFA, JFA+1, JFA+2"}},
      {thesisScene("metric = 2"), {"thesis.metric", "text"}},
      {thesisScene("slopes = \"steep\""), {"thesis.slopes", "exchange, flux, interleaved, scatter, drift"}},
      {thesisScene("compactionLimit = 2"), {"thesis.compactionLimit", "0 .. 1"}},
      {thesisScene("spreadCells = 65"), {"thesis.spreadCells", "1 .. 64 cells"}},
      {thesisScene("capacityRounds = 0"), {"thesis.capacityRounds", "1 .. 16"}},
      {thesisScene("preset = \"thesis\""), {"thesis.preset", "thesis-iterative, thesis-ssbo, thesis-ssbo-multiple"}},
      {thesisScene("terrainSize = 1"), {"thesis.terrainSize", "world.cell_m"}},
      {thesisScene("heightmapSize = 20"), {"thesis.heightmapSize", "world.cell"}},
      {std::string(kGround) + "[thesis]\nterrainSize = 1\n", {"thesis.heightmapSize", "missing", "go together"}},
      {std::string(kGround) + "[thesis]\nheightmapSize = 1\n", {"thesis.terrainSize", "missing", "go together"}},
      {std::string(kGround) + "[world]\nsize_m = [1, 1]\n[thesis]\nterrainSize = 1\nheightmapSize = 9\n",
       {"thesis.terrainSize", "world.size_m"}},
      {std::string(kGround) + "[thesis]\nterrainSize = 1\nheightmapSize = 90000\n",
       {"thesis.heightmapSize", "not within 0.0001 .. 100 m"}},
      {std::string(kGround) + "[thesis]\nterrainSize = 200000\nheightmapSize = 1999\n",
       {"thesis.heightmapSize", "not within 0.0001 .. 100 m"}},
      {std::string(kGround) + "[thesis]\nterrainSize = 20000\nheightmapSize = 20000\nactiveAreas = false\n",
       {"active_areas is 0 in a world of 20000 x 20000 cells"}},
      {thesisScene("slopeThreshold = 3", "[soil]\nrepose_deg = 35\n"), {"thesis.slopeThreshold", "soil.repose_deg"}},
      {thesisScene("obstacleThreshold = 3", "[soil]\nobstacle_threshold_m = 1\n"),
       {"thesis.obstacleThreshold", "soil.obstacle_threshold_m"}},
      {thesisScene("numIterationsEvenOutSlopes = 3", "[soil]\nsweeps_per_tick = 3\n"),
       {"thesis.numIterationsEvenOutSlopes", "soil.sweeps_per_tick"}},
      {thesisScene("angleOfRepose = 3", "[soil]\nrepose_deg = 35\n"), {"thesis.angleOfRepose", "soil.repose_deg"}},
      {thesisScene("angleOfRepose = 3\nslopeThreshold = 1"), {":9: ", "thesis.angleOfRepose", "says the same"}},
      {thesisScene("angleOfRepose = 89.5"), {"thesis.angleOfRepose", "0 .. 89 degrees"}},
      {thesisScene("driftWeights = \"force\""), {"thesis.driftWeights", "none of: none, displacement, slope"}},
      {thesisScene("driftStep = 0"), {"thesis.driftStep", "0.0001 .. 16 units of time"}},
      {thesisScene("diffusion = 4.1"), {"thesis.diffusion", "0 .. 4 cells^2 per unit of time"}},
      {thesisScene("frictionInverse = 0.5"), {"thesis.frictionInverse", "0 .. 0.4999 cells"}},
      {thesisScene("slopes = \"drift\"\ndriftStep = 16\ndiffusion = 4"),
       {":10: ", "thesis.driftStep", "10 sweeps a tick of 512 steps each", "are 5120; the limit is 1000"}},
      {thesisScene("", "[soil]\nsweeps_per_tick = 1001\n"), {"soil.sweeps_per_tick", "0 .. 1000"}},
  };
  for (const auto& wrong : cases) {
    const Result<ImportedScene> result = importScene(write("scene.toml", wrong.scene));
    ASSERT_FALSE(result) << wrong.scene;
    EXPECT_EQ(std::count(result.error().begin(), result.error().end(), '\n'), 0) << result.error();
    for (const std::string& part : wrong.parts)
      EXPECT_TRUE(contains(result.error(), part)) << "'" << result.error() << "' lacks '" << part << "'";
  }
}

TEST_F(Thesis, AThresholdThatNoSlopeExceedsIsNoted) {
  const auto withSlope = [&](const std::string& value) {
    return importScene(write("scene.toml", thesisScene("slopeThreshold = " + value)));
  };
  const auto steep = withSlope("31.4");  // times 0.05 m: 1.5700, a right angle is 1.5708
  ASSERT_TRUE(steep) << steep.error();
  EXPECT_EQ(steep->pack.parameters.materials[0].slope_threshold_q, 12557655);  // 10^4 tan(1.57) = 12557655.9
  EXPECT_TRUE(steep->notes.empty());
  const auto never = withSlope("31.5");
  ASSERT_TRUE(never) << never.error();
  EXPECT_EQ(never->pack.parameters.materials[0].slope_threshold_q, kNeverSteep);
  EXPECT_EQ(never->pack.parameters.materials[0].diagonal_threshold_q, kNeverSteep);
  ASSERT_EQ(never->notes.size(), 1u);
  EXPECT_TRUE(contains(never->notes[0], "thesis.slopeThreshold: 31.5 per metre over cells of 0.05 m"))
      << never->notes[0];
}

TEST_F(Thesis, ThresholdsAreExactAtEveryBoundary) {
  for (const std::int32_t cell_q : {1, 100, 488, 500, 3906, 1000000}) {
    const double cell_m = cell_q / 1e4;
    for (std::int32_t rise_q = 1; rise_q < 400000; rise_q += 1 + rise_q / 7) {
      const double boundary = std::atan(rise_q / 1e4) / cell_m;
      EXPECT_EQ(slopeThreshold(boundary, cell_q), rise_q) << cell_q;
      EXPECT_EQ(slopeThreshold(boundary * (1 + 1e-13), cell_q), rise_q) << cell_q;
      EXPECT_EQ(slopeThreshold(boundary * (1 - 1e-13), cell_q), rise_q - 1) << cell_q;
    }
    EXPECT_EQ(slopeThreshold(0, cell_q), 0);
    EXPECT_EQ(slopeThreshold(std::numbers::pi / 2 / cell_m * (1 + 1e-12), cell_q), kNeverSteep);
    EXPECT_EQ(slopeThreshold(std::numbers::pi / 2 / cell_m * (1 - 1e-12), cell_q), kNeverSteep) << "beyond 53 km";
    EXPECT_LT(slopeThreshold(std::numbers::pi / 2 / cell_m * (1 - 1e-4), cell_q), kNeverSteep);
  }
}

TEST_F(Thesis, ThresholdsAreTheRuleItself) {
  std::mt19937 random(5);
  for (int i = 0; i < 20000; ++i) {
    const auto cell_q = std::int32_t(1 + random() % 5000);
    const long double cell_m = cell_q / 1e4L;
    const double per_metre = double(random()) / double(random.max()) * 1.5707 / double(cell_m);
    const std::int32_t threshold = slopeThreshold(per_metre, cell_q);
    ASSERT_LT(threshold, kNeverSteep);
    EXPECT_LE(std::atan(threshold / 1e4L) / cell_m, per_metre * (1 + 1e-15L)) << per_metre << ' ' << cell_q;
    EXPECT_GT(std::atan((threshold + 1) / 1e4L) / cell_m, per_metre) << per_metre << ' ' << cell_q;
  }
}

TEST_F(Thesis, DiagonalThresholdsAreSqrt2Larger) {
  EXPECT_EQ(diagonalThreshold(0), 0);
  EXPECT_EQ(diagonalThreshold(1), 1);
  EXPECT_EQ(diagonalThreshold(5), 7);
  EXPECT_EQ(diagonalThreshold(100000000), 141421356);
  EXPECT_EQ(diagonalThreshold(379625062), 536870911);  // the last below 2^29
  EXPECT_EQ(diagonalThreshold(1 << 29), kNeverSteep);
  EXPECT_EQ(diagonalThreshold(kNeverSteep), kNeverSteep);
}

TEST_F(Thesis, AssignmentsAreReadLikeTheTable) {
  EXPECT_EQ(compiled("roughness=0.6"), compiled(" roughness = 0.6 "));
  EXPECT_EQ(compiled("nearest=jump_flooding").nearest, NearestSearch::jump_flooding);
  EXPECT_EQ(compiled("preset=\"thesis-ssbo\"").capacity_rounds, 1);
  EXPECT_EQ(compiled("activeAreas=false").active_areas, 0);
  EXPECT_EQ(compiled("slopeThreshold=1.9").materials[0].slope_threshold_q, 952);
  EXPECT_EQ(compiled("slopeThreshold=1.9", 1000).materials[0].slope_threshold_q, 1923);
  const struct {
    const char *text, *part;
  } wrong[] = {
      {"", "is not NAME=VALUE"},
      {"roughness", "'roughness' is not NAME=VALUE"},
      {"=1", "'' is no parameter"},
      {"Roughness=1", "'Roughness' is no parameter"},
      {"rough\x1bness=1", "'rough?ness' is no parameter"},
      {"roughness=", "'' is not a number within 0 .. 1"},
      {"roughness=1.1", "'1.1' is not a number within 0 .. 1"},
      {"roughness=-1", "'-1' is not"},
      {"roughness=nan", "'nan' is not"},
      {"roughness=inf", "'inf' is not"},
      {"roughness=0.5x", "'0.5x' is not"},
      {"roughness=0,5", "'0,5' is not"},
      {"spreadCells=1.0", "'1.0' is not a whole number within 1 .. 64 cells"},
      {"spreadCells=99999999999999999999", "is not a whole number"},
      {"activeAreas=yes", "one of true, false"},
      {"metric=Euclidean", "one of euclidean, manhattan, chebyshev"},
  };
  for (const auto& [text, part] : wrong) {
    const auto value = parseNamed(text);
    ASSERT_FALSE(value) << text;
    EXPECT_TRUE(contains(value.error(), part)) << value.error();
  }
  const auto long_name = parseNamed(std::string(100000, 'x') + "=1");
  ASSERT_FALSE(long_name);
  EXPECT_LT(long_name.error().size(), 200u);
}

TEST_F(Thesis, ARunningSessionKeepsItsWorld) {
  ScenePack pack;
  pack.width_cells = pack.height_cells = 20000;
  pack.cell_q = 500;
  const auto change = [&](std::initializer_list<const char*> assignments) {
    std::vector<NamedValue> values;
    for (const char* text : assignments) values.push_back(*parseNamed(text));
    std::vector<std::string> notes;
    const auto changed = changeParameters(pack, defaults(), values, notes);
    return changed ? describeChange(pack, defaults(), *changed) : changed.error();
  };
  for (const char* text : {"terrainSize=5", "heightmapSize=64", "numVerticesPerRow=3", "numIterationsBlurNormals=1"}) {
    const std::string name(text, std::string(text).find('='));
    EXPECT_TRUE(contains(change({text}), name + ": cannot change in a session: it ")) << change({text});
  }
  EXPECT_EQ(change({"roughness=0.25", "compression=0.9"}), "compression 0 -> 0.9, roughness 1 -> 0.25");
  EXPECT_EQ(change({"slopeThreshold=1.9"}),
            "slopeThreshold 0.7 (0.035 m rest, 35 degrees, diagonally 0.0495 m) -> 1.9 (0.0952 m rest, 62.3 degrees)");
  EXPECT_EQ(change({"obstacleThreshold=10"}), "");
  EXPECT_EQ(change({"roughness=0.25", "roughness=0.25"}), "roughness: given twice");
  EXPECT_TRUE(contains(change({"activeAreas=false"}), "active_areas is 0 in a world of 20000 x 20000 cells"));
}

TEST_F(Thesis, ANewSearchKeepsItsVariant) {
  ScenePack pack;
  pack.width_cells = pack.height_cells = 100;
  pack.cell_q = 500;
  std::vector<std::string> notes;
  const std::vector<NamedValue> flooding = {*parseNamed("nearest=jump_flooding")};
  const auto kept =
      changeParameters(pack, compiled("nearest=jump_flooding,jumpFloodingVariant=JFA^2"), flooding, notes);
  ASSERT_TRUE(kept);
  EXPECT_EQ(kept->nearest, NearestSearch::jump_flooding_squared);
}

TEST_F(Thesis, DescriptionsGiveTheSameParametersAgain) {
  std::mt19937 random(9);
  for (int i = 0; i < 300; ++i) {
    const auto cell_q = std::int32_t(1 + random() % 20000);
    ScenePack pack;
    pack.cell_q = cell_q;
    Parameters parameters;
    parameters.displacement = Displacement(random() % 4);
    parameters.nearest = NearestSearch(random() % 6);
    parameters.metric = Metric(random() % 3);
    parameters.slopes = SlopeRule(random() % 5);
    parameters.drift_weights = DriftWeights(random() % 3);
    parameters.drift_step_q16 = std::int32_t(7 + random() % (kDriftStepLimit - 6));
    parameters.active_areas = std::uint8_t(random() % 2);
    parameters.displace_iterations = std::int32_t(random() % 1001);
    parameters.sweeps_per_tick = std::int32_t(random() % 1001);
    parameters.materials[0].compression_q16 = std::int32_t(random() % 65537);
    parameters.materials[0].compaction_limit_q16 = std::int32_t(random() % 65537);
    parameters.materials[0].roughness_q16 = std::int32_t(random() % 65537);
    parameters.materials[0].slope_threshold_q = std::int32_t(random() % (1u << (random() % 24)));
    parameters.materials[0].diagonal_threshold_q = diagonalThreshold(parameters.materials[0].slope_threshold_q);
    const double repose = std::atan2(parameters.materials[0].slope_threshold_q, cell_q);
    parameters.materials[0].repose_q16 =
        std::min(std::int32_t(std::lround(repose * 2 / std::numbers::pi * kOneQ16)), kReposeLimit);
    parameters.materials[0].diffusion_q16 = std::int32_t(random() % (kDiffusionLimit + 1));
    parameters.materials[0].friction_inverse_q32 = std::int32_t(random() % 2147000000);
    parameters.obstacle_threshold_q = std::int32_t(random() % 100000);
    parameters.penetration_divider_q = std::int32_t(1 + random() % 100000);
    parameters.spread_cells = std::int32_t(1 + random() % 64);
    parameters.capacity_rounds = std::int32_t(1 + random() % 16);
    parameters.active_margin_cells = std::int32_t(random() % 4097);
    parameters.frustum_height_q = std::int32_t(random() % 530000000);
    std::string assignments;
    for (const std::string& line : describeParameters(pack, parameters)) {
      std::istringstream words(line);
      std::string name, value;
      words >> name >> value;
      if (value != "-") assignments += (assignments.empty() ? "" : ",") + name + "=" + value;
    }
    EXPECT_EQ(compiled(assignments, cell_q), parameters) << assignments << " over " << cell_q;
  }
}

TEST_F(Thesis, TheReadmeListsEveryNameWithItsRangeAndDefault) {
  std::ifstream file(std::string(SPOOR_SCENES_DIR) + "/README.md");
  std::map<std::string, std::vector<std::string>> rows;  // by name: range, default
  std::vector<std::string> names;
  bool in_thesis = false;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("## ")) in_thesis = line == "## [thesis]";
    if (!in_thesis || !line.starts_with("| ") || line.starts_with("| key")) continue;
    std::istringstream cells(line.substr(2));
    std::string name, range, otherwise;
    std::getline(cells, name, '|'), std::getline(cells, range, '|'), std::getline(cells, otherwise, '|');
    const auto trim = [](const std::string& text) { return text.substr(1, text.find_last_not_of(' ')); };
    rows[name.substr(0, name.find(' '))] = {trim(range), trim(otherwise)};
    names.push_back(name.substr(0, name.find(' ')));
  }
  ScenePack pack;
  pack.cell_q = 500;
  std::map<std::string, std::string> defaults_by_name;
  for (const std::string& line : describeParameters(pack, NamedSettings().parameters))
    defaults_by_name[line.substr(0, line.find(' '))] = line.substr(line.find(' ') + 1);
  EXPECT_EQ(names.size(), namedParameters().size());
  for (const NamedParameter& parameter : namedParameters()) {
    const std::string name(parameter.name);
    ASSERT_TRUE(rows.contains(name)) << name;
    EXPECT_EQ(rows[name][0], rangeText(parameter)) << name;
    std::string expected = "none";
    if (defaults_by_name.contains(name)) expected = defaults_by_name[name];
    if (name.starts_with("num") && !parameter.fixed_because.empty()) expected = "0";
    if (name == "slopeThreshold" || name == "angleOfRepose") expected = "[soil]'s repose_deg";
    if (name == "jumpFloodingVariant") expected = "JFA";
    EXPECT_EQ(rows[name][1], expected) << name;
  }
}

TEST_F(Thesis, TheEvaluationsHaveTheirTables) {
  const auto load = [](const std::string& name) {
    return importScene(std::string(SPOOR_SCENES_DIR) + "/" + name + ".toml");
  };
  const auto one = load("thesis_5_3");
  ASSERT_TRUE(one) << one.error();
  EXPECT_EQ(one->pack.width_cells, 4096);
  EXPECT_EQ(one->pack.patches_per_row, 64);
  EXPECT_EQ(one->pack.normal_blur_passes, 1);
  EXPECT_EQ(one->pack.parameters.sweeps_per_tick, 10);
  EXPECT_EQ(one->pack.parameters.displace_iterations, 10);
  EXPECT_EQ(one->pack.bodies.size(), 5u);
  const auto eight = load("thesis_5_8");
  ASSERT_TRUE(eight) << eight.error();
  EXPECT_EQ(eight->pack.width_cells, 2048);
  EXPECT_EQ(eight->pack.parameters.sweeps_per_tick, 1);
  EXPECT_EQ(eight->pack.parameters.displace_iterations, 10);
  EXPECT_EQ(eight->pack.bodies.size(), 40u);
  for (const auto* scene : {&*one, &*eight})
    EXPECT_EQ(scene->pack.parameters.displacement, Displacement::direct) << "SSBO of Table 5.1";
}

TEST_F(Thesis, TheLooksHaveTheirCaptions) {
  const struct {
    const char* name;
    std::int32_t cell_q;
    double compression, roughness, slope;
  } looks[] = {
      {"5_11_left", 3906, 0, 0.6, 3.1},   {"5_11_right", 488, 0, 0.6, 3.1}, {"5_12_left", 488, 0, 0.5, 1.9},
      {"5_12_right", 488, 0.9, 0.5, 1.9}, {"5_13_left", 488, 0, 0.1, 1.9},  {"5_13_right", 488, 0, 0.8, 3.9},
      {"5_14_left", 488, 0, 0.3, 0.1},    {"5_14_right", 488, 0, 0.3, 4.9}, {"5_15_left", 100, 0.95, 0.1, 8},
      {"5_15_middle", 100, 0.95, 0.1, 8}, {"5_15_right", 100, 0, 0.1, 1.1},
  };
  for (const auto& look : looks) {
    const std::string name = std::string("thesis_") + look.name;
    const auto scene = importScene(std::string(SPOOR_SCENES_DIR) + "/" + name + ".toml");
    ASSERT_TRUE(scene) << scene.error();
    EXPECT_EQ(scene->pack.name, name);
    EXPECT_EQ(scene->pack.cell_q, look.cell_q) << name;
    const Parameters& p = scene->pack.parameters;
    EXPECT_EQ(p.displacement, Displacement::spread) << name;
    EXPECT_EQ(p.slopes, SlopeRule::scatter) << name;
    EXPECT_EQ(p.materials[0].compression_q16, std::lround(look.compression * 65536)) << name;
    EXPECT_EQ(p.materials[0].roughness_q16, std::lround(look.roughness * 65536)) << name;
    EXPECT_EQ(p.materials[0].slope_threshold_q, std::int32_t(1e4 * std::tan(look.slope * look.cell_q / 1e4))) << name;
  }
}

}  // namespace
}  // namespace spoor
