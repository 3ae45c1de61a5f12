// Stage displace: soil goes to its nearest free cell as far as there is room, and none is lost.
#include "shaders/rules/displace.h"

#include <gtest/gtest.h>

#include <numeric>
#include <random>

#include "tests/stage_rig.h"

namespace spoor::test {
namespace {

constexpr int kNone = rules::kNoUnderside;

class DisplaceStage : public OnEveryBackend {};

std::vector<std::int32_t> level(int height) { return std::vector<std::int32_t>(25, height); }

TEST_P(DisplaceStage, FiveByFiveCellsUnderASmallBody) {
  const World world(groundPack(5, 5, level(1000), 5000));
  const auto rig = makeStageRig(GetParam(), world);
  rig->setUnderside({kNone, kNone, kNone, kNone, kNone,  //
                     kNone, 900,   800,   900,   kNone,  //
                     kNone, 900,   700,   900,   kNone,  //
                     kNone, kNone, kNone, kNone, kNone,  //
                     kNone, kNone, kNone, kNone, kNone});
  rig->moveSoil();
  // Row 1 goes down to row 0; of row 2 the sides go to the side, and the middle up to row 3.
  EXPECT_EQ(rig->height(), (std::vector<std::int32_t>{1000, 1100, 1200, 1100, 1000,  //
                                                      1000, 900,  800,  900,  1000,  //
                                                      1100, 900,  700,  900,  1100,  //
                                                      1000, 1000, 1300, 1000, 1000,  //
                                                      1000, 1000, 1000, 1000, 1000}));
}

TEST_P(DisplaceStage, WithoutEnoughRoomEachSourceGetsItsShareRoundedDown) {
  const World world(groundPack(5, 1, {1000, 1000, 1000, 1000, 1000}, 5000));
  const auto rig = makeStageRig(GetParam(), world);
  // Cells 1 and 2 want to give 400 and 300 to cell 0, under a roof 500 above it; cells 3 and 4 are no place to go.
  rig->setUnderside({1500, 600, 700, 1000, 1000});
  rig->moveSoil();
  // floor(400 * 500 / 700) = 285, floor(300 * 500 / 700) = 214: one unit of room stays free.
  EXPECT_EQ(rig->height(), (std::vector<std::int32_t>{1499, 715, 786, 1000, 1000}));
  EXPECT_EQ(rig->keptBack(), 115 + 86);
}

/// Cells 1 and 2 of seven want to give 400 and 300 away; there is room for 500 in cell 0, for 100 in cell 5, and for
/// all in cell 6.
void checkRounds(const BackendCase& backend_case, int rounds, const Cells& expected, int kept) {
  ScenePack pack = groundPack(7, 1, Cells(7, 1000), 5000);
  pack.parameters.capacity_rounds = rounds;
  const World world(std::move(pack));
  const auto rig = makeStageRig(backend_case, world);
  rig->setUnderside({1500, 600, 700, 1000, 1000, 1100, kNone});
  rig->moveSoil();
  EXPECT_EQ(rig->height(), expected) << rounds << " rounds";
  EXPECT_EQ(rig->keptBack(), kept) << rounds << " rounds";
}

TEST_P(DisplaceStage, WhatFoundNoRoomLooksForTheNextFreeCellInTheNextRound) {
  // As above; then 115 and 86 go to cell 5, floor(115 * 100 / 201) = 57 and floor(86 * 100 / 201) = 42 of them; then
  // 58 and 44 go to cell 6.
  checkRounds(GetParam(), 1, {1499, 715, 786, 1000, 1000, 1000, 1000}, 201);
  checkRounds(GetParam(), 2, {1499, 658, 744, 1000, 1000, 1099, 1000}, 102);
  checkRounds(GetParam(), 3, {1499, 600, 700, 1000, 1000, 1099, 1102}, 0);
  checkRounds(GetParam(), 16, {1499, 600, 700, 1000, 1000, 1099, 1102}, 0);
}

TEST_P(DisplaceStage, WithoutAnyFreeCellAllSoilStays) {
  const World world(groundPack(3, 1, {1000, 1000, 1000}, 5000));
  const auto rig = makeStageRig(GetParam(), world);
  rig->setUnderside({500, 600, 1000});
  rig->moveSoil();
  EXPECT_EQ(rig->height(), (std::vector<std::int32_t>{1000, 1000, 1000}));
}

TEST_P(DisplaceStage, DownToBedrockAndNoDeeper) {
  const World world(groundPack(3, 1, {1000, 1000, 1000}, 300));
  const auto rig = makeStageRig(GetParam(), world);
  rig->setUnderside({kNone, -5000, kNone});
  rig->moveSoil();
  EXPECT_EQ(rig->height(), (std::vector<std::int32_t>{1300, 700, 1000}));
}

TEST_P(DisplaceStage, AGapOfTheObstacleThresholdTakesNothing) {
  ScenePack pack = groundPack(5, 1, {1000, 1000, 1000, 1000, 1000}, 5000);
  pack.parameters.obstacle_threshold_q = 80;
  pack.parameters.capacity_rounds = 1;
  const World world(std::move(pack));
  const auto rig = makeStageRig(GetParam(), world);
  rig->setUnderside({kNone, 1080, 900, 1081, kNone});
  rig->moveSoil();
  // Cell 1 has a gap of 80: an obstacle. Cell 3 has 81: room for 81 of the 100.
  EXPECT_EQ(rig->height(), (std::vector<std::int32_t>{1000, 1000, 919, 1081, 1000}));
}

TEST(Displace, AShareIsRequestTimesRoomOverTotalForTheLargestNumbers) {
  const std::int64_t totals[] = {1, 7, 1 << 30, std::int64_t(1) << 40, (std::int64_t(1) << 62) - 1};
  for (const std::int64_t total : totals)
    for (const int request : {1, 3, 1 << 29, rules::kHeightLimit})
      for (const int room : {0, 1, 12345, rules::kHeightLimit, INT32_MAX}) {
        if (request > total) continue;
        const auto expected = total <= room ? request : std::int64_t(__int128(request) * room / total);
        EXPECT_EQ(rules::grantedShare(request, room, total), expected) << request << ", " << room << ", " << total;
      }
}

/// Random ground under random undersides: the stages and the oracle leave the same heights, and their sum.
void checkRandomWorld(const BackendCase& backend_case, int columns, int rows, std::uint32_t seed) {
  std::mt19937 engine(seed);
  ScenePack pack = noisePack(columns, rows, engine(), -3000, 3000, seed % 2 == 0 ? 100000 : 700);
  pack.parameters.obstacle_threshold_q = seed % 3 == 0 ? 0 : 300;
  const World world(std::move(pack));
  const auto rig = makeStageRig(backend_case, world);
  coverAtRandom(*rig, seed);
  const auto before = rig->height();
  DenseWorld dense = denseCopy(*rig);
  rig->moveSoil();
  const auto overlap = oracleOverlap(dense, world.pack.parameters.obstacle_threshold_q);
  const OracleKept kept = oracleDisplace(dense, overlap, world.pack.parameters, wholeWorld(dense));
  const auto after = rig->height();
  ASSERT_EQ(after, insideCells(dense, dense.height)) << columns << " x " << rows << ", seed " << seed;
  ASSERT_EQ(rig->keptBack(), kept.sum) << columns << " x " << rows << ", seed " << seed;
  ASSERT_EQ(std::accumulate(after.begin(), after.end(), std::int64_t(0)),
            std::accumulate(before.begin(), before.end(), std::int64_t(0)));
}

TEST_P(DisplaceStage, EqualsTheOracleOnWorldsOfAnySizeAndKeepsTheSum) {
  for (std::uint32_t seed = 0; seed < 12; ++seed)
    for (const auto& [columns, rows] : {std::pair{77, 41}, {1, 200}, {65, 1}, {9, 66}})
      checkRandomWorld(GetParam(), columns, rows, seed);
}

TEST_P(DisplaceStage, RowsThatShareTargetsDoNotRace) {
  // Many rows, more than one task's share, whose cells go by turns to the same two targets.
  constexpr int kColumns = 256, kRows = 512;
  const World world(groundPack(kColumns, kRows, std::vector<std::int32_t>(kColumns * kRows, 1000), 5000));
  BackendCase backend_case = GetParam();
  backend_case.thread_count = 4;
  const auto rig = makeStageRig(backend_case, world);
  for (int round = 0; round < (backend_case.gl ? 4 : 10); ++round) {
    std::vector<std::int32_t> underside(kColumns * kRows, 995);
    underside[0] = underside[1] = kNone;
    rig->setHeight(std::vector<std::int32_t>(kColumns * kRows, 1000));
    rig->setUnderside(underside);
    rig->penetration();
    rig->nearest();
    Cells target(kColumns * kRows);
    for (std::size_t i = 0; i < target.size(); ++i) target[i] = int(i % 2);
    rig->setTarget(target);
    rig->displace();
    const Cells height = rig->height();
    ASSERT_EQ(height[0], 1000 + 5 * (kColumns * kRows / 2 - 1)) << "round " << round;
    ASSERT_EQ(height[1], 1000 + 5 * (kColumns * kRows / 2 - 1)) << "round " << round;
    ASSERT_EQ(height[kColumns * kRows - 1], 995) << "round " << round;
  }
}

SPOOR_ON_EVERY_BACKEND(DisplaceStage);

}  // namespace
}  // namespace spoor::test
