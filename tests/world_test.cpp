// The ground, the tile store, scripts and packs.
#include <gtest/gtest.h>

#include <cmath>

#include "shared/base/fixed.h"
#include "shared/world/noise.h"
#include "shared/world/script.h"
#include "tests/scenes.h"

namespace spoor::test {
namespace {

TEST(Noise, StaysBetweenItsHeightsAndUsesMostOfThem) {
  for (const std::uint64_t seed : {1u, 99u, 123456789u}) {
    const NoiseBase noise{seed, std::int64_t(1) << 27, 4, -12345, 67890};
    std::int32_t lowest = INT32_MAX, highest = INT32_MIN;
    for (int y = 0; y < 500; y += 3)
      for (int x = 0; x < 500; x += 3) {
        const std::int32_t height = noiseHeight(noise, x, y);
        lowest = std::min(lowest, height);
        highest = std::max(highest, height);
      }
    EXPECT_GE(lowest, -12345);
    EXPECT_LE(highest, 67890);
    EXPECT_GT(highest - lowest, (67890 + 12345) / 3);
  }
}

TEST(Noise, NeighboursAreCloseTo64thOfALatticeStep) {
  const NoiseBase noise{7, std::int64_t(1) << 26, 1, 0, 1000000};  // 64 cells a lattice step
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 200; ++x) {
      const std::int32_t here = noiseHeight(noise, x, y);
      // Gradients of 1, scaled by sqrt 2 and half the range, with the fade's steepest slope: under 3 ranges a step.
      ASSERT_LE(std::abs(here - noiseHeight(noise, x + 1, y)), 1000000 * 3 / 64) << x << ", " << y;
      ASSERT_LE(std::abs(here - noiseHeight(noise, x, y + 1)), 1000000 * 3 / 64) << x << ", " << y;
    }
}

TEST(Noise, SeedsDiffer) {
  NoiseBase noise{1, std::int64_t(1) << 28, 2, 0, 100000};
  const std::int32_t first = noiseHeight(noise, 37, 11);
  noise.seed = 2;
  EXPECT_NE(noiseHeight(noise, 37, 11), first);
}

TEST(BaseTerrain, SamplesUnderCellCentresAreHit) {
  const World world(groundPack(7, 5, {3,  -5, 8,   13, 100000,  //
                                      0,  0,  0,   0,  0,       //
                                      -9, 7,  500, 1,  2,       //
                                      40, 41, 42,  43, 44,      //
                                      11, 12, 13,  14, 15,      //
                                      21, 22, 23,  24, 25,      //
                                      31, 32, 33,  34, 35},
                               0));
  for (int i = 0; i < 35; ++i)
    EXPECT_EQ(world.base.height(i % 7, i / 7), world.pack.samples.height_q[std::size_t(i)]) << i;
}

/// 12 x 10 samples, 8.25 cells apart: sample (i, j) lies under no cell's centre in general.
ScenePack coarsePack(std::vector<std::int32_t> samples) {
  ScenePack pack = flatPack(99, 82);
  pack.soil_depth_q = 0;
  pack.base_kind = BaseKind::samples;
  pack.noise = {};
  pack.samples = {12, 10, std::int64_t(double(1ll << 32) / 8.25), std::int64_t(double(1ll << 32) / 8.25),
                  std::move(samples)};
  return pack;
}

TEST(BaseTerrain, EqualSamplesGiveLevelGround) {
  for (const int height : {0, 1, -1, 12345678, 88480000, -4000000}) {
    const World world(coarsePack(std::vector<std::int32_t>(120, height)));
    for (int y = 0; y < 82; ++y)
      for (int x = 0; x < 99; ++x) ASSERT_EQ(world.base.height(x, y), height) << x << ", " << y;
  }
}

TEST(BaseTerrain, AnEvenSlopeOfSamplesStaysEven) {
  std::vector<std::int32_t> samples;
  for (int i = 0; i < 120; ++i) samples.push_back(30000000 + 82500 * (i % 12) - 33000 * (i / 12));
  const World world(coarsePack(samples));
  for (int y = 13; y < 69; ++y)  // clear of the border, where samples repeat
    for (int x = 13; x < 85; ++x) {
      const double expected = 30000000 + 82500 * ((x + 0.5) / 8.25 - 0.5) - 33000 * ((y + 0.5) / 8.25 - 0.5);
      ASSERT_NEAR(world.base.height(x, y), expected, 1.0) << x << ", " << y;
    }
}

TEST(BaseTerrain, TilesAgreeWithCellsAndHoldNothingOutside) {
  const World world(noisePack(130, 67, 3, -20000, 20000, 700));
  for (const TileCoordinate tile : {TileCoordinate{0, 0}, {1, 0}, {2, 1}}) {
    PlaneCells cells;
    world.base.fillHeights(tile, cells);
    for (int i = 0; i < rules::kTileCells; ++i) {
      const int x = tile.x * 64 + i % 64, y = tile.y * 64 + i / 64;
      ASSERT_EQ(cells[std::size_t(i)], x < 130 && y < 67 ? world.base.height(x, y) : 0) << x << ", " << y;
    }
  }
  std::vector<std::int32_t> area(20);
  world.base.fillArea(62, 3, 7, 5, 4, area);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(area[std::size_t(i)], world.base.height(62 + i % 5 * 7, 3 + i / 5 * 7)) << i;
}

TEST(BaseTerrain, HeightBetweenCentresIsBilinearAndFlatBeyondTheBorder) {
  const World world(groundPack(2, 2, {0, 1000, 2000, 5000}, 0));
  EXPECT_EQ(world.base.heightAt(500, 500), 0);
  EXPECT_EQ(world.base.heightAt(1000, 500), 500);
  EXPECT_EQ(world.base.heightAt(1000, 1000), 2000);
  EXPECT_EQ(world.base.heightAt(1500, 1500), 5000);
  EXPECT_EQ(world.base.heightAt(-90000, -90000), 0);
  EXPECT_EQ(world.base.heightAt(90000, 90000), 5000);
}

TEST(BaseTerrain, AWorldOfOneCell) {
  const World world(groundPack(1, 1, {4711}, 100));
  EXPECT_EQ(world.base.height(0, 0), 4711);
  EXPECT_EQ(world.base.heightAt(-5, 99999), 4711);
  EXPECT_EQ(tileExtent(world.pack), (TileCoordinate{1, 1}));
}

TEST(TileStore, ATileBecomesLiveAsTheBaseIs) {
  const World world(noisePack(100, 70, 5, -3000, 3000, 250));
  TileStore store;
  EXPECT_EQ(store.find({1, 1}), nullptr);
  Tile& tile = store.insert(makeTile({1, 1}, {&world.base}, 9));
  EXPECT_EQ(store.find({1, 1}), &tile);
  EXPECT_EQ(tile.version_tick, 9);
  EXPECT_EQ(tile.ground, tile.initial);
  EXPECT_EQ(tile.hash, tileHash(tile));
  for (int y = 64; y < 128; ++y)
    for (int x = 64; x < 128; ++x) {
      const auto i = std::size_t((y - 64) * 64 + x - 64);
      const bool inside = x < 100 && y < 70;
      ASSERT_EQ(tile.height()[i], inside ? world.base.height(x, y) : 0);
      ASSERT_EQ(tile.height()[i] - (*tile.bedrock)[i], inside ? 250 : 0);
    }
}

TEST(TileStore, ListsLiveTilesByRowThenColumnAndKnowsWhichAreAwake) {
  const World world(flatPack(300, 300));
  TileStore store;
  for (const TileCoordinate at : {TileCoordinate{3, 0}, {0, 2}, {1, 0}, {4, 1}})
    store.insert(makeTile(at, {&world.base}, 1));
  std::vector<TileCoordinate> order;
  for (const Tile* tile : store.sorted()) order.push_back(tile->at);
  EXPECT_EQ(order, (std::vector<TileCoordinate>{{1, 0}, {3, 0}, {4, 1}, {0, 2}}));
  Tile &a = *store.find({1, 0}), &b = *store.find({3, 0}), &c = *store.find({4, 1});
  for (Tile* tile : {&a, &b, &c}) store.setWake(*tile, kWakeSelf);
  store.setWake(a, 0);
  store.setWake(b, kWakeSelf | 1);
  EXPECT_EQ(store.awake().size(), 2u);
  store.setWake(c, 0);
  ASSERT_EQ(store.awake().size(), 1u);
  EXPECT_EQ(store.awake()[0], &b);
  store.setWake(b, 0);
  EXPECT_TRUE(store.awake().empty());
}

/// A body without an offset on a path over level ground at height 0.
ScenePack pathPack(std::vector<Waypoint> waypoints, int speed, bool closed) {
  ScenePack pack = flatPack(200, 200);
  addBody(pack, boxMesh(1000, 1000, 1000), 0, 0, 0);
  pack.paths[0] = {std::move(waypoints), speed, 0, std::uint8_t(closed)};
  return pack;
}

TEST(Script, ABodyKeepsItsSpeedAndRestsAtTheLastWaypoint) {
  ScenePack pack = pathPack({{10000, 10000}, {40000, 50000}}, 130, false);
  pack.paths[0].first_tick = 5;
  const World world(std::move(pack));
  const Script script(world.base);
  EXPECT_EQ(script.poses(5)[0], script.poses(0)[0]);
  for (const int tick : {6, 100, 389}) {
    const Pose pose = script.poses(tick)[0];
    EXPECT_NEAR(pose.x_q, 10000 + 0.6 * 130 * (tick - 5), 1.0);
    EXPECT_NEAR(pose.y_q, 10000 + 0.8 * 130 * (tick - 5), 1.0);
    EXPECT_EQ(pose.yaw, turnOf(3, 4));
    EXPECT_EQ(pose.z_q, 0);
  }
  const Pose last = script.poses(390)[0];
  EXPECT_EQ(std::pair(last.x_q, last.y_q), std::pair(40000, 50000));
  EXPECT_EQ(script.poses(1 << 30)[0], last);
}

TEST(Script, AClosedPathComesRoundForEver) {
  const World world(pathPack({{50000, 50000}, {90000, 50000}, {90000, 80000}, {50000, 80000}}, 100, true));
  const Script script(world.base);
  constexpr int kRound = 1400;  // 140 000 units at 100 a tick
  for (const int tick : {0, 1, 399, 400, 777, 1399})
    for (const int rounds : {1, 7}) EXPECT_EQ(script.poses(tick + rounds * kRound)[0], script.poses(tick)[0]) << tick;
  EXPECT_EQ(script.poses(200)[0].yaw, 0);
  EXPECT_EQ(script.poses(550)[0].yaw, 16384);
  EXPECT_EQ(script.poses(900)[0].yaw, 32768);
  EXPECT_EQ(script.poses(1250)[0].yaw, 49152);
}

TEST(Script, CornersAreTurnedEvenly) {
  const World world(pathPack({{50000, 50000}, {90000, 50000}, {90000, 90000}}, 100, false));
  const Script script(world.base);
  Turn before = script.poses(0)[0].yaw;
  for (int tick = 1; tick < 800; ++tick) {
    const Turn now = script.poses(tick)[0].yaw;
    ASSERT_LE(std::abs(int(std::int16_t(Turn(now - before)))), 16384 / 100 + 1)
        << tick;  // a quarter over 2 * 5000 units
    before = now;
  }
  EXPECT_NEAR(script.poses(400)[0].yaw, 8192, 1);
  EXPECT_EQ(before, 16384);
}

TEST(Script, AFootStandsForHalfOfEveryStrideAndIsLiftedForTheOther) {
  ScenePack pack = pathPack({{10000, 50000}, {150000, 50000}}, 50, false);
  pack.bodies[0].stride_q = 10000;
  pack.bodies[0].lift_q = 1500;
  const World world(std::move(pack));
  const Script script(world.base);
  for (int stride = 0; stride < 5; ++stride) {
    const int tick = stride * 200;
    EXPECT_EQ(script.poses(tick)[0].x_q, 10000 + stride * 10000);
    EXPECT_EQ(script.poses(tick)[0].z_q, 0);
    EXPECT_EQ(script.poses(tick + 50)[0].z_q, 1500) << "highest in the middle of the swing";
    EXPECT_EQ(script.poses(tick + 50)[0].x_q, 10000 + stride * 10000 + 5000);
    for (const int standing : {100, 130, 199}) {
      EXPECT_EQ(script.poses(tick + standing)[0].x_q, 20000 + stride * 10000);
      EXPECT_EQ(script.poses(tick + standing)[0].z_q, 0);
    }
  }
}

TEST(Script, AWheelSpinsByDistanceOverRadius) {
  ScenePack pack = pathPack({{0, 50000}, {190000, 50000}}, 100, false);
  pack.bodies[0].roll_radius_q = 4000;
  const World world(std::move(pack));
  const Script script(world.base);
  for (const int tick : {1, 100, 251, 1900}) {
    const double turns = tick * 100 / (2 * M_PI * 4000) * 65536;
    EXPECT_NEAR(double(script.poses(tick)[0].spin), std::fmod(turns, 65536), 2.0) << tick;
  }
}

TEST(Script, ABodySinksBelowTheBaseAndFollowsItsSlope) {
  std::vector<std::int32_t> slope;
  for (int i = 0; i < 100 * 100; ++i) slope.push_back(i % 100 * 500);
  ScenePack pack = groundPack(100, 100, slope, 100000);
  addBody(pack, boxMesh(6000, 2000, 1000), 50500, 50500, 300);
  pack.bodies[0].follows_slope = 1;
  const World world(std::move(pack));
  const Pose pose = Script(world.base).poses(0)[0];
  EXPECT_EQ(pose.z_q, 25000 - 300);
  EXPECT_EQ(pose.pitch, turnOf(2, 1));
  EXPECT_EQ(pose.roll, 0);
}

}  // namespace
}  // namespace spoor::test
