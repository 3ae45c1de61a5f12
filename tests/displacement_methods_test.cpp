// Stage displace by its other methods: spread over several cells beyond the nearest free one, and iterative from cell
// to cell.
#include <gtest/gtest.h>

#include <numeric>
#include <random>

#include "shaders/rules/displace.h"
#include "shaders/rules/flow.h"
#include "tests/stage_rig.h"

namespace spoor::test {
namespace {

constexpr int kNone = rules::kNoUnderside;

class DirectStage : public OnEveryBackend {};
class SpreadStage : public OnEveryBackend {};
class IterativeStage : public OnEveryBackend {};

std::int64_t sumOf(const Cells& cells) { return std::accumulate(cells.begin(), cells.end(), std::int64_t(0)); }

/// What displacement leaves of ground 1000 high beneath some undersides.
struct Displaced {
  Displaced(const BackendCase& backend_case, int columns, int rows, const Parameters& parameters,
            const Cells& underside) {
    ScenePack pack = groundPack(columns, rows, Cells(underside.size(), 1000), 5000);
    pack.parameters = parameters;
    const World world(std::move(pack));
    const auto rig = makeStageRig(backend_case, world);
    rig->setUnderside(underside);
    rig->moveSoil();
    height = rig->height();
    kept = rig->keptBack();
  }
  Cells height;
  std::int64_t kept = 0;
};

Parameters spreading(int spread_cells) {
  return {.displacement = Displacement::spread, .penetration_divider_q = 1000, .spread_cells = spread_cells};
}

TEST_P(SpreadStage, OneCellBeyondTheNearestFreeOneForEachBegunDividerOfTheOverlap) {
  const auto expect = [&](int spread_cells, const Cells& underside, const Cells& height) {
    const Displaced displaced(GetParam(), 7, 1, spreading(spread_cells), underside);
    EXPECT_EQ(displaced.height, height) << spread_cells;
    EXPECT_EQ(displaced.kept, 0);
  };
  // Cell 0 is 2501 deep in the soil: three parts of 834, 834 and 833; the nearest free cell, 1, gets none of it.
  const Cells open = {-1501, kNone, kNone, kNone, kNone, kNone, kNone};
  expect(16, open, {-1501, 1000, 1834, 1834, 1833, 1000, 1000});
  expect(2, open, {-1501, 1000, 2251, 2250, 1000, 1000, 1000});
  // Up to the first cell that is not free; where that is the first, the nearest free cell takes everything.
  expect(16, {-1501, kNone, kNone, 1000, kNone, kNone, kNone}, {-1501, 1000, 3501, 1000, 1000, 1000, 1000});
  expect(16, {-1501, kNone, 1000, kNone, kNone, kNone, kNone}, {-1501, 3501, 1000, 1000, 1000, 1000, 1000});
  // No farther than the domain.
  expect(16, {1000, 1000, 1000, -1501, 1000, kNone, kNone}, {1000, 1000, 1000, -1501, 1000, 1000, 3501});
}

TEST_P(SpreadStage, AlongTheLineFromTheSourceOnFiveByFiveCells) {
  // From (4, 3) the only free cells lie from (2, 2) on: along x by 1, 2, along y by 1 and 1 (a half, rounded outward,
  // and one).
  const Displaced displaced(GetParam(), 5, 5, spreading(16), {1000,  1000,  1000,  1000, 1000,   //
                                                              kNone, kNone, 1000,  1000, 1000,   //
                                                              1000,  1000,  kNone, 1000, 1000,   //
                                                              1000,  1000,  1000,  1000, -1500,  //
                                                              1000,  1000,  1000,  1000, 1000});
  EXPECT_EQ(displaced.height, (Cells{1000, 1000, 1000, 1000, 1000,   //
                                     2250, 2250, 1000, 1000, 1000,   //
                                     1000, 1000, 1000, 1000, 1000,   //
                                     1000, 1000, 1000, 1000, -1500,  //
                                     1000, 1000, 1000, 1000, 1000}));
}

TEST_P(SpreadStage, PartsThatFindNoRoomGoOnInTheNextRound) {
  // Cell 0 wants 2000 in each of cells 2 and 3; 3 has room for 300, so it is closed; the other 1700 have n = 2, of
  // which cell 2 alone is still free.
  const Cells underside = {-3000, kNone, kNone, 1300, kNone};
  Parameters parameters = spreading(2);
  parameters.capacity_rounds = 1;
  const Displaced once(GetParam(), 5, 1, parameters, underside);
  EXPECT_EQ(once.height, (Cells{-1300, 1000, 3000, 1300, 1000}));
  EXPECT_EQ(once.kept, 1700);
  parameters.capacity_rounds = 2;
  const Displaced twice(GetParam(), 5, 1, parameters, underside);
  EXPECT_EQ(twice.height, (Cells{-3000, 1000, 4700, 1300, 1000}));
  EXPECT_EQ(twice.kept, 0);
}

Parameters iterating(int iterations) {
  return {.displacement = Displacement::iterative, .displace_iterations = iterations};
}

TEST_P(IterativeStage, StepsDownTheDistanceInARowOfFiveCells) {
  // Overlaps 100 and 301 in cells 1 and 2, cell 3 an obstacle, the ends free. Cell 2 gives to both sides, half to each,
  // and keeps the odd unit.
  const Cells underside = {kNone, 900, 699, 1000, kNone};
  const auto expect = [&](int iterations, const Cells& height, int kept) {
    const Displaced displaced(GetParam(), 5, 1, iterating(iterations), underside);
    EXPECT_EQ(displaced.height, height) << iterations << " iterations";
    EXPECT_EQ(displaced.kept, kept) << iterations << " iterations";
  };
  expect(0, {1000, 1000, 1000, 1000, 1000}, 401);
  expect(1, {1100, 1050, 700, 1150, 1000}, 301);
  expect(2, {1250, 900, 700, 1000, 1150}, 1);
  expect(10, {1250, 900, 700, 1000, 1150}, 1);
}

TEST_P(IterativeStage, ACellGivesToAllNearerNeighboursOnFiveByFiveCells) {
  // Only column 4 is free: squares of the distances are 16 9 4 1 0 in every row. Of the neighbours of the middle, which
  // is 800 deep, the three of column 3 are nearer than itself.
  const Displaced displaced(GetParam(), 5, 5, iterating(1), {1000, 1000, 1000, 1000, kNone,  //
                                                             1000, 1000, 1000, 1000, kNone,  //
                                                             1000, 1000, 200,  1000, kNone,  //
                                                             1000, 1000, 1000, 1000, kNone,  //
                                                             1000, 1000, 1000, 1000, kNone});
  // floor(800 / 3) = 266 to each, two stay.
  EXPECT_EQ(displaced.height, (Cells{1000, 1000, 1000, 1000, 1000,  //
                                     1000, 1000, 1000, 1266, 1000,  //
                                     1000, 1000, 202,  1266, 1000,  //
                                     1000, 1000, 1000, 1266, 1000,  //
                                     1000, 1000, 1000, 1000, 1000}));
  EXPECT_EQ(displaced.kept, 800);
}

TEST_P(IterativeStage, AFreeCellTakesNoMoreThanFitsBeneathABody) {
  // Cells 1 and 3 offer 400 and 300 to cell 2, with room for 500: 285 and 214. One unit more fits later: 115 and 86
  // offered to a room of 1 give floor(115 / 201) = floor(86 / 201) = 0.
  const Displaced displaced(GetParam(), 5, 1, iterating(10), {1000, 600, 1500, 700, 1000});
  EXPECT_EQ(displaced.height, (Cells{1000, 715, 1499, 786, 1000}));
  EXPECT_EQ(displaced.kept, 115 + 86);
}

TEST_P(IterativeStage, WithoutAFreeCellAllSoilStays) {
  const Displaced displaced(GetParam(), 3, 1, iterating(5), {500, 600, 1000});
  EXPECT_EQ(displaced.height, (Cells{1000, 1000, 1000}));
  EXPECT_EQ(displaced.kept, 900);
}

/// Random ground beneath random undersides by random parameters but for the method: the stages and the oracle leave the
/// same, and no soil is lost.
void checkRandomWorld(const BackendCase& backend_case, Displacement displacement, int columns, int rows,
                      std::uint32_t seed) {
  ScenePack pack = noisePack(columns, rows, seed, -3000, 3000, seed % 3 == 0 ? 700 : 100000);
  pack.parameters = randomParameters(seed);
  pack.parameters.displacement = displacement;
  SCOPED_TRACE("seed " + std::to_string(seed) + ", " + std::to_string(columns) + " x " + std::to_string(rows) + ", " +
               describe(pack.parameters));
  const World world(std::move(pack));
  const auto rig = makeStageRig(backend_case, world);
  coverAtRandom(*rig, seed);
  DenseWorld dense = denseCopy(*rig);
  const std::int64_t before = sumOf(dense.height) + sumOf(dense.compacted);
  rig->moveSoil();
  auto overlap = oracleOverlap(dense, world.pack.parameters.obstacle_threshold_q);
  oracleCompact(dense, overlap, world.pack.parameters, wholeWorld(dense));
  const OracleKept kept = oracleDisplace(dense, overlap, world.pack.parameters, wholeWorld(dense));
  ASSERT_EQ(rig->height(), insideCells(dense, dense.height));
  ASSERT_EQ(rig->compacted(), insideCells(dense, dense.compacted));
  ASSERT_EQ(rig->keptBack(), kept.sum);
  ASSERT_EQ(sumOf(rig->height()) + sumOf(rig->compacted()), before);
}

void checkRandomWorlds(const BackendCase& backend_case, Displacement displacement) {
  constexpr std::pair<int, int> sizes[] = {{77, 41}, {1, 200}, {65, 1}, {9, 66}, {130, 67}};
  for (std::uint32_t seed = 0; seed < (backend_case.slow() ? 10u : 30u); ++seed) {
    const auto& [columns, rows] = sizes[seed % 5];
    ASSERT_NO_FATAL_FAILURE(checkRandomWorld(backend_case, displacement, columns, rows, seed));
  }
}

/// More rows and columns than one thread's share.
void checkLargeWorld(BackendCase backend_case, Displacement displacement) {
  backend_case.thread_count = 4;
  // Both seeds have 40 iterations, two rounds, and so little room that much is kept back.
  for (const std::uint32_t seed : {3u, 33u})
    if (seed == 3 || !backend_case.gl) checkRandomWorld(backend_case, displacement, 230, 190, seed);
}

TEST_P(DirectStage, EqualsTheOracleWhenSharedOutBetweenThreads) { checkLargeWorld(GetParam(), Displacement::direct); }

TEST_P(SpreadStage, EqualsTheOracleWhenSharedOutBetweenThreads) { checkLargeWorld(GetParam(), Displacement::spread); }

TEST_P(IterativeStage, EqualsTheOracleWhenSharedOutBetweenThreads) {
  checkLargeWorld(GetParam(), Displacement::iterative);
}

TEST_P(SpreadStage, EqualsTheOracleOnWorldsOfAnySizeAndKeepsTheSum) {
  checkRandomWorlds(GetParam(), Displacement::spread);
}

TEST_P(IterativeStage, EqualsTheOracleOnWorldsOfAnySizeAndKeepsTheSum) {
  checkRandomWorlds(GetParam(), Displacement::iterative);
}

TEST_P(DirectStage, EqualsTheOracleForAnyParametersAndKeepsTheSum) {
  checkRandomWorlds(GetParam(), Displacement::direct);
}

SPOOR_ON_EVERY_BACKEND(DirectStage);
SPOOR_ON_EVERY_BACKEND(SpreadStage);
SPOOR_ON_EVERY_BACKEND(IterativeStage);

TEST(Spread, PartsMakeUpTheWholeAndDifferByAtMostOne) {
  std::mt19937 engine(41);
  for (int round = 0; round < 3000; ++round) {
    const int count = 1 + int(engine() % kSpreadCellsLimit);
    const int overlap = round % 2 == 0 ? count + int(engine() % 300) : rules::kHeightLimit - int(engine() % 1000);
    std::int64_t sum = 0;
    for (int i = 0; i < count; ++i) {
      const int part = rules::spreadPart(overlap, count, i);
      sum += part;
      ASSERT_TRUE(part == overlap / count || part == overlap / count + 1);
      ASSERT_GE(part, 1);
      if (i > 0) {
        ASSERT_LE(part, rules::spreadPart(overlap, count, i - 1)) << "the first ones take more";
      }
    }
    ASSERT_EQ(sum, overlap);
  }
}

TEST(Spread, OneTargetForEachBegunDividerButNoMoreThanAllowed) {
  EXPECT_EQ(rules::spreadTargets(1, 1000, 16), 1);
  EXPECT_EQ(rules::spreadTargets(1000, 1000, 16), 1);
  EXPECT_EQ(rules::spreadTargets(1001, 1000, 16), 2);
  EXPECT_EQ(rules::spreadTargets(15001, 1000, 16), 16);
  EXPECT_EQ(rules::spreadTargets(16001, 1000, 16), 16);
  EXPECT_EQ(rules::spreadTargets(rules::kHeightLimit, 1, 64), 64);
  EXPECT_EQ(rules::spreadTargets(5, 1, 64), 5);
  EXPECT_EQ(rules::spreadTargets(rules::kHeightLimit, 1 << 29, 64), 2);
}

TEST(Spread, OffsetsFollowTheLineToTheNearestCellHalvesOutward) {
  EXPECT_EQ(rules::spreadOffset(1, 2, 1), 1);
  EXPECT_EQ(rules::spreadOffset(-1, 2, 1), -1);
  EXPECT_EQ(rules::spreadOffset(1, 3, 1), 0);
  EXPECT_EQ(rules::spreadOffset(1, 3, 2), 1);
  std::mt19937 engine(42);
  for (int round = 0; round < 20000; ++round) {
    const int longest = 1 + int(engine() % 16384), d = int(engine() % std::uint32_t(2 * longest + 1)) - longest;
    const int k = 1 + int(engine() % kSpreadCellsLimit), offset = rules::spreadOffset(d, longest, k);
    ASSERT_LE(std::abs(2 * (std::int64_t(offset) * longest - std::int64_t(d) * k)), longest) << d << ", " << longest;
    ASSERT_EQ(rules::spreadOffset(-d, longest, k), -offset);
    ASSERT_EQ(rules::spreadOffset(longest, longest, k), k) << "one cell at each step along the longer axis";
  }
}

TEST(Iterative, OffersLeaveARemainderAndFitAnIntTogether) {
  EXPECT_EQ(rules::flowOffer(1000, 0), 0);
  EXPECT_EQ(rules::flowOffer(1000, 3), 333);
  EXPECT_EQ(rules::flowOffer(7, 8), 0);
  EXPECT_EQ(rules::flowOffer(2 * rules::kHeightLimit, 1), rules::kOfferMost);
  EXPECT_LE(std::int64_t(rules::kOfferMost) * 8, INT32_MAX);
}

TEST(Iterative, FreeCellsHaveTheRoomBeneathABodyOthersAnyUpToTheHeightLimit) {
  EXPECT_EQ(rules::flowRoom(rules::kFree, 1000, 50, 1500, 0), 450);
  EXPECT_EQ(rules::flowRoom(rules::kFree, 1000, 50, 1500, 450), 0);
  EXPECT_EQ(rules::flowRoom(rules::kObstacle, 1000, 50, 1000, 450), rules::kHeightLimit - 1050);
  EXPECT_EQ(rules::flowRoom(300, 700, 300, 700, 0), rules::kHeightLimit - 1000);
  EXPECT_EQ(rules::flowRoom(rules::kObstacle, -rules::kHeightLimit, 0, 0, 0), 2 * rules::kHeightLimit);
}

}  // namespace
}  // namespace spoor::test
