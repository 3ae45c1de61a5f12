// Stage relax: sweeps of edge-coloured pair exchange over all active tiles.
//
// A sweep is eight matchings, one after the other. Within a row each matching only needs the row, or the row and its
// partner, to have done all matchings before it; so rows advance as far as their neighbours let them, in one pass
// through memory for several sweeps, and every pair still sees exactly the steps of the plain order. Bands of 64 rows
// advance in parallel up to their borders; then the borders are finished, in parallel too.
#include <algorithm>
#include <atomic>

#include "shaders/rules/exchange.h"
#include "shared/base/assert.h"
#include "shared/sim/native_stages.h"

namespace spoor {
namespace {

constexpr int kSize = rules::kTileSize;
constexpr int kSteps = rules::kMatchingCount;  // per sweep
// A band's border holds back up to 6 rows per sweep on either side; they must stay within half a band.
constexpr int kSweepsAtOnce = 5;
static_assert(6 * kSweepsAtOnce <= kSize / 2);

class Relaxation {
 public:
  Relaxation(const NativeContext& context, bool skip_settled)
      : context_(context),
        area_(context.area),
        skip_settled_(skip_settled),
        progress_(context.area.bands.size() * kSize),
        row_change_(progress_.size()) {
    for (std::size_t row = 0; row < row_change_.size(); ++row) row_change_[row] = lastChangeOfRow(int(row));
    // No cell rises above the highest of all, so an underside well above that limits nothing.
    std::vector<std::int32_t> highest(area_.runs.size());
    context.pool.forEach(int(area_.runs.size()), [&](int i, int) {
      const Run& run = area_.runs[i];
      highest[i] = -rules::kHeightLimit;
      for (int row = 0; row < kSize; ++row)
        highest[i] =
            std::max(highest[i], context.kernels.highest(area_.height.data() + run.rowOffset(row), run.width()));
    });
    for (const std::int32_t height : highest) highest_ = std::max(highest_, height);
  }

  /// Steps are numbered through the tick; `end` - `first` is at most kSweepsAtOnce sweeps.
  /// Returns the pairs visited.
  std::int64_t run(int first, int end) {
    visited_ = 0;
    std::fill(progress_.begin(), progress_.end(), first);
    const int band_count = int(area_.bands.size());
    context_.pool.forEach(band_count, [&](int band, int) { advanceRows(band * kSize, (band + 1) * kSize, end); });
    context_.pool.forEach(band_count - 1, [&](int band, int) {
      if (adjacent(band)) advanceRows(band * kSize + kSize / 2, (band + 1) * kSize + kSize / 2, end);
    });
    SPOOR_ASSERT(std::ranges::all_of(progress_, [end](int done) { return done == end; }));
    return visited_;
  }

 private:
  /// Is the band after this one its neighbour on the ground?
  bool adjacent(int band) const {
    return band >= 0 && band + 1 < int(area_.bands.size()) &&
           area_.bands[band + 1].tile_y == area_.bands[band].tile_y + 1;
  }

  void advanceRows(int begin, int end_row, int end) {
    std::int64_t visited = 0;
    for (int row = begin; row < end_row;) {
      const bool moved_on = advance(row, begin, end_row, end, visited);
      row = moved_on && row > begin ? row - 1 : row + 1;  // the row before may have waited for this one
    }
    visited_ += visited;
  }

  /// Takes a row as far as it can go without rows outside [begin, end_row); returns whether it went at all.
  bool advance(int row, int begin, int end_row, int end, std::int64_t& visited) {
    const int start = progress_[row];
    while (progress_[row] < end) {
      const int step = progress_[row];
      const int matching = step % kSteps;
      if (matching < rules::kMatchVertical) {
        visited += exchangeAlong(row, matching, step);
        ++progress_[row];
        continue;
      }
      const bool lower = (row & 1) == (matching & 1);  // is this row the pair's first?
      const int partner = lower ? row + 1 : row - 1;
      const bool crosses = row / kSize != partner / kSize || partner < 0;
      if (crosses && !adjacent(std::min(row, partner) / kSize - (partner < 0 ? 1 : 0))) {
        ++progress_[row];  // no row there: nothing to exchange with
        continue;
      }
      if (partner < begin || partner >= end_row || progress_[partner] != step) break;
      visited += exchangeAcross(std::min(row, partner), std::max(row, partner), matching, step);
      ++progress_[row];
      ++progress_[partner];
    }
    return progress_[row] != start;
  }

  /// May an underside limit what this segment's cells take?
  bool covered(std::size_t segment) const {
    return std::int64_t(area_.lowest_underside[segment]) <=
           std::int64_t(highest_) + context_.parameters.obstacle_threshold_q;
  }

  std::int32_t lastChangeOfRow(int row) const {
    const Band& band = area_.bands[row / kSize];
    std::int32_t last = 0;
    for (int i = band.first_run; i < band.first_run + band.run_count; ++i) {
      const std::int32_t* changes = area_.last_change.data() + segmentOf(area_.runs[i], row, 0);
      last = std::max(last, context_.kernels.highest(changes, area_.runs[i].tile_count));
    }
    return last;
  }

  bool settledRow(int row, int step) const { return skip_settled_ && row_change_[row] < step - (kSteps - 1); }
  bool settled(std::size_t segment, int step) const { return area_.last_change[segment] < step - (kSteps - 1); }

  std::size_t segmentOf(const Run& run, int row, int tile) const {
    return run.segment_offset + std::size_t(row % kSize * run.tile_count + tile);
  }

  /// Horizontal pairs of a row: those whose first cell has the given parity.
  std::int64_t exchangeAlong(int row, int parity, int step) {
    std::int64_t visited = 0;
    if (settledRow(row, step)) return 0;
    const Band& band = area_.bands[row / kSize];
    for (int i = band.first_run; i < band.first_run + band.run_count; ++i) {
      const Run& run = area_.runs[i];
      const std::size_t cells = run.rowOffset(row % kSize);
      for (int tile = 0; tile < run.tile_count; ++tile) {
        const bool reaches_next = parity == 1 && tile + 1 < run.tile_count;
        const std::size_t segment = segmentOf(run, row, tile);
        if (skip_settled_ && settled(segment, step) && (!reaches_next || settled(segment + 1, step))) continue;
        const int pairs = kSize / 2 - (parity == 1 && !reaches_next ? 1 : 0);
        const std::size_t at = cells + std::size_t(tile * kSize + parity);
        const bool beneath = covered(segment) || (reaches_next && covered(segment + 1));
        const bool moved = context_.kernels.exchangeWithin(cellsAt(at, beneath, false), pairs, numbersFor(false));
        visited += pairs;
        if (!moved) continue;
        row_change_[row] = area_.last_change[segment] = step;
        if (reaches_next) area_.last_change[segment + 1] = step;
      }
    }
    return visited;
  }

  /// Vertical and diagonal pairs of two neighbouring rows.
  std::int64_t exchangeAcross(int row_a, int row_b, int matching, int step) {
    if (settledRow(row_a, step) && settledRow(row_b, step)) return 0;
    const int shift = matching < rules::kMatchDiagonal ? 0 : matching < rules::kMatchAntidiagonal ? 1 : -1;
    const Band& band_a = area_.bands[row_a / kSize];
    const Band& band_b = area_.bands[row_b / kSize];
    std::int64_t visited = 0;
    // Both bands' runs lie in x order; a run meets those that reach within a cell of it.
    int first = band_b.first_run;
    const int end = band_b.first_run + band_b.run_count;
    for (int i = band_a.first_run; i < band_a.first_run + band_a.run_count; ++i) {
      const Run& run = area_.runs[i];
      while (first < end && area_.runs[first].x1() < run.x0()) ++first;
      for (int j = first; j < end && area_.runs[j].x0() <= run.x1(); ++j)
        visited += exchangeRuns(run, row_a, area_.runs[j], row_b, shift, step);
    }
    return visited;
  }

  /// Pairs (x, row_a) - (x + shift, row_b) whose ends lie in the two runs.
  std::int64_t exchangeRuns(const Run& run_a, int row_a, const Run& run_b, int row_b, int shift, int step) {
    const int begin = std::max(run_a.x0(), run_b.x0() - shift);
    const int end = std::min(run_a.x1(), run_b.x1() - shift);
    std::int64_t visited = 0;
    for (int x = begin; x < end;) {
      const int stop = std::min((x / kSize + 1) * kSize, end);
      visited += exchangeSegment(run_a, row_a, run_b, row_b, x, stop - x, shift, step);
      x = stop;
    }
    return visited;
  }

  int exchangeSegment(const Run& run_a, int row_a, const Run& run_b, int row_b, int x, int count, int shift, int step) {
    const std::size_t segment_a = segmentOf(run_a, row_a, x / kSize - run_a.first.x);
    const std::size_t first_b = segmentOf(run_b, row_b, (x + shift) / kSize - run_b.first.x);
    const std::size_t last_b = segmentOf(run_b, row_b, (x + shift + count - 1) / kSize - run_b.first.x);
    if (skip_settled_ && settled(segment_a, step) && settled(first_b, step) && settled(last_b, step)) return 0;
    const std::size_t a = run_a.rowOffset(row_a % kSize) + std::size_t(x - run_a.x0());
    const std::size_t b = run_b.rowOffset(row_b % kSize) + std::size_t(x + shift - run_b.x0());
    const bool beneath = covered(segment_a) || covered(first_b) || covered(last_b);
    const bool diagonal = shift != 0;
    const bool moved = context_.kernels.exchangeRows(cellsAt(a, beneath, diagonal), cellsAt(b, beneath, diagonal),
                                                     count, numbersFor(diagonal));
    if (moved) {
      area_.last_change[segment_a] = area_.last_change[first_b] = area_.last_change[last_b] = step;
      row_change_[row_a] = row_change_[row_b] = step;
    }
    return count;
  }

  ExchangeCells cellsAt(std::size_t offset, bool beneath, bool diagonal) const {
    const std::vector<std::int32_t>& threshold = diagonal ? area_.diagonal_threshold : area_.threshold;
    return {&area_.height[offset], &area_.bedrock[offset], beneath ? &area_.underside[offset] : nullptr,
            threshold.empty() ? nullptr : &threshold[offset]};
  }

  ExchangeNumbers numbersFor(bool diagonal) const {
    const MaterialRules& soil = context_.parameters.materials.front();
    return {rules::exchangeThreshold(diagonal ? soil.diagonal_threshold_q : soil.slope_threshold_q),
            context_.parameters.obstacle_threshold_q};
  }

  const NativeContext& context_;
  WorkArea& area_;
  bool skip_settled_;
  std::int32_t highest_ = -rules::kHeightLimit;
  std::atomic<std::int64_t> visited_ = 0;
  std::vector<int> progress_;             // [bands * 64] the next step of each row
  std::vector<std::int32_t> row_change_;  // [bands * 64] the latest of last_change in each row
};

}  // namespace

std::int64_t runRelax(const NativeContext& context, int first_sweep, int sweep_count, bool skip_settled) {
  if (context.parameters.slopes != SlopeRule::exchange) {
    runSlopes(context, first_sweep, sweep_count);
    const int edges = context.parameters.slopes == SlopeRule::drift ? 2 : 4;
    return std::int64_t(context.area.tiles.size()) * rules::kTileCells * edges * sweep_count;
  }
  Relaxation relaxation(context, skip_settled);
  std::int64_t visited = 0;
  for (int done = 0; done < sweep_count; done += kSweepsAtOnce) {
    const int count = std::min(kSweepsAtOnce, sweep_count - done);
    visited += relaxation.run((first_sweep + done) * kSteps, (first_sweep + done + count) * kSteps);
  }
  return visited;
}

}  // namespace spoor
