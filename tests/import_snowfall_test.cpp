// Snowfalls, forces and sizes of scene files.
#include <algorithm>
#include <cmath>

#include "server/import/importer.h"
#include "tests/import_fixture.h"

#ifndef SPOOR_SCENES_DIR
#define SPOOR_SCENES_DIR "scenes"
#endif

namespace spoor {
namespace {

std::string scene(const std::string& more) {
  return R"(name = "snow"
seed = 5
ticks = 600
ticks_per_second = 60
[world]
size_m = [40, 20]
cell_m = 0.1
[base]
kind = "noise"
frequency_per_m = 0.1
highest_m = 0
[[mesh]]
name = "box"
file = "box.obj"
[[path]]
name = "line"
speed_m_s = 3
points_m = [[5, 5], [9, 5]]
)" + more;
}

class ImportSnowfall : public Import {
 protected:
  void SetUp() override {
    Import::SetUp();
    std::filesystem::copy_file(std::string(SPOOR_SCENES_DIR) + "/meshes/box.obj", directory_ / "box.obj",
                               std::filesystem::copy_options::overwrite_existing);
  }
  Result<ImportedScene> import(const std::string& more) { return importScene(write("snow.toml", scene(more))); }
  ScenePack packOf(const std::string& more) {
    const auto imported = import(more);
    EXPECT_TRUE(imported) << imported.error();
    return imported ? imported->pack : ScenePack{};
  }
  void expectWrong(const std::string& more, const std::vector<std::string>& parts) {
    const auto imported = import(more);
    ASSERT_FALSE(imported) << more;
    EXPECT_EQ(std::count(imported.error().begin(), imported.error().end(), '\n'), 0) << imported.error();
    for (const std::string& part : parts)
      EXPECT_TRUE(contains(imported.error(), part)) << "'" << imported.error() << "' lacks '" << part << "'";
  }
};

TEST_F(ImportSnowfall, KeysHaveTheirIntegers) {
  const ScenePack pack = packOf(R"([[snowfall]]
area_m = [1, 2, 11.5, 4]
rate_mm_per_hour = 36000
start_s = 1
end_s = 2.5
seed = 4294967295
[[snowfall]]
rate_mm_per_hour = 21600
)");
  ASSERT_EQ(pack.snowfalls.size(), 2u);
  // 36 m an hour: 100 units a second, 5 / 3 a tick; 7158278826.7 of 2^-32.
  EXPECT_EQ(pack.snowfalls[0], (Snowfall{{10, 20, 115, 40}, 7158278827, 61, 150, 4294967295u}));
  EXPECT_EQ(pack.snowfalls[1].area, (CellBox{0, 0, 400, 200})) << "the world";
  EXPECT_EQ(pack.snowfalls[1].rate_q32, std::int64_t(1) << 32);
  EXPECT_EQ(pack.snowfalls[1].first_tick, 1);
  EXPECT_EQ(pack.snowfalls[1].last_tick, 600) << "the scene's end";
  const auto again = decodePack(encodePack(pack));
  ASSERT_TRUE(again) << again.error();
  EXPECT_EQ(again->snowfalls, pack.snowfalls);
}

TEST_F(ImportSnowfall, SeedsFollowFromTheScenesAndDiffer) {
  const std::string two = "[[snowfall]]\nrate_mm_per_hour = 1\n[[snowfall]]\nrate_mm_per_hour = 1\n";
  const ScenePack pack = packOf(two);
  EXPECT_NE(pack.snowfalls[0].seed, pack.snowfalls[1].seed);
  EXPECT_EQ(pack.snowfalls, packOf(two).snowfalls);
}

TEST_F(ImportSnowfall, WhatIsRoundedOrCutOffIsNoted) {
  const auto imported = import(R"([[snowfall]]
area_m = [-25, -5, 3.04, 5]
origin = "centre"
rate_mm_per_hour = 36000
start_s = 0.505
end_s = 2
)");
  ASSERT_TRUE(imported) << imported.error();
  EXPECT_EQ(imported->pack.snowfalls[0].area, (CellBox{0, 50, 230, 150}));
  EXPECT_EQ(imported->pack.snowfalls[0].first_tick, 31);
  EXPECT_EQ(imported->pack.snowfalls[0].last_tick, 120);
  EXPECT_TRUE(
      anyContains(imported->notes, "snowfall[0].area_m: taken as the cells of the world from (0, 5) to (23, 15) m"));
  EXPECT_TRUE(anyContains(imported->notes, "snowfall[0].start_s: 0.505 s rounded to 30 ticks, 0.5 s"));
}

TEST_F(ImportSnowfall, WrongKeysNameLineKeyAndReason) {
  const auto snow = [](const std::string& lines) { return "[[snowfall]]\n" + lines; };
  const std::string rate = "rate_mm_per_hour = 1\n";
  expectWrong(snow(""), {"snow.toml:19: ", "snowfall[0].rate_mm_per_hour", "missing"});
  expectWrong(snow("rate_mm_per_hour = 0"), {":20: ", "snowfall[0].rate_mm_per_hour", "0 is not within"});
  expectWrong(snow("rate_mm_per_hour = 1e9"), {"snowfall[0].rate_mm_per_hour", "at most 88473600"});
  expectWrong(snow("rate_mm_per_hour = 88473600\nend_s = 10000"), {"snowfall[0].rate_mm_per_hour", "too much in all"});
  expectWrong(snow(rate + "area_m = [1, 2, 3]"), {"snowfall[0].area_m", "an array of 4 numbers"});
  expectWrong(snow(rate + "area_m = [40, 0, 50, 5]"), {"snowfall[0].area_m", "holds no cell of the world"});
  expectWrong(snow(rate + "area_m = [5, 0, 4, 5]"), {"snowfall[0].area_m", "holds no cell of the world"});
  expectWrong(snow(rate + "area_m = [0, 0, 1e6, 5]"), {"snowfall[0].area_m", "-200000 .. 200000 m"});
  expectWrong(snow(rate + "origin = \"north\""), {"snowfall[0].origin", "corner, centre"});
  expectWrong(snow(rate + "start_s = -1"), {"snowfall[0].start_s", "0 .. 1000000 s"});
  expectWrong(snow(rate + "start_s = 2\nend_s = 2"), {"snowfall[0].end_s", "is not after start_s"});
  expectWrong(snow(rate + "start_s = 10"), {"snowfall[0].end_s", "missing; the scene ends before start_s"});
  expectWrong(snow(rate + "seed = 4294967296"), {"snowfall[0].seed", "0 .. 4294967295"});
  expectWrong(snow(rate + "depth = 1"), {"snowfall[0].depth", "unknown key"});
  std::string many;
  for (int i = 0; i < 65; ++i) many += snow(rate);
  expectWrong(many, {"snowfall", "65 tables, the limit is 64"});
}

TEST_F(ImportSnowfall, BodiesHaveForcesAndSizes) {
  const std::string body = "[[body]]\nmesh = \"box\"\npath = \"line\"\n";
  const ScenePack pack = packOf(body + body + "name = \"b\"\nforce_n = 1250.4\nsize = 0.5\n" + body +
                                "name = \"c\"\nsize = [0.3, 1.0]\nsize_s = [2, 8]\n");
  EXPECT_EQ(pack.bodies[0].force_n, 0);
  EXPECT_EQ(pack.bodies[0].first_scale_q16, kFullScale);
  EXPECT_EQ(pack.bodies[0].last_scale_q16, kFullScale);
  EXPECT_EQ(pack.bodies[1].force_n, 1250);
  EXPECT_EQ(pack.bodies[1].first_scale_q16, 32768);
  EXPECT_EQ(pack.bodies[1].last_scale_q16, 32768);
  EXPECT_EQ(pack.bodies[2].first_scale_q16, 19661);  // 19660.8
  EXPECT_EQ(pack.bodies[2].last_scale_q16, kFullScale);
  EXPECT_EQ(pack.bodies[2].first_scale_tick, 120);
  EXPECT_EQ(pack.bodies[2].last_scale_tick, 480);
  const ScenePack vehicle = packOf(R"([[vehicle]]
name = "v"
path = "line"
chassis = "box"
wheel = "box"
track_m = 1
wheelbase_m = 1
wheel_radius_m = 0.4
force_n = 500
)");
  EXPECT_EQ(vehicle.bodies[0].force_n, 0);
  for (int i = 1; i < 5; ++i) EXPECT_EQ(vehicle.bodies[std::size_t(i)].force_n, 500);
  expectWrong(body + "force_n = -1", {"body[0].force_n", "0 .. 67108864 N"});
  expectWrong(body + "size = 0", {"body[0].size", "0.0001 .. 1"});
  expectWrong(body + "size = [1, 2]", {"body[0].size", "2 is not within"});
  expectWrong(body + "size = [1]", {"body[0].size", "a number or [first, last]"});
  expectWrong(body + "size = [1, 0.5]", {"body[0].size_s", "missing"});
  expectWrong(body + "size_s = [1, 2]", {"body[0].size_s", "goes with size"});
  expectWrong(body + "size = [1, 0.5]\nsize_s = [3, 2]", {"body[0].size_s", "3 is more than 2"});
  const auto noted = import(body + "size = [1, 0.5]\nsize_s = [0.51, 2]\n");
  ASSERT_TRUE(noted) << noted.error();
  EXPECT_TRUE(anyContains(noted->notes, "body[0].size_s: 0.51 s rounded to tick 31"));
}

TEST(MaterialScenes, AreWhatTheySay) {
  const auto load = [](const std::string& name) {
    auto imported = importScene(std::string(SPOOR_SCENES_DIR) + "/" + name + ".toml");
    EXPECT_TRUE(imported) << imported.error();
    EXPECT_EQ(imported->pack.name, name);
    return imported ? std::move(imported->pack) : ScenePack{};
  };
  // Gilardi et al., figure 4: 1/zeta, angle of repose and D; all else is the same.
  const struct {
    const char* name;
    double friction_inverse, repose, diffusion;
  } papers[] = {{"mud", 6e-4, 0.4, 0.25}, {"pebbles", 3e-4, 1 / 3.0, 0.9}, {"sand", 4e-4, 0.25, 1}};
  const ScenePack first = load("drift_mud");
  for (const auto& paper : papers) {
    ScenePack pack = load("drift_" + std::string(paper.name));
    EXPECT_EQ(pack.width_cells, 512);
    EXPECT_EQ(pack.height_cells, 512);
    EXPECT_EQ(pack.parameters.slopes, SlopeRule::drift);
    EXPECT_LT(pack.parameters.drift_step_q16, 0.3 * kOneQ16);
    const MaterialRules& rules = pack.parameters.materials[0];
    EXPECT_EQ(pack.materials[0].name, paper.name);
    EXPECT_EQ(rules.friction_inverse_q32, std::llround(paper.friction_inverse * 4294967296.0));
    EXPECT_EQ(rules.repose_q16, std::lround(paper.repose * 2 * kOneQ16));
    EXPECT_EQ(rules.diffusion_q16, std::lround(paper.diffusion * kOneQ16));
    EXPECT_GT(pack.bodies[0].force_n, 0);
    pack.name = first.name;
    pack.materials = first.materials;
    pack.parameters.materials = first.parameters.materials;
    EXPECT_EQ(encodePack(pack), encodePack(first)) << paper.name << " differs in more than its material";
  }
  const ScenePack materials = load("materials");
  EXPECT_EQ(materials.materials.size(), 3u);
  EXPECT_EQ(materials.material_map.image.material.size(), 64u * 64u);
  EXPECT_EQ(load("snowfall").snowfalls.size(), 2u);
  const ScenePack growing = load("growing");
  EXPECT_LT(growing.bodies[0].first_scale_q16, growing.bodies[0].last_scale_q16);
  EXPECT_GT(growing.bodies[1].first_scale_q16, growing.bodies[1].last_scale_q16);
}

}  // namespace
}  // namespace spoor
