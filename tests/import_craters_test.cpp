// Craters of scene files: every key, what they become, and what is wrong with them.
#include <algorithm>
#include <cstdlib>

#include "server/import/importer.h"
#include "tests/import_fixture.h"

#ifndef SPOOR_SCENES_DIR
#define SPOOR_SCENES_DIR "scenes"
#endif

namespace spoor {
namespace {

/// Flat ground of 40 x 20 m, 60 ticks a second; `more` is added at its end.
std::string flatScene(const std::string& more) {
  return R"(name = "flat"
seed = 9
ticks = 600
ticks_per_second = 60
[world]
size_m = [40, 20]
cell_m = 0.1
[base]
kind = "noise"
frequency_per_m = 0.1
highest_m = 0
)" + more;
}

const std::string kShape = "r1_m = 0.5\nr2_m = 1\ndepth_m = 0.25\nrim_m = 0.1\n";

class ImportCraters : public Import {
 protected:
  Result<ImportedScene> import(const std::string& more) { return importScene(write("flat.toml", flatScene(more))); }
  ScenePack packOf(const std::string& more) {
    const auto scene = import(more);
    EXPECT_TRUE(scene) << scene.error();
    return scene ? scene->pack : ScenePack{};
  }
  std::vector<std::string> notesOf(const std::string& more) {
    const auto scene = import(more);
    EXPECT_TRUE(scene) << scene.error();
    return scene ? scene->notes : std::vector<std::string>{};
  }
};

TEST_F(ImportCraters, ASceneWithoutAdmitsNone) {
  const ScenePack pack = packOf("");
  EXPECT_EQ(pack.crater_limits, CraterLimits{});
  EXPECT_TRUE(pack.craters.empty());
}

TEST_F(ImportCraters, LimitsHaveTheirIntegers) {
  const ScenePack pack = packOf(R"([craters]
max_radius_m = 12.5
hash_cell_m = 30
request_max_radius_m = 4
request_max_height_m = 1.5
request_distance_m = 60
requests_per_minute = 12
)");
  EXPECT_EQ(pack.crater_limits, (CraterLimits{125000, 300000, 40000, 15000, 600000, 12}));
}

TEST_F(ImportCraters, DefaultsAreTheLargestTimedAndNoRequests) {
  const ScenePack pack = packOf("[[crater]]\ntick = 4\nat_m = [5, 6]\n" + kShape +
                                "[[crater]]\ntick = 2\nat_m = [9, 6]\nr1_m = 1\nr2_m = 3\ndepth_m = 1\nrim_m = 0\n");
  EXPECT_EQ(pack.crater_limits, (CraterLimits{50000, 750000, 0, 0, 0, 30}));
}

TEST_F(ImportCraters, OneHasItsIntegersAndTheyAreSortedByTick) {
  const ScenePack pack = packOf(R"([[crater]]
at_s = 1.5
origin = "centre"
at_m = [-3, 2.00004]
r1_m = 0.5
r2_m = 1.25
depth_m = 0.4
rim_m = 0.2
noise = 0.25
noise_seed = 513
[[crater]]
kind = "single"
tick = 7
at_m = [5, 6]
r1_m = 0
r2_m = 1
depth_m = 0.5
balanced = true
noise = 1
[[crater]]
at_s = 0
at_m = [5, 6]
)" + kShape);
  ASSERT_EQ(pack.craters.size(), 3u);
  const Crater& first = pack.craters[0];
  EXPECT_EQ(first.tick, 1);
  EXPECT_EQ(first.noise_q16, 0);
  const Crater& second = pack.craters[1];
  EXPECT_EQ(second.tick, 7);
  EXPECT_EQ(second.rim_height_q, balancedRimHeight(0, 10000, 5000));
  EXPECT_EQ(second.noise_q16, 65535);
  const Crater& third = pack.craters[2];
  EXPECT_EQ(third, (Crater{170000, 120000, 5000, 12500, 2000, 4000, 513, 16384, 90, 2}));
}

TEST_F(ImportCraters, NoiseSeedsAreDrawnFromTheScenesSeedAndTheTable) {
  const std::string two =
      "[[crater]]\ntick = 1\nat_m = [5, 6]\n" + kShape + "[[crater]]\ntick = 1\nat_m = [5, 6]\n" + kShape;
  const ScenePack pack = packOf(two);
  EXPECT_NE(pack.craters[0].noise_seed, pack.craters[1].noise_seed);
  std::string other = flatScene(two);
  other.replace(other.find("seed = 9"), 8, "seed = 8");
  const auto reseeded = importScene(write("other.toml", other));
  ASSERT_TRUE(reseeded) << reseeded.error();
  EXPECT_NE(reseeded->pack.craters[0].noise_seed, pack.craters[0].noise_seed);
}

TEST_F(ImportCraters, ASalvoStepsThroughPlaceAndTime) {
  const ScenePack pack = packOf(R"([[crater]]
kind = "salvo"
at_s = 1
at_m = [5, 6]
count = 4
every_s = 0.0167
step_m = [2, -0.5]
)" + kShape);
  ASSERT_EQ(pack.craters.size(), 4u);
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(pack.craters[std::size_t(i)].x_q, 50000 + 20000 * i);
    EXPECT_EQ(pack.craters[std::size_t(i)].y_q, 60000 - 5000 * i);
    EXPECT_EQ(pack.craters[std::size_t(i)].tick, 60 + i) << "rounded to the nearest tick";
    EXPECT_EQ(pack.craters[std::size_t(i)].id, std::uint32_t(i));
  }
  EXPECT_NE(pack.craters[0].noise_seed, pack.craters[1].noise_seed);
}

TEST_F(ImportCraters, ASalvosSpreadStaysInItsDisc) {
  const ScenePack pack = packOf(R"([[crater]]
kind = "salvo"
tick = 1
at_m = [20, 10]
count = 500
every_s = 0
spread_m = 3
)" + kShape);
  ASSERT_EQ(pack.craters.size(), 500u);
  std::int64_t farthest = 0;
  for (const Crater& crater : pack.craters) {
    const std::int64_t dx = crater.x_q - 200000, dy = crater.y_q - 100000;
    farthest = std::max(farthest, dx * dx + dy * dy);
    EXPECT_EQ(crater.tick, 1);
  }
  EXPECT_LE(farthest, std::int64_t(30000) * 30000);
  EXPECT_GT(farthest, std::int64_t(29000) * 29000);
}

const std::string kCarpet = R"([[crater]]
kind = "carpet"
at_s = 1
origin = "centre"
at_m = [0, 0]
count = 1000
over_s = 2
size_m = [30, 10]
r1_m = [0, 0.8]
r2_m = [0.4, 1.5]
depth_m = [0.1, 0.6]
balanced = true
noise = [0, 0.5]
)";

TEST_F(ImportCraters, ACarpetIsDrawnFromItsRanges) {
  const ScenePack pack = packOf(kCarpet);
  ASSERT_EQ(pack.craters.size(), 1000u);
  Crater least = pack.craters[0], most = least;
  for (const Crater& crater : pack.craters) {
    for (const auto field : {&Crater::x_q, &Crater::y_q, &Crater::inner_radius_q, &Crater::crest_radius_q,
                             &Crater::depth_q, &Crater::tick}) {
      least.*field = std::min(least.*field, crater.*field);
      most.*field = std::max(most.*field, crater.*field);
    }
    most.noise_q16 = std::max(most.noise_q16, crater.noise_q16);
    EXPECT_LE(crater.inner_radius_q, crater.crest_radius_q);
    EXPECT_EQ(crater.rim_height_q, balancedRimHeight(crater.inner_radius_q, crater.crest_radius_q, crater.depth_q));
  }
  const auto spans = [&](std::int32_t Crater::*field, std::int32_t low, std::int32_t high, std::int32_t slack) {
    EXPECT_GE(least.*field, low);
    EXPECT_LE(least.*field, low + slack);
    EXPECT_LE(most.*field, high);
    EXPECT_GE(most.*field, high - slack);
  };
  spans(&Crater::x_q, 50000, 350000, 3000);
  spans(&Crater::y_q, 50000, 150000, 1000);
  spans(&Crater::inner_radius_q, 0, 8000, 100);
  spans(&Crater::crest_radius_q, 4000, 15000, 100);
  spans(&Crater::depth_q, 1000, 6000, 50);
  spans(&Crater::tick, 60, 179, 0);
  EXPECT_LE(most.noise_q16, 32768);
  EXPECT_GT(most.noise_q16, 32000);
  EXPECT_TRUE(std::ranges::is_sorted(pack.craters, {}, &Crater::tick));
}

TEST_F(ImportCraters, ACarpetInADiscAndAllAtOnce) {
  const ScenePack pack = packOf(R"([[crater]]
kind = "carpet"
tick = 3
at_m = [20, 10]
count = 300
radius_m = 8
)" + kShape);
  ASSERT_EQ(pack.craters.size(), 300u);
  for (const Crater& crater : pack.craters) {
    const std::int64_t dx = crater.x_q - 200000, dy = crater.y_q - 100000;
    EXPECT_LE(dx * dx + dy * dy, std::int64_t(80000) * 80000);
    EXPECT_EQ(crater.tick, 3);
  }
}

TEST_F(ImportCraters, TheSameFileGivesTheSamePackAndAnotherSeedAnother) {
  const PackId id = packId(encodePack(packOf(kCarpet)));
  EXPECT_EQ(packId(encodePack(packOf(kCarpet))), id);
  EXPECT_NE(packId(encodePack(packOf(kCarpet + "seed = 5\n"))), id);
}

/// What follows from a seed must never change: scenes would be others than they were.
TEST_F(ImportCraters, WhatIsDrawnIsForGood) {
  const ScenePack pack = packOf(kCarpet);
  EXPECT_EQ(pack.craters[7], (Crater{192414, 59968, 4098, 4514, 1484, 4241, 61183, 5673, 60, 7}));
}

TEST_F(ImportCraters, WhatIsRoundedOrLeftOutIsNoted) {
  EXPECT_TRUE(anyContains(notesOf("[[crater]]\nat_s = 0.33\nat_m = [5, 6]\n" + kShape),
                          "crater[0].at_s: 0.33 s rounded to tick 20, 0.3333333 s"));
  EXPECT_TRUE(notesOf("[[crater]]\nat_s = 0.5\nat_m = [5, 6]\n" + kShape).empty());
  EXPECT_TRUE(anyContains(notesOf("[[crater]]\nat_s = 20\nat_m = [5, 6]\n" + kShape),
                          "crater[0]: 1 of 1 craters come after the scene's 600 ticks"));
  const std::string walk =
      "[[crater]]\nkind = \"salvo\"\ntick = 1\nat_m = [35, 6]\ncount = 5\nevery_s = 0.1\nstep_m = [3, 0]\n";
  EXPECT_TRUE(anyContains(notesOf(walk + kShape), "crater[0]: 2 of 5 craters lie off the map and are left out"));
}

TEST_F(ImportCraters, ErrorsNameFileLineKeyAndReason) {
  const std::string one = "[[crater]]\ntick = 1\nat_m = [5, 6]\n";
  const std::string salvo = "[[crater]]\nkind = \"salvo\"\ntick = 1\nat_m = [5, 6]\n" + kShape;
  const std::string carpet = "[[crater]]\nkind = \"carpet\"\ntick = 1\nat_m = [5, 6]\n" + kShape;
  const struct {
    std::string more, part;
  } wrong[] = {
      {"[craters]\nmax_radius_m = 900\n", ":13: craters.max_radius_m: 900 is not within 0 .. 838.8607 m"},
      {"[craters]\nmax_radius_m = 800\nhash_cell_m = 49\n", "craters.hash_cell_m: 49 is not within 50 .. 100000 m"},
      {"[craters]\nhash_cell_m = 0.1\n" + one + kShape.substr(0, 11) + "r2_m = 9\ndepth_m = 1\nrim_m = 0\n",
       "craters.hash_cell_m: 0.1 m is less than a sixteenth of max_radius_m, 17.5 m"},
      {"[craters]\nmax_radius_m = 5\nrequest_max_radius_m = 6\nrequest_max_height_m = 1\n",
       "craters.request_max_radius_m: 6 m is more than max_radius_m, 5 m"},
      {"[craters]\nrequest_max_radius_m = 6\nrequest_max_height_m = 1\n", "max_radius_m, 0 m (as large as the largest"},
      {"[craters]\nmax_radius_m = 5\nrequest_max_radius_m = 4\n", "craters.request_max_height_m: missing"},
      {"[craters]\nmax_radius_m = 5\nrequest_distance_m = 4\n", "request_distance_m: goes with request_max_radius_m"},
      {"[craters]\nmax_radius_m = 5\nrequest_max_radius_m = 4\nrequest_max_height_m = 105\n", "0 .. 104.8576 m"},
      {"[craters]\nmax_radius_m = 5\nrequest_max_radius_m = 4\nrequest_max_height_m = 1\nrequests_per_minute = -1\n",
       "requests_per_minute: -1 is not within 0 .. 60000 a minute"},
      {"[craters]\nradius_m = 5\n", "craters.radius_m: unknown key"},
      {"[[crater]]\nat_m = [5, 6]\n" + kShape, "crater[0].at_s: give either at_s or tick"},
      {one + kShape + "at_s = 1\n", "crater[0].tick: give either at_s or tick"},
      {"[[crater]]\ntick = 0\nat_m = [5, 6]\n" + kShape, "crater[0].tick: 0 is not within 1 .."},
      {"[[crater]]\nat_s = -1\nat_m = [5, 6]\n" + kShape, "crater[0].at_s: -1 is not within 0 .."},
      {"[[crater]]\ntick = 1\n" + kShape, "crater[0].at_m: missing"},
      {"[[crater]]\ntick = 1\nat_m = [500, 6]\n" + kShape, "crater[0].at_m: nothing of it lies on the map"},
      {one + kShape + "origin = \"north\"\n", "crater[0].origin: 'north' is none of: corner, centre"},
      {one + kShape + "kind = \"swarm\"\n", "crater[0].kind: 'swarm' is none of: single, salvo, carpet"},
      {one + kShape + "balanced = true\n", "crater[0].rim_m: give either rim_m or balanced = true"},
      {one + "r1_m = 1\nr2_m = 2\ndepth_m = 1\n", "crater[0].rim_m: missing; rim_m or balanced = true"},
      {one + "r1_m = 1\nr2_m = 2\ndepth_m = 1\nbalanced = false\n", "crater[0].rim_m: missing"},
      {one + "r1_m = 3\nr2_m = 2\ndepth_m = 1\nrim_m = 0\n", "crater[0].r1_m: 3 m is more than r2_m, 2 m"},
      {one + "r1_m = 0\nr2_m = 0\ndepth_m = 1\nrim_m = 0\n", "crater[0].r2_m: 0 is not within 0.0001 .."},
      {one + "r1_m = 0\nr2_m = 500\ndepth_m = 1\nrim_m = 0\n",
       "crater[0].r2_m: R3 = 2 r2_m - r1_m is 1000 m, at most 838.8607"},
      {"[craters]\nmax_radius_m = 1\n" + one + kShape,
       "crater[0].r2_m: R3 = 2 r2_m - r1_m is 1.5 m, craters.max_radius_m is 1 m"},
      {one + "r1_m = 1\nr2_m = 2\ndepth_m = -1\nrim_m = 0\n", "crater[0].depth_m: -1 is not within"},
      {one + "r1_m = [1, 2]\nr2_m = 2\ndepth_m = 1\nrim_m = 0\n", "crater[0].r1_m: must be a number within"},
      {one + kShape + "noise = 1.5\n", "crater[0].noise: 1.5 is not within 0 .. 1"},
      {one + kShape + "noise_seed = 65536\n", "crater[0].noise_seed: 65536 is not within 0 .. 65535"},
      {one + kShape + "count = 4\n", "crater[0].count: unknown key"},
      {salvo + "every_s = 1\n", "crater[0].count: missing"},
      {salvo + "count = 4\n", "crater[0].every_s: missing"},
      {salvo + "count = 0\nevery_s = 1\n", "crater[0].count: 0 is not within 1 .. 65536 craters"},
      {salvo + "count = 4\nevery_s = 1\nnoise_seed = 4\n", "crater[0].noise_seed: unknown key"},
      {salvo + "count = 4\nevery_s = 1\nstep_m = [1]\n", "crater[0].step_m: must be an array of 2 numbers"},
      {carpet + "count = 4\n", "crater[0].radius_m: give either radius_m or size_m"},
      {carpet + "count = 4\nradius_m = 1\nsize_m = [1, 1]\n", "crater[0].size_m: give either radius_m or size_m"},
      {carpet + "count = 3000000\nradius_m = 1\n", "crater[0].count: 3000000 is not within 1 .. 2097152 craters"},
      {carpet + "count = 70000\nradius_m = 1\n", "more than 65536 in one tick"},
      {carpet + "count = 4\nradius_m = 1\nseed = -1\n", "crater[0].seed: -1 is not within"},
      {carpet + "count = 4\nradius_m = 1\nnoise = [0.5, 0.2]\n", "crater[0].noise: 0.5 is more than 0.2"},
      {carpet + "count = 4\nradius_m = 1\nnoise = [0.5]\n", "crater[0].noise: must be a number or [least, most]"},
      {carpet + "count = 4\nradius_m = 1\nevery_s = 2\n", "crater[0].every_s: unknown key"},
  };
  for (const auto& [more, part] : wrong) {
    const auto scene = import(more);
    ASSERT_FALSE(scene) << more;
    EXPECT_TRUE(contains(scene.error(), "flat.toml")) << scene.error();
    EXPECT_TRUE(contains(scene.error(), part)) << scene.error() << "\nwanted " << part;
  }
}

TEST_F(ImportCraters, ExampleScenesHaveThem) {
  const struct {
    const char* name;
    std::size_t count;
  } scenes[] = {{"craters", 132}, {"crater_looks", 5}, {"crater_field", 10000}};
  for (const auto& [name, count] : scenes) {
    const auto scene = importScene(std::string(SPOOR_SCENES_DIR) + "/" + name + ".toml");
    ASSERT_TRUE(scene) << scene.error();
    EXPECT_TRUE(scene->notes.empty()) << scene->notes[0];
    EXPECT_EQ(scene->pack.craters.size(), count) << name;
  }
}

}  // namespace
}  // namespace spoor
