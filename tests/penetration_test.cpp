// Stage penetration: which cells a body overlaps, and by how much.
#include "shaders/rules/penetration.h"

#include <gtest/gtest.h>

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

SPOOR_ON_EVERY_BACKEND(PenetrationStage);

}  // namespace
}  // namespace spoor::test
