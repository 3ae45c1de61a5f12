#include <algorithm>

#include "shared/base/fixed.h"
#include "shared/sim/plan.h"

namespace spoor {

PlacedBody placeBody(const ScenePack& pack, int body_index, const Pose& pose) {
  const Mesh& mesh = pack.meshes[std::size_t(pack.bodies[std::size_t(body_index)].mesh_index)];
  PlacedBody placed;
  placed.body_index = body_index;
  placed.origin_x = std::int32_t(floorDiv(pose.x_q, pack.cell_q));
  placed.origin_y = std::int32_t(floorDiv(pose.y_q, pack.cell_q));
  placed.z_q = pose.z_q;
  const Rotation rotation = rotationOf(pose);
  std::ranges::copy(rotation.m_q30, placed.placement.matrix);
  placed.placement.within_x = std::int32_t(pose.x_q - std::int64_t(placed.origin_x) * pack.cell_q);
  placed.placement.within_y = std::int32_t(pose.y_q - std::int64_t(placed.origin_y) * pack.cell_q);
  placed.placement.cell = pack.cell_q;
  placed.points.reserve(mesh.vertices.size());
  int x0 = INT32_MAX, x1 = INT32_MIN, y0 = INT32_MAX, y1 = INT32_MIN;
  for (const auto& vertex : mesh.vertices) {
    const rules::RasterPoint point = rules::placedPoint(placed.placement, vertex[0], vertex[1], vertex[2]);
    placed.points.push_back(point);
    x0 = std::min(x0, point.x);
    x1 = std::max(x1, point.x);
    y0 = std::min(y0, point.y);
    y1 = std::max(y1, point.y);
  }
  const auto clip = [](std::int32_t origin, int subcell, int past, std::int32_t limit) {
    return std::clamp(origin + rules::floorDiv(subcell, rules::kSubcells) + past, 0, limit);
  };
  placed.box = {clip(placed.origin_x, x0, 0, pack.width_cells), clip(placed.origin_y, y0, 0, pack.height_cells),
                clip(placed.origin_x, x1, 1, pack.width_cells), clip(placed.origin_y, y1, 1, pack.height_cells)};
  return placed;
}

}  // namespace spoor
