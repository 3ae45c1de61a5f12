// Stage penetration: which cells a body overlaps, and by how much.
#include "shaders/rules/penetration.h"

#include <atomic>
#include <numeric>

#include "shared/sim/native_stages.h"

namespace spoor {
namespace {

/// Presses a row's overlap together, each cell's share of it. Returns how many cells still penetrate.
int compactRow(const NativeContext& context, DomainWork& domain, int row) {
  const Parameters& parameters = context.parameters;
  const std::size_t from = domain.row_offset[row];
  std::int32_t* overlap = domain.overlap.data() + std::size_t(row) * domain.width();
  int left = 0;
  for (int x = 0; x < domain.width(); ++x) {
    if (overlap[x] <= 0) continue;
    std::int32_t& height = context.area.height[from + x];
    std::int32_t& compacted = context.area.compacted[from + x];
    const std::int32_t share = rules::compactedShare(overlap[x], height - context.area.bedrock[from + x], compacted,
                                                     parameters.compression_q16, parameters.compaction_limit_q16);
    compacted += share;
    height -= share;
    overlap[x] -= share;
    left += overlap[x] > 0 ? 1 : 0;
  }
  return left;
}

}  // namespace

void DomainWork::reset(const CellBox& new_box, const WorkArea& area) {
  box = new_box;
  const std::size_t cells = std::size_t(width()) * std::size_t(rows());
  row_offset.resize(std::size_t(rows()));
  for (int row = 0; row < rows(); ++row) row_offset[std::size_t(row)] = area.offsetAt(box.x0, box.y0 + row);
  overlap.resize(cells);
  penetrating_in_row.resize(std::size_t(rows()));
  stale_columns.assign(std::size_t(width() / columnsPerTask() + 1), 1);
  penetrating_count = 0;
}

int runPenetration(const NativeContext& context, DomainWork& domain) {
  const int task_rows = rowsPerTask(domain.width());
  std::atomic<int> compacted_away = 0;  // cells whose whole overlap was pressed together
  context.pool.forEach((domain.rows() + task_rows - 1) / task_rows, [&](int task, int) {
    for (int row = task * task_rows; row < std::min((task + 1) * task_rows, domain.rows()); ++row) {
      const std::size_t from = domain.row_offset[row];
      domain.penetrating_in_row[row] = context.kernels.overlap(
          context.area.height.data() + from, context.area.bedrock.data() + from, context.area.underside.data() + from,
          domain.width(), context.parameters.obstacle_threshold_q,
          domain.overlap.data() + std::size_t(row) * domain.width());
      if (context.parameters.compression_q16 == 0 || domain.penetrating_in_row[row] == 0) continue;
      compacted_away += domain.penetrating_in_row[row];
      domain.penetrating_in_row[row] = compactRow(context, domain, row);
      compacted_away -= domain.penetrating_in_row[row];
    }
  });
  domain.penetrating_count = std::accumulate(domain.penetrating_in_row.begin(), domain.penetrating_in_row.end(), 0);
  return domain.penetrating_count + compacted_away;
}

}  // namespace spoor
