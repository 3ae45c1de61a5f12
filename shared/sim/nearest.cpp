// Stage nearest: the exact nearest free cell of every penetrating one, in two passes.
#include "shaders/rules/nearest.h"

#include <algorithm>
#include <atomic>
#include <utility>

#include "shared/sim/native_stages.h"

namespace spoor {
namespace {

/// For every cell the nearest free row of its own column; where it is known still, not again.
void searchColumns(const NativeContext& context, DomainWork& domain) {
  const int width = domain.width(), rows = domain.rows();
  const int task_columns = domain.columnsPerTask();
  constexpr std::int64_t kCellBytes = 16;  // two passes, in and out
  domain.bytes_moved +=
      kCellBytes * rows * std::min<std::int64_t>(width, std::ranges::count(domain.stale_columns, 1) * task_columns);
  context.pool.forEach((width + task_columns - 1) / task_columns, [&](int task, int) {
    if (std::exchange(domain.stale_columns[task], 0) == 0) return;
    const int x = task * task_columns;
    const int count = std::min(task_columns, width - x);
    std::vector<std::int32_t> last_free(std::size_t(count), rules::kNoFreeRow);
    for (int y = 0; y < rows; ++y) {
      const std::size_t at = std::size_t(y) * width + x;
      context.kernels.carryFree(domain.overlap.data() + at, count, y, last_free.data(), domain.nearest_row.data() + at);
    }
    std::ranges::fill(last_free, rules::kNoFreeRow);
    for (int y = rows - 1; y >= 0; --y) {
      const std::size_t at = std::size_t(y) * width + x;
      context.kernels.mergeFree(domain.overlap.data() + at, count, y, last_free.data(), domain.nearest_row.data() + at);
    }
  });
}

/// The best column from each x of a row: the lower envelope of the columns' parabolas, left to right.
class RowEnvelope {
 public:
  /// @param least  smallest overlap of the cells that search
  void search(DomainWork& domain, int y, int metric, std::int32_t least) {
    std::int32_t* target = domain.target.data() + std::size_t(y) * domain.width();
    const int width = domain.width();
    const std::int32_t* overlap = domain.overlap.data() + std::size_t(y) * width;
    const std::int32_t* free_row = domain.nearest_row.data() + std::size_t(y) * width;
    const auto [first, last] = queriedColumns(overlap, width, least);
    // No column farther away than the worst vertical distance can win.
    int reach = 0;
    for (int x = first; x <= last; ++x)
      if (overlap[x] >= least)
        reach = std::max(reach, free_row[x] == rules::kNoFreeRow ? width : std::abs(free_row[x] - y));
    build(free_row, y, metric, std::max(first - reach, 0), std::min(last + reach + 1, width));
    std::size_t part = 0;
    int marked_row = -1;
    for (int x = first; x <= last; ++x) {
      while (part + 1 < columns_.size() && starts_[part + 1] <= x) ++part;
      if (overlap[x] < least) continue;
      target[x] = rules::kNoTarget;
      if (columns_.empty()) continue;
      const int row = free_row[columns_[part]];
      target[x] = row * width + columns_[part];
      if (row != marked_row) std::atomic_ref(domain.receives[std::size_t(row)]).store(1, std::memory_order_relaxed);
      marked_row = row;
    }
  }

 private:
  static std::pair<int, int> queriedColumns(const std::int32_t* overlap, int width, std::int32_t least) {
    int first = 0, last = width - 1;
    while (first <= last && overlap[first] < least) ++first;
    while (first < last && overlap[last] < least) --last;
    return {first, last};
  }

  /// The first x of row y in [begin, end) from which (bx, by) is before (ax, ay), where ax < bx; `end` where there is
  /// none. There is one such place in any metric (rules/nearest.h).
  static int switchBetween(int y, int ax, int ay, int bx, int by, int metric, int begin, int end) {
    if (metric == rules::kEuclidean) return rules::nearestSwitch(y, ax, ay, bx, by);
    while (begin < end) {
      const int middle = begin + (end - begin) / 2;
      if (rules::nearestBefore(middle, y, bx, by, ax, ay, metric))
        end = middle;
      else
        begin = middle + 1;
    }
    return begin;
  }

  void build(const std::int32_t* free_row, int y, int metric, int begin, int end) {
    columns_.clear();
    starts_.clear();
    for (int x = begin; x < end; ++x) {
      if (free_row[x] == rules::kNoFreeRow) continue;
      int start = begin;
      while (!columns_.empty()) {
        const int top = columns_.back();
        start = switchBetween(y, top, free_row[top], x, free_row[x], metric, begin, end);
        if (start > starts_.back()) break;
        columns_.pop_back();
        starts_.pop_back();
        start = begin;
      }
      if (start >= end) continue;
      columns_.push_back(x);
      starts_.push_back(start);
    }
  }

  std::vector<int> columns_, starts_;  // columns_[i] is the best from starts_[i] on
};

}  // namespace

void runNearest(const NativeContext& context, DomainWork& domain) {
  const std::size_t cells = domain.overlap.size();
  domain.target.resize(cells);
  domain.receives.assign(std::size_t(domain.rows()), 0);
  if (context.parameters.nearest != NearestSearch::exact) {
    std::ranges::fill(domain.stale_columns, 0);
    return runFlood(context, domain);
  }
  const std::int32_t least = leastSearching(context.parameters);
  domain.nearest_row.resize(cells);
  searchColumns(context, domain);
  std::vector<RowEnvelope> envelopes(std::size_t(context.pool.threadCount()));
  const int task_rows = std::max(1, rowsPerTask(domain.width()) / 4);  // a row costs more here than elsewhere
  context.pool.forEach((domain.rows() + task_rows - 1) / task_rows, [&](int task, int thread) {
    for (int y = task * task_rows; y < std::min((task + 1) * task_rows, domain.rows()); ++y)
      if (least <= 0 || domain.penetrating_in_row[y] > 0)
        envelopes[thread].search(domain, y, int(context.parameters.metric), least);
  });
}

}  // namespace spoor
