// Scene files and bare terrains become packs, and whatever is wrong with them is said in one line.
#include <fstream>
#include <iterator>

#include "server/import/importer.h"
#include "server/import/mesh_file.h"
#include "server/import/path_maker.h"
#include "shared/world/base_terrain.h"
#include "tests/import_fixture.h"

#ifndef SPOOR_SCENES_DIR
#define SPOOR_SCENES_DIR "scenes"
#endif

namespace spoor {
namespace {

const char* const kScenes[] = {"convoy", "walker", "dozer", "box", "wide", "wide_small", "craters", "materials"};

std::string scenePath(const std::string& name) { return std::string(SPOOR_SCENES_DIR) + "/" + name + ".toml"; }

/// The error of a scene; the empty text where there is none.
std::string errorOf(const std::string& scene_file) {
  const Result<ImportedScene> result = importScene(scene_file);
  return result ? "" : result.error();
}

const std::string kWedge =
    "v -1 -0.5 0\nv 1 -0.5 0\nv 0 -0.5 0.25\nv -1 0.5 0\nv 1 0.5 0\nv 0 0.5 0.25\n"
    "f 1 2 3\nf 4 6 5\nf 1 4 5 2\nf 2 5 6 3\nf 3 6 4 1\n";

/// A scene in which every value is known by hand; `more` is added at its end.
std::string handScene(const std::string& more = "") {
  return R"(name = "hand"
seed = 9
ticks = 77
ticks_per_second = 60

[world]
size_m = [10, 5]
cell_m = 0.05

[base]
kind = "noise"
frequency_per_m = 0.1
octaves = 2
lowest_m = -0.5
highest_m = 1.25
soil_depth_m = 0.6

[soil]
repose_deg = 45
obstacle_threshold_m = 0.002
sweeps_per_tick = 4

[[mesh]]
name = "wedge"
file = "wedge.obj"
scale = 2

[[path]]
name = "line"
origin = "centre"
points_m = [[-4, -0.5], [4.00004, 0.5]]
speed_m_s = 6
start_s = 0.5
smooth = false

[[body]]
mesh = "wedge"
path = "line"
offset_m = [1, -0.25, 0.1]
sinkage_m = 0.12
wheel_radius_m = 0.4
stride_m = 1.4
lift_m = 0.2
phase_m = 0.7
follows_slope = true
)" + more;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

TEST_F(Import, HandComputedSceneHasItsIntegers) {
  write("wedge.obj", kWedge);
  const Result<ImportedScene> scene = importScene(write("scene.toml", handScene()));
  ASSERT_TRUE(scene) << scene.error();
  const ScenePack& pack = scene->pack;
  EXPECT_EQ(pack.name, "hand");
  EXPECT_EQ(pack.seed, 9u);
  EXPECT_EQ(pack.default_ticks, 77);
  EXPECT_EQ(pack.width_cells, 200);
  EXPECT_EQ(pack.height_cells, 100);
  EXPECT_EQ(pack.cell_q, 500);
  EXPECT_EQ(pack.soil_depth_q, 6000);
  EXPECT_EQ(pack.parameters.obstacle_threshold_q, 20);
  EXPECT_EQ(pack.parameters.materials[0].slope_threshold_q, 500);     // tan 45 * 500
  EXPECT_EQ(pack.parameters.materials[0].diagonal_threshold_q, 707);  // floor(500 * sqrt 2)
  EXPECT_EQ(pack.parameters.sweeps_per_tick, 4);
  EXPECT_EQ(pack.noise.lattice_step_q32, 21474836);  // 0.1 * 0.05 * 2^32
  EXPECT_EQ(pack.noise.seed, 9u);
  EXPECT_EQ(pack.noise.lowest_q, -5000);
  EXPECT_EQ(pack.noise.highest_q, 12500);
  ASSERT_EQ(pack.paths.size(), 1u);
  const Path& path = pack.paths[0];
  EXPECT_EQ(path.speed_q_per_tick, 1000);
  EXPECT_EQ(path.first_tick, 30);
  ASSERT_EQ(path.waypoints.size(), 2u);
  EXPECT_EQ(path.waypoints[0].x_q, 10000);
  EXPECT_EQ(path.waypoints[0].y_q, 20000);
  EXPECT_EQ(path.waypoints[1].x_q, 90000);
  ASSERT_EQ(pack.bodies.size(), 1u);
  const Body& body = pack.bodies[0];
  EXPECT_EQ(body.name, "wedge");
  EXPECT_EQ(body.offset_q, (std::array<std::int32_t, 3>{10000, -2500, 1000}));
  EXPECT_EQ(body.sinkage_q, 1200);
  EXPECT_EQ(body.roll_radius_q, 4000);
  EXPECT_EQ(body.stride_q, 14000);
  EXPECT_EQ(body.lift_q, 2000);
  EXPECT_EQ(body.phase_q, 7000);
  EXPECT_EQ(body.follows_slope, 1);
  EXPECT_EQ(boxOf(pack.meshes[0]).high, (std::array<std::int32_t, 3>{20000, 10000, 5000}));
  EXPECT_EQ(pack.meshes[0].vertices.size(), 6u);
  EXPECT_EQ(pack.meshes[0].triangles.size(), 8u);
  EXPECT_EQ(pack.meshes[0].edges.size(), 12u);
}

TEST_F(Import, ExampleScenesImportAndTwiceTheSame) {
  for (const char* name : kScenes) {
    const Result<ImportedScene> first = importScene(scenePath(name));
    ASSERT_TRUE(first) << first.error();
    const Result<ImportedScene> second = importScene(scenePath(name));
    ASSERT_TRUE(second) << second.error();
    EXPECT_EQ(packId(encodePack(first->pack)), packId(encodePack(second->pack))) << name;
    EXPECT_TRUE(first->notes.empty()) << name << ": " << first->notes.front();
  }
}

TEST_F(Import, WideSceneDiffersFromItsSmallTwinInNameAndCellsOnly) {
  Result<ImportedScene> wide = importScene(scenePath("wide"));
  Result<ImportedScene> small = importScene(scenePath("wide_small"));
  ASSERT_TRUE(wide && small);
  EXPECT_EQ(wide->pack.width_cells, 65536);
  const std::int32_t shift_q = (wide->pack.width_cells - small->pack.width_cells) / 2 * wide->pack.cell_q;
  for (Waypoint& waypoint : wide->pack.paths[0].waypoints) {
    waypoint.x_q -= shift_q;
    waypoint.y_q -= shift_q;
  }
  wide->pack.name = small->pack.name;
  wide->pack.width_cells = small->pack.width_cells;
  wide->pack.height_cells = small->pack.height_cells;
  EXPECT_EQ(encodePack(wide->pack), encodePack(small->pack));
}

TEST_F(Import, VehicleBecomesChassisAndFourWheels) {
  const Result<ImportedScene> scene = importScene(scenePath("convoy"));
  ASSERT_TRUE(scene) << scene.error();
  ASSERT_EQ(scene->pack.bodies.size(), 10u);
  const Body& chassis = scene->pack.bodies[0];
  const Body& wheel = scene->pack.bodies[4];
  EXPECT_EQ(chassis.name, "fast.chassis");
  EXPECT_EQ(chassis.offset_q, (std::array<std::int32_t, 3>{0, 0, 2000}));
  EXPECT_EQ(chassis.follows_slope, 1);
  EXPECT_EQ(wheel.name, "fast.rear_right");
  EXPECT_EQ(wheel.offset_q, (std::array<std::int32_t, 3>{-7800, -5000, 0}));
  EXPECT_EQ(wheel.sinkage_q, 1200);
  EXPECT_EQ(wheel.roll_radius_q, 4000);
}

TEST_F(Import, ConvoyIsGentlerThanItsAngleOfReposeAndPassesItsMiddle) {
  const Result<ImportedScene> scene = importScene(scenePath("convoy"));
  ASSERT_TRUE(scene) << scene.error();
  const BaseTerrain base(scene->pack);
  constexpr std::int32_t kColumns = 2048, kRows = 64;
  std::vector<std::int32_t> height(kColumns * kRows);
  std::int32_t steepest = 0;
  for (std::int32_t y = 0; y < 2048; y += kRows) {
    base.fillArea(0, y, 1, kColumns, kRows, height);
    for (std::size_t i = 1; i < height.size(); ++i) {
      if (i % kColumns != 0) steepest = std::max(steepest, std::abs(height[i] - height[i - 1]));
    }
  }
  EXPECT_GT(steepest, 0);
  EXPECT_LT(steepest * 2, scene->pack.parameters.materials[0].slope_threshold_q);
  for (const Path& path : scene->pack.paths) {
    EXPECT_TRUE(std::any_of(path.waypoints.begin(), path.waypoints.end(), [](const Waypoint& waypoint) {
      return std::abs(waypoint.x_q - 510000) < 5000 && std::abs(waypoint.y_q - 510000) < 5000;
    }));
  }
}

TEST_F(Import, ErrorsNameFileLineKeyAndReason) {
  write("wedge.obj", kWedge);
  struct Case {
    std::string scene;
    std::vector<std::string> parts;
  };
  const Case cases[] = {
      {handScene("colour = 1\n"), {"scene.toml:46: ", "body[0].colour", "unknown key"}},
      {replaced(handScene(), "cell_m = 0.05", "cell = 0.05"), {"scene.toml:8: ", "world.cell", "unknown key"}},
      {replaced(handScene(), "cell_m = 0.05", "cell_m = 0"),
       {":8: ", "world.cell_m", "0 is not within 0.0001 .. 100 m"}},
      {replaced(handScene(), "cell_m = 0.05", "cell_m = \"a\""),
       {":8: ", "world.cell_m", "must be a number", "not a text"}},
      {replaced(handScene(), "cell_m = 0.05", "cell_m = nan"), {":8: ", "world.cell_m", "nan"}},
      {replaced(handScene(), "[10, 5]", "[10]"), {":7: ", "world.size_m", "array of 2"}},
      {replaced(handScene(), "[10, 5]", "[209000, 5]"), {":7: ", "world.size_m", "cells"}},
      {replaced(handScene(), "size_m = [10, 5]", "cells = [10.5, 5]"), {":7: ", "world.cells", "whole"}},
      {replaced(handScene(), "size_m = [10, 5]\n", ""), {"world.size_m", "missing"}},
      {replaced(handScene(), "seed = 9", "seed = -9"), {":2: ", "seed", "-9"}},
      {replaced(handScene(), "ticks = 77", "ticks = 7.5"), {":3: ", "ticks", "integer"}},
      {replaced(handScene(), "kind = \"noise\"\n", ""), {"base.kind", "missing"}},
      {replaced(handScene(), "\"noise\"", "\"sand\""), {":11: ", "base.kind", "'sand' is none of: noise, dem"}},
      {replaced(handScene(), "highest_m = 1.25", "highest_m = -1"), {":15: ", "base.highest_m", "below"}},
      {replaced(handScene(), "repose_deg = 45", "repose_deg = 90"), {":19: ", "soil.repose_deg", "90"}},
      {replaced(handScene(), "wedge.obj", "none.obj"), {":25: ", "mesh[0].file", "none.obj", "no such file"}},
      {replaced(handScene(), "scale = 2", "up = \"x\""), {":26: ", "mesh[0].up", "none of: y, z"}},
      {replaced(handScene(), "scale = 2", "scale = 100"), {":25: ", "mesh[0].file", "origin"}},
      {replaced(handScene(), "[-4, -0.5]", "[-4]"), {":31: ", "path[0].points_m", "point 1"}},
      {replaced(handScene(), "[-4, -0.5]", "[4.00004, 0.5]"), {":31: ", "path[0].points_m", "the same"}},
      {replaced(handScene(), "[-4, -0.5]", "[-4000, 0]"), {":31: ", "path[0].points_m", "outside the world"}},
      {replaced(handScene(), "speed_m_s = 6", "speed_m_s = 1e-9"), {":32: ", "path[0].speed_m_s", "per tick"}},
      {replaced(handScene(), "mesh = \"wedge\"", "mesh = \"wheel\""), {":37: ", "body[0].mesh", "'wheel'"}},
      {replaced(handScene(), "path = \"line\"", "path = \"road\""), {":38: ", "body[0].path", "'road'"}},
      {handScene("[[mesh]]\nname = \"wedge\"\nfile = \"wedge.obj\"\n"), {":47: ", "mesh[1].name", "there already"}},
      {handScene("[[vehicle]]\nname = \"car\"\n"), {"vehicle[0].path", "missing"}},
      {handScene("x = \n"), {"scene.toml:46: "}},
      {replaced(handScene(), "[soil]", "[[soil]]"), {"soil", "must be a table"}},
  };
  for (const Case& wrong : cases) {
    const std::string error = errorOf(write("scene.toml", wrong.scene));
    EXPECT_TRUE(contains(error, "scene.toml")) << error;
    EXPECT_EQ(std::count(error.begin(), error.end(), '\n'), 0) << error;
    for (const std::string& part : wrong.parts)
      EXPECT_TRUE(contains(error, part)) << "'" << error << "' lacks '" << part << "'";
  }
}

TEST_F(Import, MissingSceneIsAnError) {
  const Result<ImportedScene> result = importScene((directory_ / "none.toml").string());
  ASSERT_FALSE(result);
  EXPECT_TRUE(contains(result.error(), "none.toml: no such file"));
}

TEST_F(Import, TinySlopeThresholdIsRoundedUpToOneWithANote) {
  write("wedge.obj", kWedge);
  const Result<ImportedScene> scene =
      importScene(write("scene.toml", replaced(handScene(), "repose_deg = 45", "repose_deg = 0")));
  ASSERT_TRUE(scene) << scene.error();
  EXPECT_EQ(scene->pack.parameters.materials[0].slope_threshold_q, 1);
  EXPECT_EQ(scene->pack.parameters.materials[0].diagonal_threshold_q, 1);
  EXPECT_TRUE(anyContains(scene->notes, "rounded up"));
}

TEST_F(Import, SceneWithDemHasItsSampleStep) {
  write("wedge.obj", kWedge);
  write("hill.asc", "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 10\n1 2 3\n4 5 6\n");
  const Result<ImportedScene> scene = importScene(write("scene.toml", R"(
[world]
cell_m = 0.5
[base]
kind = "dem"
file = "hill.asc"
)"));
  ASSERT_TRUE(scene) << scene.error();
  EXPECT_EQ(scene->pack.width_cells, 60);
  EXPECT_EQ(scene->pack.height_cells, 40);
  EXPECT_EQ(scene->pack.samples.step_x_q32, 214748365);  // 0.5 / 10 * 2^32
  EXPECT_EQ(scene->pack.samples.height_q.front(), 40000);
}

TEST_F(Import, WorldBeyondItsDemIsNoted) {
  write("hill.asc", "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 10\n1 2 3\n4 5 6\n");
  const Result<ImportedScene> scene =
      importScene(write("scene.toml", "[world]\nsize_m = [50, 20]\n[base]\nkind = \"dem\"\nfile = \"hill.asc\"\n"));
  ASSERT_TRUE(scene) << scene.error();
  EXPECT_TRUE(anyContains(scene->notes, "20 m east"));
}

TEST_F(Import, UnfinishedDemIsAClearError) {
  SPOOR_NEEDS_DATA(path, "dem/gz_dem_unfinished.tif");
  const Result<ImportedScene> scene = importTerrain({path, 0.05, {}, "", 600});
  ASSERT_FALSE(scene);
  EXPECT_TRUE(contains(scene.error(), "gz_dem_unfinished.tif: value -32768")) << scene.error();
}

TEST_F(Import, TerrainOfDegreesBecomesAWorldOfMetres) {
  SPOOR_NEEDS_DATA(dem, "dem/srtm_colorado_240x144.asc");
  SPOOR_NEEDS_DATA(tyre, "meshes/hmmwv_tire_coarse_closed.obj");
  const Result<ImportedScene> scene = importTerrain({dem, 0.05, {tyre, tyre}, "", 300});
  ASSERT_TRUE(scene) << scene.error();
  const ScenePack& pack = scene->pack;
  EXPECT_TRUE(anyContains(scene->notes, "latitude 40.15"));
  EXPECT_NEAR(pack.width_cells, 340825, 5);  // 0.2 degrees of 85 206 m
  EXPECT_NEAR(pack.height_cells, 266490, 5);
  EXPECT_EQ(pack.samples.height_q.size(), 240u * 144u);
  ASSERT_EQ(pack.bodies.size(), 2u);
  EXPECT_LT(pack.bodies[0].offset_q[1], pack.bodies[1].offset_q[1]);
  EXPECT_EQ(pack.paths[0].speed_q_per_tick, 833);
  EXPECT_LT(encodePack(pack).size(), 1u << 20);
}

TEST_F(Import, ImageAndMoonAndSquaredDemImport) {
  for (const char* name : {"dem/gz_grayscale_16bit.png", "dem/gz_dem_moon.tif", "dem/gz_dem_squared.tif"}) {
    SPOOR_NEEDS_DATA(path, name);
    const Result<ImportedScene> scene = importTerrain({path, 0.05, {}, "", 600});
    EXPECT_TRUE(scene) << scene.error();
  }
}

TEST_F(Import, SmoothPathKeepsItsPointsAndItsLimit) {
  const std::vector<PointM> corners{{0, 0}, {3, 4}, {9, 4}};
  const std::vector<PointM> path = smoothPath(corners, false);
  EXPECT_EQ(path.front(), corners.front());
  EXPECT_EQ(path.back(), corners.back());
  EXPECT_NE(std::find(path.begin(), path.end(), corners[1]), path.end());
  for (std::size_t i = 1; i < path.size(); ++i) EXPECT_LT(pathLength({path[i - 1], path[i]}, false), 0.4);
  EXPECT_LE(smoothPath({{0, 0}, {1e5, 0}, {1e5, 1e5}}, true).size(), kSmoothPointLimit);
  EXPECT_GT(smoothPath({{0, 0}, {1e5, 0}, {1e5, 1e5}}, true).size(), kSmoothPointLimit / 2);
}

TEST_F(Import, ExampleScenesMakeTheCommittedPacks) {
  for (const char* name : kScenes) {
    const Result<ImportedScene> scene = importScene(scenePath(name));
    ASSERT_TRUE(scene) << scene.error();
    std::ifstream file(std::string(SPOOR_GOLDEN_DIR) + "/" + name + ".pack", std::ios::binary);
    const std::vector<std::uint8_t> committed{std::istreambuf_iterator<char>(file), {}};
    EXPECT_EQ(toText(packId(encodePack(scene->pack))), toText(packId(committed)))
        << name << ": import it to tests/golden/" << name << ".pack if the scene was meant to change";
  }
}

}  // namespace
}  // namespace spoor
