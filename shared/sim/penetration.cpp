// Stage penetration: which cells a body overlaps, and by how much.
#include "shaders/rules/penetration.h"

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
  stale_columns.assign(std::size_t((width() + columnsPerTask() - 1) / columnsPerTask()), 1);
  penetrating_count = 0;
  bytes_moved = 0;
}

std::int64_t DomainWork::memoryBytes() const {
  std::size_t bytes = 0;
  for (const auto* plane : {&overlap, &nearest_row, &target, &room, &known[0], &known[1], &seekers, &flow_index,
                            &carried, &flow_room, &flow_total, &offer[0], &offer[1]})
    bytes += plane->capacity() * sizeof(std::int32_t);
  for (const auto* plane : {&requested, &granted}) bytes += plane->capacity() * sizeof(std::int64_t);
  for (const auto* plane : {&receives, &stale_columns, &seeker_order, &parts}) bytes += plane->capacity();
  return std::int64_t(bytes + flow_cells.capacity() * sizeof(FlowCell) + row_offset.capacity() * sizeof(std::size_t) +
                      penetrating_in_row.capacity() * sizeof(int));
}

int DomainWork::penetratingLeft() const {
  return std::accumulate(penetrating_in_row.begin(), penetrating_in_row.end(), 0);
}

void runPenetration(const NativeContext& context, DomainWork& domain) {
  domain.forEachRow(context.pool, [&](int row) {
    const std::size_t from = domain.row_offset[row];
    domain.penetrating_in_row[row] = context.kernels.overlap(
        context.area.height.data() + from, context.area.bedrock.data() + from, context.area.underside.data() + from,
        domain.width(), context.parameters.obstacle_threshold_q,
        domain.overlap.data() + std::size_t(row) * domain.width());
  });
  domain.penetrating_count = domain.penetratingLeft();
  if (context.parameters.compression_q16 == 0) return;
  domain.forEachRow(context.pool, [&](int row) {
    if (domain.penetrating_in_row[row] > 0) domain.penetrating_in_row[row] = compactRow(context, domain, row);
  });
}

}  // namespace spoor
