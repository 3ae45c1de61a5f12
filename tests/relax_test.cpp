// Stage relax: sweeps of edge-coloured pair exchange, against eight plain loops over all pairs.
#include <gtest/gtest.h>

#include <numeric>
#include <random>

#include "shaders/rules/exchange.h"
#include "tests/stage_rig.h"

namespace spoor::test {
namespace {

constexpr int kNone = rules::kNoUnderside;
constexpr int kMuch = rules::kHeightLimit;

TEST(Relax, APairMovesHalfOfItsExcessRoundedUp) {
  EXPECT_EQ(rules::pairFlow(1000, 0, 700, kMuch, kMuch, kMuch, kMuch), 150);
  EXPECT_EQ(rules::pairFlow(1001, 0, 700, kMuch, kMuch, kMuch, kMuch), 151);
  EXPECT_EQ(rules::pairFlow(0, 1001, 700, kMuch, kMuch, kMuch, kMuch), -151);
  EXPECT_EQ(rules::pairFlow(700, 0, 700, kMuch, kMuch, kMuch, kMuch), 0);
  EXPECT_EQ(rules::pairFlow(701, 0, 700, kMuch, kMuch, kMuch, kMuch), 1);
  EXPECT_EQ(rules::pairFlow(1000, 0, 700, 40, kMuch, kMuch, kMuch), 40) << "no more than the giver's soil";
  EXPECT_EQ(rules::pairFlow(1000, 0, 700, kMuch, kMuch, kMuch, 30), 30) << "no more than the taker's room";
  EXPECT_EQ(rules::pairFlow(0, 1000, 700, kMuch, 40, kMuch, kMuch), -40);
  EXPECT_EQ(rules::pairFlow(0, 1000, 700, kMuch, kMuch, 30, kMuch), -30);
  EXPECT_EQ(rules::pairFlow(kMuch, -kMuch, 1, kMuch, 0, 0, kMuch), kMuch) << "the widest difference";
}

TEST(Relax, RoomBeneathABodyIsTheGapIfItIsOverTheThreshold) {
  EXPECT_EQ(rules::roomBeneath(100, 150, 0), 50);
  EXPECT_EQ(rules::roomBeneath(100, 150, 49), 50);
  EXPECT_EQ(rules::roomBeneath(100, 150, 50), 0);
  EXPECT_EQ(rules::roomBeneath(100, 100, 0), 0);
  EXPECT_EQ(rules::roomBeneath(100, -100, 0), 0);
}

/// Sum of the cells.
std::int64_t sumOf(const std::vector<std::int32_t>& cells) {
  return std::accumulate(cells.begin(), cells.end(), std::int64_t(0));
}

TEST(Relax, OneSweepOverAColumnOnFiveByFiveCells) {
  std::vector<std::int32_t> ground(25, 0);
  ground[12] = 1600;
  ScenePack pack = groundPack(5, 5, ground, 100000);
  pack.slope_threshold_q = 100;
  pack.diagonal_threshold_q = 141;
  const World world(std::move(pack));
  StageRig rig(world);
  runRelax(rig.context, 0, 1, true);
  // By hand, matching by matching: the row becomes 0 0 850 750 0, then 0 375 475 425 325; upwards 138 188 163 113 leave
  // it, then downwards 69 94 81 56 and from the row above 19 44 32 7; last, diagonals take 14 and 7 into column 0.
  EXPECT_EQ(rig.cells(rig.area.height), (std::vector<std::int32_t>{0,  0,   0,   0,   0,    //
                                                                   14, 69,  94,  81,  56,   //
                                                                   0,  147, 193, 181, 156,  //
                                                                   7,  119, 144, 131, 106,  //
                                                                   0,  19,  44,  32,  7}));
  EXPECT_EQ(sumOf(rig.cells(rig.area.height)), 1600);
}

/// Random heights, bedrock and undersides over a random set of active tiles.
void checkRandomWorld(int columns, int rows, std::uint32_t seed) {
  std::mt19937 engine(seed);
  const int relief = seed % 2 == 0 ? 4000 : 60000;
  std::vector<std::int32_t> ground;
  for (int i = 0; i < columns * rows; ++i) ground.push_back(int(engine() % std::uint32_t(relief)));
  ScenePack pack = groundPack(columns, rows, ground, seed % 3 == 0 ? 500 : 100000);
  pack.slope_threshold_q = seed % 5 == 0 ? 1 : 350;
  pack.diagonal_threshold_q = seed % 5 == 0 ? 1 : 495;
  pack.obstacle_threshold_q = seed % 4 == 0 ? 0 : 200;
  const World world(std::move(pack));
  const int sweeps = int(seed % 14);
  for (const bool skip_settled : {true, false}) {
    StageRig rig(world, 1 + int(seed % 3));
    std::vector<std::int32_t> underside;
    std::mt19937 again(seed);
    for (int i = 0; i < columns * rows; ++i)
      underside.push_back(i / columns % 64 < 40 && again() % 3 == 0 ? int(again() % std::uint32_t(relief)) : kNone);
    rig.setUnderside(underside);
    DenseWorld dense = denseCopy(rig);
    runRelax(rig.context, 0, sweeps, skip_settled);
    oracleRelax(dense, world.pack, sweeps);
    ASSERT_EQ(rig.cells(rig.area.height), insideCells(dense, dense.height))
        << columns << " x " << rows << ", seed " << seed << ", skip " << skip_settled;
    ASSERT_EQ(sumOf(rig.cells(rig.area.height)), sumOf(ground));
  }
}

TEST(Relax, EqualsTheOracleOnWorldsOfAnySizeAndKeepsTheSum) {
  for (std::uint32_t seed = 0; seed < 14; ++seed)
    for (const auto& [columns, rows] : {std::pair{77, 131}, {1, 200}, {65, 1}, {129, 66}})
      checkRandomWorld(columns, rows, seed);
}

TEST(Relax, SweepsInPartsEqualSweepsAtOnce) {
  const World world(noisePack(150, 140, 5, -9000, 9000, 100000));
  StageRig at_once(world), in_parts(world);
  runRelax(at_once.context, 0, 12, true);
  runRelax(in_parts.context, 0, 1, true);
  runRelax(in_parts.context, 1, 7, true);
  runRelax(in_parts.context, 8, 4, true);
  EXPECT_EQ(at_once.cells(at_once.area.height), in_parts.cells(in_parts.area.height));
}

/// Tiles of a checkerboard with one more: runs that meet at corners only, gaps within a band, bands without a
/// neighbour.
TEST(Relax, FlowCrossesABorderOnlyBetweenActiveTiles) {
  const World world(noisePack(64 * 4 + 9, 64 * 4 + 5, 6, -30000, 30000, 100000));
  for (const std::uint32_t pattern : {0x5a5au, 0xa5a5u, 0x9009u, 0xf00fu, 0x8421u, 0x1248u, 0x6ff6u}) {
    ThreadPool pool(2);
    WorkArea area;
    WorldState state;
    TickPlan plan;
    DenseWorld dense(world.base);
    for (int i = 0; i < 25; ++i)
      if ((pattern >> (i % 16) & 1) != 0) plan.active.push_back({i % 5, i / 5});
    area.gather(plan, world.base, state, pool);
    area.clearUnderside(world.pack, pool);
    for (const TileCoordinate tile : plan.active)
      for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x) dense.active[dense.at(tile.x * 64 + x, tile.y * 64 + y)] = 1;
    const NativeContext context{world.pack, kernels(), pool, area};
    runDepth(context, {});
    runRelax(context, 0, 7, true);
    oracleRelax(dense, world.pack, 7);
    for (const TileCoordinate tile : plan.active)
      for (int i = 0; i < rules::kTileCells; ++i) {
        const int x = tile.x * 64 + i % 64, y = tile.y * 64 + i / 64;
        ASSERT_EQ(area.height[area.offsetAt(x, y)], dense.height[dense.at(x, y)])
            << x << ", " << y << " of " << pattern;
      }
  }
}

}  // namespace
}  // namespace spoor::test
