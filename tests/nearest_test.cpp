// Stage nearest: the exact nearest free cell, ties included, against a search over all cells; jump flooding.
#include "shaders/rules/nearest.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "shaders/rules/flood.h"
#include "tests/stage_rig.h"

namespace spoor::test {
namespace {

constexpr int kHere = 1;  // a penetrating cell
constexpr int kFree = rules::kFree;
constexpr int kWall = rules::kObstacle;

class NearestStage : public OnEveryBackend {};

constexpr NearestSearch kSearches[] = {NearestSearch::exact,
                                       NearestSearch::jump_flooding,
                                       NearestSearch::jump_flooding_plus_1,
                                       NearestSearch::jump_flooding_plus_2,
                                       NearestSearch::one_plus_jump_flooding,
                                       NearestSearch::jump_flooding_squared};
constexpr Metric kMetrics[] = {Metric::euclidean, Metric::manhattan, Metric::chebyshev};

/// The targets of level ground whose undersides give these overlaps.
struct Search {
  Search(const BackendCase& backend_case, int columns, int rows, const Cells& wanted, const Parameters& method = {})
      : width(columns), height(rows), parameters(method), overlap(wanted) {
    ScenePack pack = flatPack(columns, rows);
    pack.parameters = method;
    const World world(std::move(pack));
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
  Parameters parameters;
  Cells overlap, target;
};

/// What the oracle finds on a dense world of these overlaps.
Cells expectedTargets(int columns, int rows, const Cells& overlap, const Parameters& parameters) {
  const ScenePack pack = flatPack(1, 1);
  DenseWorld dense{BaseTerrain(pack)};
  dense.columns = dense.inside_columns = columns;
  dense.rows = dense.inside_rows = rows;
  return oracleNearest(dense, overlap, parameters, wholeWorld(dense));
}

/// Every cell that searches by comparing with all free cells of the domain, or by flooding it.
void checkAgainstAllCells(const Search& search, const std::string& name) {
  const int columns = search.width, rows = search.height;
  const Cells expected = expectedTargets(columns, rows, search.overlap, search.parameters);
  const bool obstacles_too = search.parameters.displacement == Displacement::iterative;
  for (std::size_t i = 0; i < expected.size(); ++i)
    if (search.overlap[i] > 0 || (obstacles_too && search.overlap[i] == kWall)) {
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
  for (const NearestSearch method : {NearestSearch::exact, NearestSearch::one_plus_jump_flooding})
    checkAgainstAllCells(Search(backend_case, 401, 299, overlap, {.nearest = method}), "401 x 299");
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

/// The target of the corner cell of 5 x 5 walls with some free cells.
std::pair<int, int> fromTheCorner(const BackendCase& backend_case, Metric metric,
                                  std::initializer_list<std::pair<int, int>> free) {
  Cells overlap(25, kWall);
  overlap[0] = kHere;
  for (const auto& [x, y] : free) overlap[std::size_t(y * 5 + x)] = kFree;
  return Search(backend_case, 5, 5, overlap, {.metric = metric}).of(0, 0);
}

TEST_P(NearestStage, EveryMetricHasItsOwnNearestOnFiveByFiveCells) {
  const auto nearest = [&](Metric metric, std::initializer_list<std::pair<int, int>> free) {
    return fromTheCorner(GetParam(), metric, free);
  };
  // Squares of the distances 9 and 8, sums of the sides 3 and 4, longer sides 3 and 2.
  EXPECT_EQ(nearest(Metric::euclidean, {{3, 0}, {2, 2}}), std::pair(2, 2));
  EXPECT_EQ(nearest(Metric::manhattan, {{3, 0}, {2, 2}}), std::pair(3, 0));
  EXPECT_EQ(nearest(Metric::chebyshev, {{3, 0}, {2, 2}}), std::pair(2, 2));
  // 16 and 18, 4 and 6, 4 and 3.
  EXPECT_EQ(nearest(Metric::euclidean, {{4, 0}, {3, 3}}), std::pair(4, 0));
  EXPECT_EQ(nearest(Metric::manhattan, {{4, 0}, {3, 3}}), std::pair(4, 0));
  EXPECT_EQ(nearest(Metric::chebyshev, {{4, 0}, {3, 3}}), std::pair(3, 3));
}

TEST_P(NearestStage, EquallyNearOnesGoByEuclideanDistanceBeforeRowAndColumn) {
  EXPECT_EQ(fromTheCorner(GetParam(), Metric::manhattan, {{4, 0}, {2, 2}}), std::pair(2, 2));  // 4 and 4; 16 and 8
  EXPECT_EQ(fromTheCorner(GetParam(), Metric::chebyshev, {{3, 2}, {1, 3}}), std::pair(1, 3));  // 3 and 3; 13 and 10
  EXPECT_EQ(fromTheCorner(GetParam(), Metric::chebyshev, {{3, 2}, {2, 3}}), std::pair(3, 2));  // 13 and 13: the row
}

/// A row of eight cells of which 0 and 5 are free. By hand: step 4 brings 5 to cell 1 and 0 to cell 4; step 2 brings 0
/// to 2 and 6 and 5 to 3 and 7; with step 1 cells 1, 4 and 6 find the nearer of what their neighbours know.
TEST_P(NearestStage, FloodsARowOfEightCells) {
  const Cells overlap = {kFree, kHere, kHere, kHere, kHere, kFree, kHere, kHere};
  for (const NearestSearch method : kSearches) {
    const Search search(GetParam(), 8, 1, overlap, {.nearest = method});
    for (const auto& [x, target] : {std::pair{1, 0}, {2, 0}, {3, 5}, {4, 5}, {6, 5}, {7, 5}})
      EXPECT_EQ(search.of(x, 0), std::pair(target, 0)) << "cell " << x << ", search " << int(method);
  }
}

TEST_P(NearestStage, FloodingReachesEveryCellFromOneFreeCell) {
  Cells overlap(41 * 23, kHere);
  overlap[7 * 41 + 33] = kFree;
  const Search search(GetParam(), 41, 23, overlap, {.nearest = NearestSearch::jump_flooding});
  for (int y = 0; y < 23; ++y)
    for (int x = 0; x < 41; ++x)
      if (x != 33 || y != 7) {
        ASSERT_EQ(search.of(x, y), std::pair(33, 7)) << x << ", " << y;
      }
}

TEST_P(NearestStage, FloodingWithoutAFreeCellFindsNone) {
  const Search search(GetParam(), 9, 5, Cells(45, kHere), {.nearest = NearestSearch::jump_flooding_squared});
  for (const std::int32_t target : search.target) EXPECT_EQ(target, rules::kNoTarget);
}

TEST_P(NearestStage, EqualsTheOracleForEverySearchAndMetric) {
  std::mt19937 engine(34);
  constexpr std::pair<int, int> sizes[] = {{77, 53}, {1, 200}, {67, 130}, {131, 1}, {13, 7}};
  constexpr int free_per_mille[] = {500, 4, 30, 2};
  for (int round = 0; round < (GetParam().slow() ? 18 : 54); ++round) {
    const auto& [columns, rows] = sizes[round % 5];
    Parameters method{.nearest = kSearches[round % 6], .metric = kMetrics[round / 6 % 3]};
    if (round % 7 == 0) method.displacement = Displacement::iterative;
    Cells overlap;
    for (int i = 0; i < columns * rows; ++i)
      overlap.push_back(int(engine() % 1000) < free_per_mille[round % 4] ? kFree : engine() % 5 == 0 ? kWall : kHere);
    overlap[0] = kHere;
    ASSERT_NO_FATAL_FAILURE(checkAgainstAllCells(Search(GetParam(), columns, rows, overlap, method),
                                                 std::to_string(columns) + " x " + std::to_string(rows) + ", round " +
                                                     std::to_string(round) + ", " + describe(method)));
  }
}

/// A world on which each search finds something else than each other one, so that none passes for another.
TEST_P(NearestStage, EverySearchIsTheOneThatItSays) {
  std::mt19937 engine(194);
  Cells overlap;
  for (int i = 0; i < 31 * 33; ++i) overlap.push_back(engine() % 1000 < 10 ? kFree : kHere);
  for (const Metric metric : {Metric::euclidean, Metric::chebyshev}) {
    std::set<Cells> distinct;
    for (const NearestSearch method : kSearches) {
      const Parameters parameters{.nearest = method, .metric = metric};
      distinct.insert(expectedTargets(31, 33, overlap, parameters));
      checkAgainstAllCells(Search(GetParam(), 31, 33, overlap, parameters), describe(parameters));
    }
    EXPECT_EQ(distinct.size(), std::size(kSearches));
  }
}

SPOOR_ON_EVERY_BACKEND(NearestStage);

TEST(Nearest, FloodingErrsAndItsVariantsErrLess) {
  std::mt19937 engine(35);
  Cells overlap;
  for (int i = 0; i < 120 * 100; ++i) overlap.push_back(engine() % 10 == 0 ? kFree : kHere);
  std::vector<int> errors(std::size(kSearches), 0);  // of each search, over all metrics
  for (const Metric metric : kMetrics) {
    const auto distance = [&](std::size_t i, std::int32_t target) {
      return rules::metricDistance(target % 120 - int(i % 120), target / 120 - int(i / 120), int(metric));
    };
    const Cells exact = expectedTargets(120, 100, overlap, {.metric = metric});
    for (std::size_t search = 0; search < std::size(kSearches); ++search) {
      const Cells found = expectedTargets(120, 100, overlap, {.nearest = kSearches[search], .metric = metric});
      for (std::size_t i = 0; i < exact.size(); ++i)
        if (overlap[i] == kHere && distance(i, found[i]) > distance(i, exact[i])) ++errors[search];
    }
  }
  EXPECT_EQ(errors[0], 0);
  EXPECT_GT(errors[1], 0);
  for (std::size_t i = 2; i < errors.size(); ++i) EXPECT_LT(errors[i], errors[1]) << "search " << i;
}

TEST(Nearest, StepsOfFloodingHalveFromTheSmallestPowerOfTwoThatHoldsTheDomain) {
  using Steps = std::vector<int>;
  EXPECT_EQ(oracleFloodSteps(NearestSearch::jump_flooding, 8), (Steps{4, 2, 1}));
  EXPECT_EQ(oracleFloodSteps(NearestSearch::jump_flooding, 9), (Steps{8, 4, 2, 1}));
  EXPECT_EQ(oracleFloodSteps(NearestSearch::jump_flooding, 1), Steps{});
  EXPECT_EQ(oracleFloodSteps(NearestSearch::jump_flooding_plus_1, 5), (Steps{4, 2, 1, 1}));
  EXPECT_EQ(oracleFloodSteps(NearestSearch::jump_flooding_plus_2, 5), (Steps{4, 2, 1, 2, 1}));
  EXPECT_EQ(oracleFloodSteps(NearestSearch::one_plus_jump_flooding, 5), (Steps{1, 4, 2, 1}));
  EXPECT_EQ(oracleFloodSteps(NearestSearch::jump_flooding_squared, 5), (Steps{4, 2, 1, 4, 2, 1}));
}

TEST(Nearest, TheEightNeighboursRunOnceAroundTheCell) {
  constexpr int x[] = {1, 1, 0, -1, -1, -1, 0, 1}, y[] = {0, 1, 1, 1, 0, -1, -1, -1};
  for (int d = 0; d < 8; ++d) {
    EXPECT_EQ(rules::neighbourX(d), x[d]) << d;
    EXPECT_EQ(rules::neighbourY(d), y[d]) << d;
    EXPECT_EQ(rules::neighbourX(d ^ 4), -x[d]) << d;
    EXPECT_EQ(rules::neighbourY(d ^ 4), -y[d]) << d;
  }
}

TEST(Nearest, EveryOrderOfExaminationNamesEachNeighbourOnceAndAllOrdersOccur) {
  std::set<std::vector<int>> sequences;
  for (int order = 0; order < 32; ++order) {
    std::vector<int> sequence;
    for (int k = 0; k < 8; ++k) sequence.push_back(rules::floodNeighbour(order, k));
    EXPECT_EQ(std::set<int>(sequence.begin(), sequence.end()), (std::set<int>{0, 1, 2, 3, 4, 5, 6, 7})) << order;
    sequences.insert(std::move(sequence));
  }
  EXPECT_EQ(sequences.size(), 32u);
  std::set<int> orders;
  for (int i = 0; i < 400; ++i) orders.insert(rules::floodOrder(i % 20, i / 20));
  EXPECT_EQ(orders.size(), 32u);
}

TEST(Nearest, FloodingTakesWhatIsNearerAndKeepsWhatIsEquallyNear) {
  EXPECT_TRUE(rules::floodTakes(false, 0, 0, 9000, 9000, rules::kEuclidean));
  EXPECT_FALSE(rules::floodTakes(true, 3, 4, 5, 0, rules::kEuclidean));
  EXPECT_TRUE(rules::floodTakes(true, 3, 4, -4, 2, rules::kEuclidean));
  EXPECT_TRUE(rules::floodTakes(true, 3, 4, 5, 0, rules::kManhattan));
  EXPECT_FALSE(rules::floodTakes(true, 3, 4, 5, 0, rules::kChebyshev));
  EXPECT_TRUE(rules::floodTakes(true, 3, 4, 3, -3, rules::kChebyshev));
}

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
