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
    const std::vector<std::int32_t>& material = context.area.material;
    const MaterialRules& own = parameters.materials[material.empty() ? 0 : std::size_t(material[from + x])];
    const std::int32_t share = rules::compactedShare(overlap[x], height - context.area.bedrock[from + x], compacted,
                                                     own.compression_q16, own.compaction_limit_q16);
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

void DomainWork::addBuffers(std::vector<BufferBytes>& buffers) const {
  const auto add = [&buffers](const char* name, const auto&... planes) {
    const auto bytes = std::int64_t((... + (planes.capacity() * sizeof(planes[0]))));
    const auto same = std::ranges::find(buffers, name, &BufferBytes::name);
    if (same == buffers.end())
      buffers.push_back({name, bytes});
    else
      same->bytes += bytes;
  };
  add("overlap, in domains", overlap, penetrating_in_row, row_offset);
  add("exact search, in domains", nearest_row, stale_columns);
  add("jump flooding (2), in domains", known[0], known[1], seekers, seeker_order);
  add("targets, in domains", target, receives, parts);
  add("requests and grants, in domains", requested, granted, room);
  add("iterative displacement, in domains", flow_index, carried, flow_room, flow_total, offer[0], offer[1], flow_cells);
}

int DomainWork::penetratingLeft() const {
  return std::accumulate(penetrating_in_row.begin(), penetrating_in_row.end(), 0);
}

void runPenetration(const NativeContext& context, DomainWork& domain) {
  domain.forEachRow(context.pool, [&](int row) {
    const std::size_t from = domain.row_offset[row];
    domain.penetrating_in_row[row] = context.kernels.overlap(
        context.area.height.data() + from, context.area.bedrock.data() + from, context.area.underside.data() + from,
        context.area.underside_before.data() + from, domain.width(), context.parameters.obstacle_threshold_q,
        domain.overlap.data() + std::size_t(row) * domain.width());
  });
  domain.penetrating_count = domain.penetratingLeft();
  if (!anyCompression(context.parameters)) return;
  domain.forEachRow(context.pool, [&](int row) {
    if (domain.penetrating_in_row[row] > 0) domain.penetrating_in_row[row] = compactRow(context, domain, row);
  });
}

}  // namespace spoor
