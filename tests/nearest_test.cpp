// Stage nearest: the exact nearest free cell, ties included, against a search over all cells.
#include "shaders/rules/nearest.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/stage_rig.h"

namespace spoor::test {
namespace {

constexpr int kHere = 1;  // a penetrating cell
constexpr int kFree = rules::kFree;
constexpr int kWall = rules::kObstacle;

class NearestStage : public OnEveryBackend {};

/// The targets of level ground whose undersides give these overlaps.
struct Search {
  Search(const BackendCase& backend_case, int columns, int rows, const Cells& wanted)
      : width(columns), height(rows), overlap(wanted) {
    const World world(flatPack(columns, rows));
    const auto rig = makeStageRig(backend_case, world);
    Cells underside;
    for (const std::int32_t value : wanted)
      underside.push_back(value == kFree ? rules::kNoUnderside : value == kWall ? 0 : -value);
    rig->setUnderside(underside);
    rig->penetration();
    EXPECT_EQ(rig->overlap(), wanted);
    rig->nearest();
    target = rig->target();
  }

  /// The target of one cell as (x, y).
  std::pair<int, int> of(int x, int y) const {
    const int found = target[std::size_t(y * width + x)];
    return found == rules::kNoTarget ? std::pair{-1, -1} : std::pair{found % width, found / width};
  }

  int width, height;
  Cells overlap, target;
};

/// Every cell of a domain by comparing with all of its free cells.
void checkAgainstAllCells(const Search& search, const std::string& name) {
  const int columns = search.width, rows = search.height;
  const ScenePack pack = flatPack(1, 1);
  DenseWorld dense{BaseTerrain(pack)};
  dense.columns = dense.inside_columns = columns;
  dense.rows = dense.inside_rows = rows;
  const auto expected = oracleNearest(dense, search.overlap, {}, wholeWorld(dense));
  for (std::size_t i = 0; i < expected.size(); ++i)
    if (search.overlap[i] > 0) {
      ASSERT_EQ(search.target[i], expected[i]) << name << ", cell " << int(i) % columns << ", " << int(i) / columns;
    }
}

TEST_P(NearestStage, FiveByFiveCells) {
  const Search search(GetParam(), 5, 5, {kFree, kWall, kHere, kHere, kFree,  //
                                         kWall, kHere, kHere, kHere, kHere,  //
                                         kHere, kHere, kHere, kWall, kHere,  //
                                         kHere, kHere, kWall, kFree, kHere,  //
                                         kFree, kHere, kHere, kHere, kHere});
  EXPECT_EQ(search.of(3, 0), std::pair(4, 0));
  EXPECT_EQ(search.of(2, 0), std::pair(0, 0));  // as near as (4, 0): the lower column
  EXPECT_EQ(search.of(1, 1), std::pair(0, 0));
  EXPECT_EQ(search.of(2, 1), std::pair(0, 0));  // 5 to (0, 0), to (4, 0) and to (3, 3)
  EXPECT_EQ(search.of(4, 1), std::pair(4, 0));
  EXPECT_EQ(search.of(2, 2), std::pair(3, 3));
  EXPECT_EQ(search.of(0, 2), std::pair(0, 0));  // as near as (0, 4): the lower row
  EXPECT_EQ(search.of(1, 3), std::pair(0, 4));
  EXPECT_EQ(search.of(4, 4), std::pair(3, 3));
}

TEST_P(NearestStage, TiesGoToTheLowerRowThenTheLowerColumn) {
  std::vector<std::int32_t> overlap(49, kHere);
  const auto cell = [&](int x, int y) -> std::int32_t& { return overlap[std::size_t(y * 7 + x)]; };
  for (const auto& [x, y] : {std::pair{3, 0}, {0, 3}, {6, 3}, {3, 6}}) cell(x, y) = kFree;
  EXPECT_EQ(Search(GetParam(), 7, 7, overlap).of(3, 3), std::pair(3, 0));
  cell(3, 0) = kHere;
  EXPECT_EQ(Search(GetParam(), 7, 7, overlap).of(3, 3), std::pair(0, 3));
  cell(0, 3) = kHere;
  EXPECT_EQ(Search(GetParam(), 7, 7, overlap).of(3, 3), std::pair(6, 3));
  cell(6, 3) = kHere;
  EXPECT_EQ(Search(GetParam(), 7, 7, overlap).of(3, 3), std::pair(3, 6));
}

TEST_P(NearestStage, WithoutAFreeCellThereIsNoTarget) {
  const Search search(GetParam(), 5, 3, std::vector<std::int32_t>(15, kHere));
  for (const std::int32_t target : search.target) EXPECT_EQ(target, rules::kNoTarget);
}

TEST_P(NearestStage, ReachesFarAcrossColumnsWithoutAFreeCell) {
  std::vector<std::int32_t> overlap(200 * 3, kHere);
  overlap[200 + 199] = kFree;
  const Search search(GetParam(), 200, 3, overlap);
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 200; ++x)
      if (x != 199 || y != 1) {
        ASSERT_EQ(search.of(x, y), std::pair(199, 1)) << x << ", " << y;
      }
}

TEST_P(NearestStage, EqualsASearchOverAllCellsForEveryDensity) {
  std::mt19937 engine(31);
  for (const auto& [columns, rows] : {std::pair{77, 53}, {1, 200}, {131, 1}, {65, 64}, {13, 7}})
    for (const int free_per_mille : {1, 10, 100, 500})
      for (int round = 0; round < 4; ++round) {
        std::vector<std::int32_t> overlap;
        for (int i = 0; i < columns * rows; ++i)
          overlap.push_back(int(engine() % 1000) < free_per_mille ? kFree : engine() % 5 == 0 ? kWall : kHere);
        checkAgainstAllCells(
            Search(GetParam(), columns, rows, overlap),
            std::to_string(columns) + " x " + std::to_string(rows) + ", free " + std::to_string(free_per_mille));
      }
}

TEST_P(NearestStage, EqualsASearchOverAllCellsWhenSharedOutBetweenThreads) {
  std::mt19937 engine(33);
  std::vector<std::int32_t> overlap;
  for (int i = 0; i < 401 * 299; ++i)
    overlap.push_back(engine() % 400 == 0 ? kFree : engine() % 5 == 0 ? kWall : kHere);
  BackendCase backend_case = GetParam();
  backend_case.thread_count = 4;
  checkAgainstAllCells(Search(backend_case, 401, 299, overlap), "401 x 299");
}

TEST_P(NearestStage, EqualsASearchOverAllCellsAcrossLongDistances) {
  // One free cell at each end of neighbouring columns: where the columns change places lies far outside the row.
  std::vector<std::int32_t> overlap(4 * 1500, kHere);
  overlap[0] = overlap[4 * 1499 + 1] = overlap[4 * 700 + 3] = kFree;
  checkAgainstAllCells(Search(GetParam(), 4, 1500, overlap), "4 x 1500");
}

TEST_P(NearestStage, EqualsASearchOverAllCellsAroundRoundAndSquareShapes) {
  for (const int radius : {5, 20, 31})
    for (const bool round : {true, false}) {
      const int size = 2 * radius + 3, middle = radius + 1;
      std::vector<std::int32_t> overlap(std::size_t(size * size), kFree);
      for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
          const int dx = x - middle, dy = y - middle;
          const bool in = round ? dx * dx + dy * dy <= radius * radius : std::max(std::abs(dx), std::abs(dy)) <= radius;
          if (in) overlap[std::size_t(y * size + x)] = kHere;
        }
      checkAgainstAllCells(Search(GetParam(), size, size, overlap),
                           (round ? "disc " : "square ") + std::to_string(radius));
    }
}

SPOOR_ON_EVERY_BACKEND(NearestStage);

TEST(Nearest, TheSwitchBetweenTwoColumnsIsTheFirstPlaceWhereTheSecondIsBefore) {
  std::mt19937 engine(32);
  const auto pick = [&](int range) { return int(engine() % std::uint32_t(range)); };
  for (int round = 0; round < 20000; ++round) {
    const int range = round % 2 == 0 ? 12 : 16384;
    const int ax = pick(range - 1), bx = ax + 1 + pick(range - 1 - ax), ay = pick(range), by = pick(range),
              y = pick(range);
    const int at = rules::nearestSwitch(y, ax, ay, bx, by);
    if (std::abs(at) > 16384) continue;  // outside every row
    ASSERT_TRUE(rules::nearestBefore(at, y, bx, by, ax, ay, rules::kEuclidean)) << "round " << round;
    ASSERT_TRUE(rules::nearestBefore(at - 1, y, ax, ay, bx, by, rules::kEuclidean)) << "round " << round;
  }
}

}  // namespace
}  // namespace spoor::test
