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

class RelaxStage : public OnEveryBackend {};

TEST(Relax, APairMovesHalfOfItsExcessRoundedUp) {
  EXPECT_EQ(rules::pairFlow(1000, 0, 700, 700, kMuch, kMuch, kMuch, kMuch), 150);
  EXPECT_EQ(rules::pairFlow(1001, 0, 700, 700, kMuch, kMuch, kMuch, kMuch), 151);
  EXPECT_EQ(rules::pairFlow(0, 1001, 700, 700, kMuch, kMuch, kMuch, kMuch), -151);
  EXPECT_EQ(rules::pairFlow(700, 0, 700, 700, kMuch, kMuch, kMuch, kMuch), 0);
  EXPECT_EQ(rules::pairFlow(701, 0, 700, 700, kMuch, kMuch, kMuch, kMuch), 1);
  EXPECT_EQ(rules::pairFlow(1000, 0, 700, 700, 40, kMuch, kMuch, kMuch), 40) << "no more than the giver's soil";
  EXPECT_EQ(rules::pairFlow(1000, 0, 700, 700, kMuch, kMuch, kMuch, 30), 30) << "no more than the taker's room";
  EXPECT_EQ(rules::pairFlow(0, 1000, 700, 700, kMuch, 40, kMuch, kMuch), -40);
  EXPECT_EQ(rules::pairFlow(0, 1000, 700, 700, kMuch, kMuch, 30, kMuch), -30);
  EXPECT_EQ(rules::pairFlow(kMuch, -kMuch, 1, 1, kMuch, 0, 0, kMuch), kMuch) << "the widest difference";
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

TEST_P(RelaxStage, OneSweepOverAColumnOnFiveByFiveCells) {
  std::vector<std::int32_t> ground(25, 0);
  ground[12] = 1600;
  ScenePack pack = groundPack(5, 5, ground, 100000);
  pack.parameters.materials[0].slope_threshold_q = 100;
  pack.parameters.materials[0].diagonal_threshold_q = 141;
  const World world(std::move(pack));
  const auto rig = makeStageRig(GetParam(), world);
  rig->relax(0, 1);
  // By hand, matching by matching: the row becomes 0 0 850 750 0, then 0 375 475 425 325; upwards 138 188 163 113 leave
  // it, then downwards 69 94 81 56 and from the row above 19 44 32 7; last, diagonals take 14 and 7 into column 0.
  EXPECT_EQ(rig->height(), (std::vector<std::int32_t>{0,  0,   0,   0,   0,    //
                                                      14, 69,  94,  81,  56,   //
                                                      0,  147, 193, 181, 156,  //
                                                      7,  119, 144, 131, 106,  //
                                                      0,  19,  44,  32,  7}));
  EXPECT_EQ(sumOf(rig->height()), 1600);
}

/// Random heights, bedrock and undersides over a random set of active tiles.
void checkRandomWorld(BackendCase backend_case, int columns, int rows, std::uint32_t seed) {
  std::mt19937 engine(seed);
  const int relief = seed % 2 == 0 ? 4000 : 60000;
  std::vector<std::int32_t> ground;
  for (int i = 0; i < columns * rows; ++i) ground.push_back(int(engine() % std::uint32_t(relief)));
  ScenePack pack = groundPack(columns, rows, ground, seed % 3 == 0 ? 500 : 100000);
  pack.parameters.materials[0].slope_threshold_q = seed % 5 == 0 ? 1 : 350;
  pack.parameters.materials[0].diagonal_threshold_q = seed % 5 == 0 ? 1 : 495;
  pack.parameters.obstacle_threshold_q = seed % 4 == 0 ? 0 : 200;
  const World world(std::move(pack));
  const int sweeps = int(seed % 14);
  for (const bool skip_settled : {true, false}) {
    backend_case.skip_settled = skip_settled;
    const auto rig = makeStageRig(backend_case, world);
    std::vector<std::int32_t> underside;
    std::mt19937 again(seed);
    for (int i = 0; i < columns * rows; ++i)
      underside.push_back(i / columns % 64 < 40 && again() % 3 == 0 ? int(again() % std::uint32_t(relief)) : kNone);
    rig->setUnderside(underside);
    DenseWorld dense = denseCopy(*rig);
    rig->relax(0, sweeps);
    oracleRelax(dense, world.pack.parameters, sweeps);
    ASSERT_EQ(rig->height(), insideCells(dense, dense.height))
        << columns << " x " << rows << ", seed " << seed << ", skip " << skip_settled;
    ASSERT_EQ(sumOf(rig->height()), sumOf(ground));
  }
}

TEST_P(RelaxStage, EqualsTheOracleOnWorldsOfAnySizeAndKeepsTheSum) {
  // Slow cases take a third of the seeds, not the same.
  const BackendCase& backend_case = GetParam();
  const std::uint32_t stride = backend_case.slow() ? 3 : 1, first = backend_case.slow() && backend_case.reversed;
  for (std::uint32_t seed = first; seed < 14; seed += stride)
    for (const auto& [columns, rows] : {std::pair{77, 131}, {1, 200}, {65, 1}, {129, 66}})
      checkRandomWorld(backend_case, columns, rows, seed);
}

TEST_P(RelaxStage, SweepsInPartsEqualSweepsAtOnce) {
  const World world(noisePack(150, 140, 5, -9000, 9000, 100000));
  const auto at_once = makeStageRig(GetParam(), world), in_parts = makeStageRig(GetParam(), world);
  at_once->relax(0, 12);
  in_parts->relax(0, 1);
  in_parts->relax(1, 7);
  in_parts->relax(8, 4);
  EXPECT_EQ(at_once->height(), in_parts->height());
}

/// Seven sweeps over those tiles of a world that a pattern names.
void checkActiveTiles(const BackendCase& backend_case, const World& world, std::uint32_t pattern) {
  const TileCoordinate extent = tileExtent(world.pack);
  DenseWorld dense(world.base);
  std::vector<TileCoordinate> active;
  for (int i = 0; i < extent.x * extent.y; ++i)
    if ((pattern >> (i % 16) & 1) != 0) active.push_back({i % extent.x, i / extent.x});
  for (const TileCoordinate tile : active)
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) dense.active[dense.at(tile.x * 64 + x, tile.y * 64 + y)] = 1;
  const auto rig = makeStageRig(backend_case, world, active);
  rig->relax(0, 7);
  oracleRelax(dense, world.pack.parameters, 7);
  const Cells heights = rig->tileHeights();
  std::size_t next = 0;
  for (const TileCoordinate tile : active)
    for (int i = 0; i < rules::kTileCells; ++i) {
      const int x = tile.x * 64 + i % 64, y = tile.y * 64 + i / 64;
      ASSERT_EQ(heights[next++], dense.height[dense.at(x, y)]) << x << ", " << y << " of " << pattern;
    }
}

/// Tiles of a checkerboard with one more: runs that meet at corners only, gaps within a band, bands without a
/// neighbour.
TEST_P(RelaxStage, FlowCrossesABorderOnlyBetweenActiveTiles) {
  const World world(noisePack(64 * 4 + 9, 64 * 4 + 5, 6, -30000, 30000, 100000));
  for (const std::uint32_t pattern : {0x5a5au, 0xa5a5u, 0x9009u, 0xf00fu, 0x8421u, 0x1248u, 0x6ff6u})
    ASSERT_NO_FATAL_FAILURE(checkActiveTiles(GetParam(), world, pattern));
}

TEST_P(RelaxStage, FlowsWhereNothingLimitsIt) {
  const World world(noisePack(64 * 4, 64 * 4, 7, -30000, 30000, 100000));  // of whole tiles: no border to close either
  for (const std::uint32_t pattern : {0x5a5au, 0xf00fu, 0x6ff6u})
    ASSERT_NO_FATAL_FAILURE(checkActiveTiles(GetParam(), world, pattern));
}

SPOOR_ON_EVERY_BACKEND(RelaxStage);

}  // namespace
}  // namespace spoor::test
