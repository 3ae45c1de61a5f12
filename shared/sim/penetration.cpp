// Stage penetration: which cells a body overlaps, and by how much.
#include <numeric>

#include "shared/sim/native_stages.h"

namespace spoor {

void DomainWork::reset(const CellBox& new_box, const WorkArea& area) {
  box = new_box;
  const std::size_t cells = std::size_t(width()) * std::size_t(rows());
  row_offset.resize(std::size_t(rows()));
  for (int row = 0; row < rows(); ++row) row_offset[std::size_t(row)] = area.offsetAt(box.x0, box.y0 + row);
  overlap.resize(cells);
  penetrating_in_row.resize(std::size_t(rows()));
  penetrating_count = 0;
}

void runPenetration(const NativeContext& context, DomainWork& domain) {
  const int task_rows = rowsPerTask(domain.width());
  context.pool.forEach((domain.rows() + task_rows - 1) / task_rows, [&](int task, int) {
    for (int row = task * task_rows; row < std::min((task + 1) * task_rows, domain.rows()); ++row) {
      const std::size_t from = domain.row_offset[row];
      domain.penetrating_in_row[row] = context.kernels.overlap(
          context.area.height.data() + from, context.area.bedrock.data() + from, context.area.underside.data() + from,
          context.area.underside_before.data() + from, domain.width(), context.parameters.obstacle_threshold_q,
          domain.overlap.data() + std::size_t(row) * domain.width());
    }
  });
  domain.penetrating_count = std::accumulate(domain.penetrating_in_row.begin(), domain.penetrating_in_row.end(), 0);
}

}  // namespace spoor
