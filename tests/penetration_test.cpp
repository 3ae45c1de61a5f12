// Stage penetration: which cells a body overlaps, and by how much.
#include "shaders/rules/penetration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/stage_rig.h"

namespace spoor::test {
namespace {

constexpr int kNone = rules::kNoUnderside;
constexpr int kDeep = -1000000;

class PenetrationStage : public OnEveryBackend {};

struct Case {
  int height, bedrock, underside, obstacle_threshold, expected;
};

TEST(Penetration, ClassifiesACellByTheGapAboveIt) {
  const Case cases[] = {
      {100, -50, kNone, 0, rules::kFree},     // nothing above
      {100, -50, 30, 0, 70},                  // soil above the underside
      {100, -50, -400, 0, 150},               // no more than there is soil
      {100, 100, -400, 0, rules::kObstacle},  // bare rock that a body reaches into
      {100, -50, 100, 0, rules::kObstacle},   // the underside just touches
      {100, -50, 101, 0, rules::kFree},       // one unit of room is room
      {100, -50, 110, 10, rules::kObstacle},  // a gap of the threshold is none yet
      {100, -50, 111, 10, rules::kFree},      // one more is
      {100, -50, 99, 1000, 1},                // the threshold does not hide an overlap
      {rules::kHeightLimit, -5, -rules::kHeightLimit, 0, rules::kHeightLimit + 5},
  };
  for (const Case& c : cases)
    EXPECT_EQ(rules::cellOverlap(c.height, c.bedrock, c.underside, rules::kNoUnderside, c.obstacle_threshold),
              c.expected)
        << c.height << ", " << c.bedrock << ", " << c.underside << ", " << c.obstacle_threshold;
}

TEST_P(PenetrationStage, FiveByFiveCellsUnderASlantedBody) {
  ScenePack pack = groundPack(5, 5, std::vector<std::int32_t>(25, 1000), 600);
  pack.parameters.obstacle_threshold_q = 50;
  const World world(std::move(pack));
  const auto rig = makeStageRig(GetParam(), world);
  rig->setUnderside({kNone, kNone, kNone, kNone, kNone,  //
                     kNone, 900,   800,   700,   kNone,  //
                     kNone, 1000,  500,   300,   kNone,  //
                     kNone, 1050,  1051,  kDeep, kNone,  //
                     kNone, kNone, kNone, kNone, kNone});
  rig->penetration();
  EXPECT_EQ(rig->overlap(), (std::vector<std::int32_t>{-1, -1,  -1,  -1,  -1,  //
                                                       -1, 100, 200, 300, -1,  //
                                                       -1, 0,   500, 600, -1,  //
                                                       -1, 0,   -1,  600, -1,  //
                                                       -1, -1,  -1,  -1,  -1}));
  EXPECT_EQ(rig->penetratingCount(), 6);
  if (const auto* native = dynamic_cast<const NativeStageRig*>(rig.get())) {
    EXPECT_EQ(native->domain.penetrating_in_row, (std::vector<int>{0, 3, 2, 1, 0}));
  }
}

TEST_P(PenetrationStage, EqualsTheOracleOnWorldsOfAnySize) {
  std::mt19937 engine(21);
  for (const auto& [columns, rows] : {std::pair{77, 131}, {1, 200}, {65, 1}, {130, 40}}) {
    ScenePack pack = noisePack(columns, rows, engine(), -2000, 2000, 900);
    pack.parameters.obstacle_threshold_q = 100;
    const World world(std::move(pack));
    const auto rig = makeStageRig(GetParam(), world);
    std::vector<std::int32_t> underside;
    for (int i = 0; i < columns * rows; ++i)
      underside.push_back(engine() % 3 == 0 ? kNone : int(engine() % 6000) - 3000);
    rig->setUnderside(underside);
    rig->penetration();
    const DenseWorld dense = denseCopy(*rig);
    EXPECT_EQ(rig->overlap(), insideCells(dense, oracleOverlap(dense, 100))) << columns << " x " << rows;
  }
}

/// Five cells of 1000 with 5000 of soil beneath a body that reaches 1000, 1000, 500, 1 and 0 deep.
std::unique_ptr<StageRig> pressedRig(const BackendCase& backend_case, const World& world) {
  auto rig = makeStageRig(backend_case, world);
  rig->setUnderside({0, 0, 500, 999, kNone});
  return rig;
}

ScenePack compactingPack(int compression_q16, int limit_q16) {
  ScenePack pack = groundPack(5, 1, Cells(5, 1000), 5000);
  pack.parameters.materials[0].compression_q16 = compression_q16;
  pack.parameters.materials[0].compaction_limit_q16 = limit_q16;
  return pack;
}

TEST_P(PenetrationStage, PressesAShareOfTheOverlapTogetherInPlace) {
  const World world(compactingPack(19661, 0));  // 0.3: floor(1000 * 19661 / 65536) = 300, of 500 it is 150, of 1 none
  const auto rig = pressedRig(GetParam(), world);
  rig->setCompacted({0, 7000, 0, 0, 12});
  rig->penetration();
  EXPECT_EQ(rig->penetratingCount(), 4);
  EXPECT_EQ(rig->compacted(), (Cells{300, 7300, 150, 0, 12}));
  EXPECT_EQ(rig->height(), (Cells{700, 700, 850, 1000, 1000}));
  EXPECT_EQ(rig->overlap(), (Cells{700, 700, 350, 1, -1}));
}

TEST_P(PenetrationStage, PressesLessWhereMuchIsPressedTogetherAlready) {
  const World world(compactingPack(19661, 16384));  // at most a quarter of a column
  const auto rig = pressedRig(GetParam(), world);
  rig->setCompacted({0, 1000, 1250, 5000, 0});
  rig->penetration();
  // Columns of 5000, 6000, 6250 and 10000 can take 1250, 1500, 1562 and 2500. Cell 1 has room for 500 of 1500: a share
  // of floor(19661 * 500 / 1500) = 6553, that is 99 of 1000. Cell 2: floor(19661 * 312 / 1562) = 3927, 29 of 500.
  EXPECT_EQ(rig->compacted(), (Cells{300, 1099, 1279, 5000, 0}));
  EXPECT_EQ(rig->height(), (Cells{700, 901, 971, 1000, 1000}));
  EXPECT_EQ(rig->overlap(), (Cells{700, 901, 471, 1, -1}));
}

TEST_P(PenetrationStage, WhereAllIsPressedTogetherAnObstacleIsLeft) {
  const World world(compactingPack(65536, 0));
  const auto rig = pressedRig(GetParam(), world);
  rig->moveSoil();
  EXPECT_EQ(rig->penetratingCount(), 4);
  EXPECT_EQ(rig->overlap(), (Cells{0, 0, 0, 0, -1}));
  EXPECT_EQ(rig->compacted(), (Cells{1000, 1000, 500, 1, 0}));
  EXPECT_EQ(rig->height(), (Cells{0, 0, 500, 999, 1000}));
  EXPECT_EQ(rig->keptBack(), 0);
}

TEST_P(PenetrationStage, CompactsLikeTheOracleOnWorldsOfAnySize) {
  for (std::uint32_t seed = 0; seed < 8; ++seed) {
    constexpr std::pair<int, int> sizes[] = {{77, 131}, {1, 200}, {65, 1}, {130, 40}};
    const auto& [columns, rows] = sizes[seed % 4];
    ScenePack pack = noisePack(columns, rows, seed, -2000, 2000, seed % 3 == 0 ? 900 : 30000);
    pack.parameters = randomParameters(seed);
    pack.parameters.materials[0].compression_q16 = seed % 4 == 0 ? kOneQ16 : 19661;
    const World world(std::move(pack));
    const auto rig = makeStageRig(GetParam(), world);
    coverAtRandom(*rig, seed);
    DenseWorld dense = denseCopy(*rig);
    auto overlap = oracleOverlap(dense, world.pack.parameters.obstacle_threshold_q);
    const auto penetrating = std::ranges::count_if(overlap, [](std::int32_t value) { return value > 0; });
    oracleCompact(dense, overlap, world.pack.parameters, wholeWorld(dense));
    rig->penetration();
    SCOPED_TRACE("seed " + std::to_string(seed) + ": " + describe(world.pack.parameters));
    ASSERT_EQ(rig->overlap(), insideCells(dense, overlap));
    ASSERT_EQ(rig->height(), insideCells(dense, dense.height));
    ASSERT_EQ(rig->compacted(), insideCells(dense, dense.compacted));
    ASSERT_EQ(rig->penetratingCount(), penetrating);
  }
}

SPOOR_ON_EVERY_BACKEND(PenetrationStage);

TEST(Penetration, WhatIsPressedTogetherIsWithinTheOverlapAndTheLimit) {
  std::mt19937 engine(22);
  const auto pick = [&](int low, int high) { return low + int(engine() % std::uint32_t(high - low + 1)); };
  for (int round = 0; round < 20000; ++round) {
    const int range = round % 2 == 0 ? 3000 : rules::kHeightLimit;
    const int soil = pick(0, range), overlap = pick(1, std::max(soil, 1)), compacted = pick(0, range);
    const int compression = round % 3 == 0 ? kOneQ16 : pick(0, kOneQ16);
    const int limit_share = round % 5 == 0 ? 0 : round % 7 == 0 ? kOneQ16 : pick(0, kOneQ16);
    const int pressed = rules::compactedShare(overlap, soil, compacted, compression, limit_share);
    ASSERT_GE(pressed, 0);
    ASSERT_LE(pressed, overlap);
    ASSERT_LE(std::int64_t(compacted) + pressed, rules::kHeightLimit);
    if (limit_share == 0 || pressed == 0) continue;
    const std::int64_t column = std::int64_t(soil) + compacted;
    ASSERT_LE(std::int64_t(compacted) + pressed, std::int64_t(__int128(column) * limit_share / kOneQ16));
  }
}

TEST(Penetration, TheMoreOfAColumnIsPressedTogetherTheLessIsMore) {
  int before = INT32_MAX;
  for (int compacted = 0; compacted <= 5000; compacted += 10) {
    const int pressed = rules::compactedShare(1000, 5000 - compacted, compacted, kOneQ16 / 2, kOneQ16 / 2);
    ASSERT_LE(pressed, before) << compacted;
    before = pressed;
  }
  EXPECT_EQ(rules::compactedShare(1000, 5000, 0, kOneQ16 / 2, kOneQ16 / 2), 500);
  EXPECT_EQ(before, 0);
}

TEST(Penetration, AShareOfANumberIsTheFloorOfTheirProduct) {
  std::mt19937 engine(23);
  for (const int share : {0, 1, 3, 19661, 32768, 65535, 65536})
    for (int round = 0; round < 2000; ++round) {
      const int a = round == 0 ? INT32_MAX : round == 1 ? 65535 : int(engine() >> (1 + round % 31));
      ASSERT_EQ(rules::timesQ16(a, share), std::int64_t(a) * share / 65536) << a << " * " << share;
    }
}

TEST(Penetration, ABodyHigherThanTheFrustumAboveBedrockIsNotSeen) {
  EXPECT_EQ(rules::seenUnderside(500, -400, 900), 500);
  EXPECT_EQ(rules::seenUnderside(501, -400, 900), kNone);
  EXPECT_EQ(rules::seenUnderside(501, -400, 0), 501) << "no frustum";
  EXPECT_EQ(rules::seenUnderside(-rules::kHeightLimit, -rules::kHeightLimit, 1), -rules::kHeightLimit);
  EXPECT_EQ(rules::seenUnderside(kNone, -rules::kHeightLimit, 1), kNone);
}

}  // namespace
}  // namespace spoor::test
