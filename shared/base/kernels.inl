// The bodies of kernels.h, compiled once per instruction set with SPOOR_KERNELS_NAME set. Nothing but rule headers and
// plain loops in here: a template or an inline function of the standard library, compiled for a newer processor, could
// be the copy that the linker keeps for everyone.
#include "shaders/rules/crater.h"
#include "shaders/rules/exchange.h"
#include "shaders/rules/mix.h"
#include "shaders/rules/nearest.h"
#include "shaders/rules/penetration.h"
#include "shaders/rules/raster.h"
#include "shaders/rules/slope.h"
#include "shared/base/kernels.h"

namespace spoor {
namespace {

using std::int32_t;
using std::int64_t;
using std::uint64_t;

template <bool kSparse>
inline uint64_t hashCells(const int32_t* cells, int x, int y, int plane) {
  uint64_t low_sum = 0;
  uint64_t high_sum = 0;
  for (int row = 0; row < rules::kTileSize; ++row) {
    // 64 values below 2^16 each: halves of the lanes are summed in 32 bits, which keeps the loop 32 bits wide.
    uint32_t low_a = 0, low_b = 0, high_a = 0, high_b = 0;
    const rules::uint row_key = rules::mix32(rules::uint(y + row) * 0x85ebca77u + rules::uint(plane));
    for (int i = 0; i < rules::kTileSize; ++i) {
      const rules::uint key = rules::mix32(rules::uint(x + i) * 0x9e3779b1u + row_key);
      const int32_t value = cells[row * rules::kTileSize + i];
      const rules::uint counts = kSparse && value == 0 ? 0u : ~0u;
      const rules::uint low = rules::cellMixLow(key, value) & counts;
      const rules::uint high = rules::cellMixHigh(key, value) & counts;
      low_a += low & 0xffffu;
      low_b += low >> 16;
      high_a += high & 0xffffu;
      high_b += high >> 16;
    }
    low_sum += low_a + (uint64_t(low_b) << 16);
    high_sum += high_a + (uint64_t(high_b) << 16);
  }
  return low_sum + (high_sum << 32);
}

uint64_t hashTile(const int32_t* cells, int x, int y, int plane) { return hashCells<false>(cells, x, y, plane); }
uint64_t hashSparseTile(const int32_t* cells, int x, int y, int plane) { return hashCells<true>(cells, x, y, plane); }

int64_t sum(const int32_t* cells, int n) {
  int64_t total = 0;
  for (int i = 0; i < n; ++i) total += cells[i];
  return total;
}

int32_t lowest(const int32_t* cells, int n) {
  int32_t result = cells[0];
  for (int i = 1; i < n; ++i) result = rules::minInt(result, cells[i]);
  return result;
}

int32_t highest(const int32_t* cells, int n) {
  int32_t result = cells[0];
  for (int i = 1; i < n; ++i) result = rules::maxInt(result, cells[i]);
  return result;
}

/// Flat: a rule that stays a call would keep the loop from being vectorised.
template <bool kInside, bool kNoise>
[[gnu::flatten]] void craterCells(const rules::CraterShape& shape, int dx, int step, int dy, int n,
                                  int32_t* __restrict displacement) {
  const rules::CraterShape own = shape;
  const int64_t dy_square = int64_t(dy) * dy, crest_square = int64_t(own.crest) * own.crest;
  for (int i = 0; i < n; ++i) {
    const int x = dx + i * step;
    const int64_t square = int64_t(x) * x + dy_square;
    const rules::CraterPlace place =
        kInside ? rules::placeInside(own, square) : rules::placeOutside(own, square, square - crest_square);
    displacement[i] = rules::craterLift(own, x, dy, place, kInside, kNoise);
  }
}

template <bool kInside>
void craterZone(const rules::CraterShape& shape, int dx, int step, int dy, int begin, int end, int32_t* displacement) {
  const auto cells = shape.amplitude > 0 ? craterCells<kInside, true> : craterCells<kInside, false>;
  cells(shape, dx + begin * step, step, dy, end - begin, displacement + begin);
}

/// A row cuts a disc in one piece, so its cells are outside, in the outer zone, inside, and the same backwards.
void craterRow(const rules::CraterShape& shape, int dx, int step, int dy, int n, int32_t* displacement) {
  const int64_t dy_square = int64_t(dy) * dy;
  const int64_t outer_square = int64_t(shape.outer) * shape.outer, crest_square = int64_t(shape.crest) * shape.crest;
  const auto square = [&](int i) { return int64_t(dx + i * step) * (dx + i * step) + dy_square; };
  int outer_begin = 0, outer_end = n;
  while (outer_begin < n && square(outer_begin) > outer_square) displacement[outer_begin++] = 0;
  while (outer_end > outer_begin && square(outer_end - 1) > outer_square) displacement[--outer_end] = 0;
  int begin = outer_begin, end = outer_end;
  while (begin < end && square(begin) >= crest_square) ++begin;
  while (end > begin && square(end - 1) >= crest_square) --end;
  craterZone<false>(shape, dx, step, dy, outer_begin, begin, displacement);
  craterZone<true>(shape, dx, step, dy, begin, end, displacement);
  craterZone<false>(shape, dx, step, dy, end, outer_end, displacement);
}

void snowRow(rules::uint seed, int x, int step, int y, int n, const rules::SnowDepth& fallen,
             int32_t* __restrict depth) {
  const rules::SnowDepth own = fallen;
  for (int i = 0; i < n; ++i) depth[i] += rules::snowOn(seed, x + i * step, y, own);
}

void lowerAlong(int32_t* __restrict underside, int n, int first, int step, int step_fraction, int lowest, int highest) {
  for (int i = 0; i < n; ++i)
    underside[i] =
        rules::minInt(underside[i], rules::triangleHeightAlong(first, step, step_fraction, i, lowest, highest));
}

void hideAbove(int32_t* __restrict underside, const int32_t* bedrock, int n, int frustum_height) {
  for (int i = 0; i < n; ++i) underside[i] = rules::seenUnderside(underside[i], bedrock[i], frustum_height);
}

int overlap(const int32_t* height, const int32_t* bedrock, const int32_t* underside, const int32_t* underside_before,
            int n, int obstacle_threshold, int32_t* __restrict out) {
  int count = 0;
  for (int i = 0; i < n; ++i) {
    const int32_t value =
        rules::cellOverlap(height[i], bedrock[i], underside[i], underside_before[i], obstacle_threshold);
    out[i] = value;
    count += value > 0 ? 1 : 0;
  }
  return count;
}

void carryFree(const int32_t* overlap, int n, int y, int32_t* __restrict last_free, int32_t* __restrict out) {
  for (int i = 0; i < n; ++i) {
    const int32_t free = overlap[i] == rules::kFree ? y : last_free[i];
    last_free[i] = free;
    out[i] = free;
  }
}

void mergeFree(const int32_t* overlap, int n, int y, int32_t* __restrict last_free, int32_t* __restrict out) {
  for (int i = 0; i < n; ++i) {
    const int32_t above = overlap[i] == rules::kFree ? y : last_free[i];
    last_free[i] = above;
    out[i] = rules::nearestInColumn(y, out[i], above);
  }
}

/// A cell of those that exchange, as pairFlow sees it.
struct Exchanged {
  int32_t height, soil, room, threshold;
};

template <bool kBeneath>
inline Exchanged exchanged(int32_t height, int32_t bedrock, int32_t underside, int32_t threshold,
                           int obstacle_threshold) {
  return {height, height - bedrock,
          kBeneath ? rules::roomBeneath(height, underside, obstacle_threshold) : rules::kHeightLimit, threshold};
}

inline int32_t flowOf(const Exchanged& a, const Exchanged& b) {
  return rules::pairFlow(a.height, b.height, a.threshold, b.threshold, a.soil, b.soil, a.room, b.room);
}

template <bool kBeneath, bool kMixed>
bool exchangeRowsOf(const ExchangeCells& cells_a, const ExchangeCells& cells_b, int n, const ExchangeNumbers& numbers) {
  int32_t* __restrict a = cells_a.height;
  int32_t* __restrict b = cells_b.height;
  const int32_t *bedrock_a = cells_a.bedrock, *bedrock_b = cells_b.bedrock;
  const int32_t *underside_a = cells_a.underside, *underside_b = cells_b.underside;
  const int32_t *threshold_a = cells_a.threshold, *threshold_b = cells_b.threshold;
  const int threshold = numbers.threshold, obstacle = numbers.obstacle_threshold;
  int moved = 0;
#pragma GCC ivdep  // seven pointers are more than GCC would tell apart at run time
  for (int i = 0; i < n; ++i) {
    const int32_t flow = flowOf(exchanged<kBeneath>(a[i], bedrock_a[i], kBeneath ? underside_a[i] : 0,
                                                    kMixed ? threshold_a[i] : threshold, obstacle),
                                exchanged<kBeneath>(b[i], bedrock_b[i], kBeneath ? underside_b[i] : 0,
                                                    kMixed ? threshold_b[i] : threshold, obstacle));
    a[i] -= flow;
    b[i] += flow;
    moved |= flow;
  }
  return moved != 0;
}

// Flows between all neighbours, those of the other parity masked out: twice the arithmetic of the pairs alone, but in
// consecutive lanes, which is faster than taking pairs apart and putting them together.
template <bool kBeneath, bool kMixed>
bool exchangeWithinOf(const ExchangeCells& cells, int pair_count, const ExchangeNumbers& numbers) {
  constexpr int kMost = rules::kTileSize;
  int32_t* __restrict height = cells.height;
  const int32_t *bedrock = cells.bedrock, *underside = cells.underside, *thresholds = cells.threshold;
  const int threshold = numbers.threshold, obstacle = numbers.obstacle_threshold;
  const auto at = [=](int i) {
    return exchanged<kBeneath>(height[i], bedrock[i], kBeneath ? underside[i] : 0, kMixed ? thresholds[i] : threshold,
                               obstacle);
  };
  int32_t flow[kMost + 1];
  int moved = 0;
  flow[0] = 0;
  for (int i = 0; i < 2 * pair_count; ++i) {
    const int32_t f = flowOf(at(i), at(i + 1)) & ((i & 1) - 1);
    flow[i + 1] = f;
    moved |= f;
  }
  for (int i = 0; i < 2 * pair_count; ++i) height[i] += flow[i] - flow[i + 1];
  return moved != 0;
}

bool exchangeRows(const ExchangeCells& a, const ExchangeCells& b, int n, const ExchangeNumbers& numbers) {
  if (a.underside == nullptr)
    return a.threshold == nullptr ? exchangeRowsOf<false, false>(a, b, n, numbers)
                                  : exchangeRowsOf<false, true>(a, b, n, numbers);
  return a.threshold == nullptr ? exchangeRowsOf<true, false>(a, b, n, numbers)
                                : exchangeRowsOf<true, true>(a, b, n, numbers);
}

bool exchangeWithin(const ExchangeCells& cells, int pair_count, const ExchangeNumbers& numbers) {
  if (cells.underside == nullptr)
    return cells.threshold == nullptr ? exchangeWithinOf<false, false>(cells, pair_count, numbers)
                                      : exchangeWithinOf<false, true>(cells, pair_count, numbers);
  return cells.threshold == nullptr ? exchangeWithinOf<true, false>(cells, pair_count, numbers)
                                    : exchangeWithinOf<true, true>(cells, pair_count, numbers);
}

void slopeCells(const int32_t* height, const int32_t* bedrock, const int32_t* underside, int n, int obstacle_threshold,
                int32_t* __restrict height_there, int32_t* __restrict room, int32_t* __restrict soil) {
  for (int i = 0; i < n; ++i) {
    const int32_t value = height[i];
    height_there[i] = value;
    room[i] = rules::roomBeneath(value, underside[i], obstacle_threshold);
    soil[i] = value - bedrock[i];
  }
}

bool slopeAmounts(const SlopeRow& above, const SlopeRow& row, const SlopeRow& below, int begin, int end) {
  constexpr int kMost = SlopeRow::kMostCells + 2 * SlopeRow::kHalo;
  const int n = end - begin;
  const int32_t* const height[3] = {above.height + begin, row.height + begin, below.height + begin};
  const int32_t* const room[3] = {above.room + begin, row.room + begin, below.room + begin};
  const int32_t* soil = row.soil + begin;
  const int32_t* threshold = row.threshold + begin;
  const int32_t* roughness = row.roughness + begin;
  int32_t* __restrict amount = row.amount + begin;
  int32_t drops[kMost], counts[kMost];
  int any = 0;
  for (int i = 0; i < n; ++i) {
    int sum = 0, count = 0;
    for (int d = 0; d < 8; ++d) {
      const int j = i + rules::neighbourX(d), line = 1 + rules::neighbourY(d);
      const int drop = height[1][i] - height[line][j], room_there = room[line][j];
      const bool gives = rules::slopeGives(drop, threshold[i], room_there);
      sum += gives ? rules::minInt(drop, rules::kDifferenceMost) : 0;
      count += gives ? 1 : 0;
    }
    drops[i] = sum;
    counts[i] = count;
    any |= count;
  }
  if (any == 0) {
    for (int i = 0; i < n; ++i) amount[i] = 0;
    return false;
  }
  for (int i = 0; i < n; ++i) amount[i] = rules::slopeAmount(drops[i], counts[i], roughness[i], soil[i]);
  return true;
}

// Every edge once: those along the row, and those down from it.
template <typename SideFlow, typename DiagonalFlow>
inline void flowsOfRow(const SlopeRow& row, const SlopeRow& below, int n, int32_t* __restrict carry,
                       int32_t* __restrict out, SideFlow side, DiagonalFlow diagonal) {
  constexpr int kMost = SlopeRow::kMostCells + 2;
  int32_t east[kMost], south[kMost], south_east[kMost], south_west[kMost];  // [cell + 1]
  for (int i = -1; i < n; ++i) east[i + 1] = side(row, i, row, i + 1);
  for (int i = 0; i < n; ++i) south[i + 1] = side(row, i, below, i);
  for (int i = -1; i < n; ++i) south_east[i + 1] = diagonal(row, i, below, i + 1);
  for (int i = 0; i <= n; ++i) south_west[i + 1] = diagonal(row, i, below, i - 1);
  for (int i = 0; i < n; ++i) {
    const int32_t change = carry[i] + east[i] - east[i + 1] - south[i + 1] - south_east[i + 1] - south_west[i + 1];
    out[i] = row.height[i] + change;
    carry[i] = south[i + 1] + south_east[i] + south_west[i + 2];
  }
}

inline int32_t averageFlow(const SlopeRow& from, int i, const SlopeRow& to, int j) {
  // All is read first: a load that hangs on a condition keeps the loop from being vectorised.
  const int drop = from.height[i] - to.height[j], room = to.room[j], amount = from.amount[i];
  const int threshold = from.threshold[i];
  const int flow = rules::slopeFlow(amount, room);
  return rules::slopeGives(drop, threshold, room) ? flow : 0;
}

void averageFlows(const SlopeRow& row, const SlopeRow& below, int n, int32_t* carry, int32_t* out) {
  const auto flow = [](const SlopeRow& a, int i, const SlopeRow& b, int j) {
    return averageFlow(a, i, b, j) - averageFlow(b, j, a, i);
  };
  flowsOfRow(row, below, n, carry, out, flow, flow);
}

void fluxFlows(const SlopeRow& row, const SlopeRow& below, int n, int32_t* carry, int32_t* out) {
  const auto flowOver = [](auto threshold) {
    return [threshold](const SlopeRow& a, int i, const SlopeRow& b, int j) {
      return rules::slopeFlux(a.height[i], b.height[j], (a.*threshold)[i], (b.*threshold)[j], a.roughness[i],
                              b.roughness[j], a.soil[i], b.soil[j], a.room[i], b.room[j]);
    };
  };
  flowsOfRow(row, below, n, carry, out, flowOver(&SlopeRow::threshold), flowOver(&SlopeRow::diagonal_threshold));
}

template <int kWeights>
[[gnu::flatten]] void driftFlowsOf(const SlopeRow& row, const SlopeRow& below, int n, const rules::DriftStep& all,
                                   int x, int y, rules::uint phase, int32_t* __restrict carry,
                                   int32_t* __restrict out) {
  rules::DriftStep step = all;
  step.weights = kWeights;
  const auto cellOf = [](const SlopeRow& of, int i) {
    return rules::DriftCell{of.height[i],    of.soil[i],      of.room[i],
                            of.threshold[i], of.roughness[i], rules::uint(of.amount[i])};
  };
  int32_t east[SlopeRow::kMostCells + 1];  // [cell + 1]
  for (int i = -1; i < n; ++i)
    east[i + 1] = rules::driftFlow(step, cellOf(row, i), cellOf(row, i + 1), (row.push_x[i] + row.push_x[i + 1]) >> 1,
                                   rules::driftDither(x + i, y, 0, phase));
  for (int i = 0; i < n; ++i) {
    const int32_t south =
        rules::driftFlow(step, cellOf(row, i), cellOf(below, i), (row.push_y[i] + below.push_y[i]) >> 1,
                         rules::driftDither(x + i, y, 1, phase));
    out[i] = row.height[i] + carry[i] + east[i] - east[i + 1] - south;
    carry[i] = south;
  }
}

void driftFlows(const SlopeRow& row, const SlopeRow& below, int n, const rules::DriftStep& step, int x, int y,
                rules::uint phase, int32_t* carry, int32_t* out) {
  const auto flows = step.weights == rules::kDriftUnweighted       ? driftFlowsOf<rules::kDriftUnweighted>
                     : step.weights == rules::kDriftByDisplacement ? driftFlowsOf<rules::kDriftByDisplacement>
                                                                   : driftFlowsOf<rules::kDriftBySlope>;
  flows(row, below, n, step, x, y, phase, carry, out);
}

void scatterFlows(const SlopeRow& above, const SlopeRow& row, const SlopeRow& below, int n, int32_t* const change[3]) {
  const SlopeRow* const rows[3] = {&above, &row, &below};
  int32_t lost[SlopeRow::kMostCells] = {};
  for (int d = 0; d < 8; ++d) {
    const int dx = rules::neighbourX(d), line = 1 + rules::neighbourY(d);
    const SlopeRow& to = *rows[line];
    int32_t* __restrict gained = change[line] + dx;
    for (int i = 0; i < n; ++i) {
      const int32_t flow = averageFlow(row, i, to, i + dx);
      lost[i] += flow;
      gained[i] += flow;
    }
  }
  for (int i = 0; i < n; ++i) change[1][i] -= lost[i];
}

}  // namespace

#define SPOOR_TEXT2(x) #x
#define SPOOR_TEXT(x) SPOOR_TEXT2(x)
#define SPOOR_JOIN2(a, b) a##b
#define SPOOR_JOIN(a, b) SPOOR_JOIN2(a, b)

extern const Kernels SPOOR_JOIN(kKernels_, SPOOR_KERNELS_NAME);
const Kernels SPOOR_JOIN(kKernels_, SPOOR_KERNELS_NAME) = {SPOOR_TEXT(SPOOR_KERNELS_NAME),
                                                           hashTile,
                                                           hashSparseTile,
                                                           sum,
                                                           lowest,
                                                           highest,
                                                           craterRow,
                                                           snowRow,
                                                           lowerAlong,
                                                           hideAbove,
                                                           overlap,
                                                           carryFree,
                                                           mergeFree,
                                                           exchangeRows,
                                                           exchangeWithin,
                                                           slopeCells,
                                                           slopeAmounts,
                                                           averageFlows,
                                                           fluxFlows,
                                                           driftFlows,
                                                           scatterFlows};

}  // namespace spoor
