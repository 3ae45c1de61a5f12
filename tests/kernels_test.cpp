// Every set of kernels that this processor runs, against plain loops over the rules.
#include "shared/base/kernels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <random>
#include <vector>

#include "shaders/rules/crater.h"
#include "shaders/rules/exchange.h"
#include "shaders/rules/mix.h"
#include "shaders/rules/nearest.h"
#include "shaders/rules/penetration.h"
#include "shaders/rules/raster.h"
#include "shared/world/parameters.h"

namespace spoor::test {
namespace {

using Cells = std::vector<std::int32_t>;
constexpr int kLongestRow = 130;

/// A row of cells that exchange soil, with what limits it or without.
struct ExchangeRow {
  Cells height, bedrock, underside, threshold;
  bool beneath, thresholds;

  ExchangeCells cells() {
    return {height.data(), bedrock.data(), beneath ? underside.data() : nullptr,
            thresholds ? threshold.data() : nullptr};
  }
  int room(std::size_t i) const {
    return beneath ? rules::roomBeneath(height[i], underside[i], 50) : rules::kHeightLimit;
  }
  int thresholdOf(std::size_t i, int all) const { return thresholds ? threshold[i] : all; }
};

class EveryKernels : public ::testing::TestWithParam<const Kernels*> {
 protected:
  const Kernels& kernels_ = *GetParam();
  std::mt19937 engine_{51};

  /// `count` numbers around zero, some of them at the ends of the range.
  Cells numbers(int count, int range) {
    Cells cells;
    for (int i = 0; i < count; ++i) {
      const auto kind = engine_() % 20;
      const int value = int(engine_() % std::uint32_t(2 * range + 1)) - range;
      cells.push_back(kind == 0 ? rules::kHeightLimit : kind == 1 ? -rules::kHeightLimit : value);
    }
    return cells;
  }
  /// Bedrock at or below the given heights.
  Cells below(const Cells& heights) {
    Cells bedrock;
    for (const int height : heights) bedrock.push_back(std::max(height - int(engine_() % 900), -rules::kHeightLimit));
    return bedrock;
  }
  ExchangeRow exchangeRow(int count, bool beneath, bool thresholds) {
    ExchangeRow row{numbers(count, 2000), {}, numbers(count, 3000), {}, beneath, thresholds};
    row.bedrock = below(row.height);
    for (int i = 0; i < count; ++i)
      row.threshold.push_back(engine_() % 4 == 0 ? kNeverSteep : 1 + int(engine_() % 900));
    return row;
  }
};

TEST_P(EveryKernels, HashOfATileIsTheSumOfItsCells) {
  for (const auto& [x0, y0] : {std::pair{0, 0}, {64, 128}, {(1 << 24) - 64, 640}}) {
    const Cells cells = numbers(rules::kTileCells, 1 << 20);
    std::uint64_t expected = 0;
    for (int i = 0; i < rules::kTileCells; ++i) {
      const rules::uint key = rules::cellKey(x0 + i % rules::kTileSize, y0 + i / rules::kTileSize, 0);
      expected += rules::cellMixLow(key, cells[std::size_t(i)]);
      expected += std::uint64_t(rules::cellMixHigh(key, cells[std::size_t(i)])) << 32;
    }
    EXPECT_EQ(kernels_.hashTile(cells.data(), x0, y0, 0), expected);
    EXPECT_NE(kernels_.hashTile(cells.data(), x0, y0, 1), expected) << "planes must differ";
  }
}

TEST_P(EveryKernels, SumsAndEndsOfRows) {
  for (int n = 0; n <= kLongestRow; ++n) {
    const Cells cells = numbers(n, 1 << 20);
    std::int64_t sum = 0;
    for (const int value : cells) sum += value;
    ASSERT_EQ(kernels_.sum(cells.data(), n), sum) << n;
    if (n == 0) continue;
    ASSERT_EQ(kernels_.lowest(cells.data(), n), *std::ranges::min_element(cells)) << n;
    ASSERT_EQ(kernels_.highest(cells.data(), n), *std::ranges::max_element(cells)) << n;
  }
}

TEST_P(EveryKernels, RowsOfACraterAreTheRule) {
  const auto drawn = [&](int low, int high) { return low + int(engine_() % std::uint32_t(high - low + 1)); };
  for (int round = 0; round < 3000; ++round) {
    const int crest = 1 + (drawn(0, rules::kCraterReachLimit / 2 - 1) >> drawn(0, 21));
    const int inner = round % 7 == 0 ? crest : drawn(0, crest);
    const auto shape = rules::craterShape(0, 0, inner, crest, drawn(0, rules::kCraterHeightLimit) >> drawn(0, 20),
                                          drawn(0, rules::kCraterHeightLimit) >> drawn(0, 20), drawn(0, 65535),
                                          round % 2 == 0 ? 0 : drawn(0, 65535), 0);
    const int count = drawn(0, kLongestRow), step = drawn(1, std::max(shape.outer / 20, 1));
    const int dx = drawn(-shape.outer - shape.outer / 4, shape.outer), dy = drawn(-shape.outer - 1, shape.outer + 1);
    Cells row(std::size_t(count), 77), expected;
    for (int i = 0; i < count; ++i) expected.push_back(rules::craterDisplacement(shape, dx + i * step, dy));
    kernels_.craterRow(shape, dx, step, dy, count, row.data());
    ASSERT_EQ(row, expected) << "crest " << crest << ", inner " << inner << ", from " << dx << ", " << dy << ", step "
                             << step;
  }
}

TEST_P(EveryKernels, LowersAlongARow) {
  for (int n = 0; n <= kLongestRow; ++n) {
    const Cells before = numbers(n, 50000);
    const int first = int(engine_() % 20000) - 10000, step = int(engine_() % 600) - 300,
              fraction = int(engine_() % 65536);
    Cells cells = before;
    kernels_.lowerAlong(cells.data(), n, first, step, fraction, -12000, 11000);
    for (int i = 0; i < n; ++i)
      ASSERT_EQ(cells[std::size_t(i)],
                std::min(before[std::size_t(i)], rules::triangleHeightAlong(first, step, fraction, i, -12000, 11000)))
          << "cell " << i << " of " << n;
  }
}

TEST_P(EveryKernels, OverlapOfARow) {
  for (int n = 0; n <= kLongestRow; ++n) {
    const Cells height = numbers(n, 1000), bedrock = below(height), underside = numbers(n, 1200),
                before = numbers(n, 1500);
    Cells overlap(std::size_t(n), 77);
    const int count =
        kernels_.overlap(height.data(), bedrock.data(), underside.data(), before.data(), n, 100, overlap.data());
    int expected_count = 0;
    for (std::size_t i = 0; i < std::size_t(n); ++i) {
      const int expected = rules::cellOverlap(height[i], bedrock[i], underside[i], before[i], 100);
      ASSERT_EQ(overlap[i], expected) << "cell " << i << " of " << n;
      expected_count += expected > 0 ? 1 : 0;
    }
    ASSERT_EQ(count, expected_count) << n;
  }
}

TEST_P(EveryKernels, NearestFreeRowOfEachColumn) {
  constexpr int kRows = 40;
  for (int n = 0; n <= kLongestRow; n += 1 + n / 20) {
    std::vector<Cells> overlap(kRows), nearest(kRows, Cells(std::size_t(n)));
    for (Cells& row : overlap)
      for (int i = 0; i < n; ++i) row.push_back(engine_() % 12 == 0 && i % 7 != 0 ? rules::kFree : int(engine_() % 2));
    Cells last(std::size_t(n), rules::kNoFreeRow);
    for (int y = 0; y < kRows; ++y)
      kernels_.carryFree(overlap[std::size_t(y)].data(), n, y, last.data(), nearest[std::size_t(y)].data());
    last.assign(std::size_t(n), rules::kNoFreeRow);
    for (int y = kRows - 1; y >= 0; --y)
      kernels_.mergeFree(overlap[std::size_t(y)].data(), n, y, last.data(), nearest[std::size_t(y)].data());
    for (int y = 0; y < kRows; ++y)
      for (int i = 0; i < n; ++i) {
        int expected = rules::kNoFreeRow;
        for (int free = 0; free < kRows; ++free)
          if (overlap[std::size_t(free)][std::size_t(i)] == rules::kFree && std::abs(free - y) < std::abs(expected - y))
            expected = free;
        ASSERT_EQ(nearest[std::size_t(y)][std::size_t(i)], expected) << "column " << i << " of " << n << ", row " << y;
      }
  }
}

/// What one pair becomes; true if any soil moved.
bool exchangeByRule(ExchangeRow& a, std::size_t i, ExchangeRow& b, std::size_t j, int threshold) {
  int &height_a = a.height[i], &height_b = b.height[j];
  const int flow = rules::pairFlow(height_a, height_b, a.thresholdOf(i, threshold), b.thresholdOf(j, threshold),
                                   height_a - a.bedrock[i], height_b - b.bedrock[j], a.room(i), b.room(j));
  height_a -= flow;
  height_b += flow;
  return flow != 0;
}

TEST_P(EveryKernels, ExchangesBetweenTwoRows) {
  for (int n = 0; n <= kLongestRow; ++n)
    for (const bool beneath : {false, true})
      for (const bool thresholds : {false, true}) {
        ExchangeRow a = exchangeRow(n, beneath, thresholds), b = exchangeRow(n, beneath, thresholds);
        ExchangeRow expected_a = a, expected_b = b;
        const int threshold = n % 3 == 0 ? 100000000 : 300;  // with the large one only cells at the ends move
        bool moved = false;
        for (std::size_t i = 0; i < std::size_t(n); ++i)
          moved |= exchangeByRule(expected_a, i, expected_b, i, threshold);
        const bool reported = kernels_.exchangeRows(a.cells(), b.cells(), n, {threshold, 50});
        ASSERT_EQ(a.height, expected_a.height) << n << (beneath ? " beneath" : "") << (thresholds ? " by cell" : "");
        ASSERT_EQ(b.height, expected_b.height) << n << (beneath ? " beneath" : "") << (thresholds ? " by cell" : "");
        ASSERT_EQ(reported, moved) << n << (beneath ? " beneath" : "") << (thresholds ? " by cell" : "");
      }
}

TEST_P(EveryKernels, ExchangesWithinARow) {
  for (int pairs = 0; pairs <= rules::kTileSize / 2; ++pairs)
    for (const bool beneath : {false, true})
      for (const bool thresholds : {false, true}) {
        // One more cell may be read, and none but the pairs' may change.
        ExchangeRow row = exchangeRow(2 * pairs + 2, beneath, thresholds), expected = row;
        bool moved = false;
        for (std::size_t i = 0; i < std::size_t(2 * pairs); i += 2)
          moved |= exchangeByRule(expected, i, expected, i + 1, 300);
        const bool reported = kernels_.exchangeWithin(row.cells(), pairs, {300, 50});
        ASSERT_EQ(row.height, expected.height)
            << pairs << (beneath ? " beneath" : "") << (thresholds ? " by cell" : "");
        ASSERT_EQ(reported, moved) << pairs << (beneath ? " beneath" : "") << (thresholds ? " by cell" : "");
      }
}

INSTANTIATE_TEST_SUITE_P(Available, EveryKernels,
                         ::testing::ValuesIn(availableKernels().begin(), availableKernels().end()),
                         [](const auto& set) { return std::string(set.param->name); });

TEST(Kernels, BaselineIsAlwaysThereAndTheFastestIsTheLast) {
  ASSERT_FALSE(availableKernels().empty());
  EXPECT_STREQ(availableKernels().front()->name, "baseline");
  EXPECT_EQ(&kernels(), availableKernels().back());
  for (const char* name : {"avx2", "avx512"}) {
    const bool there =
        std::ranges::any_of(availableKernels(), [name](const Kernels* set) { return set->name == std::string(name); });
    if (!there) std::cout << "this processor does not run the " << name << " kernels: not tested\n";
  }
}

}  // namespace
}  // namespace spoor::test
