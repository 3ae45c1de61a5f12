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
  const std::int64_t within_x = pose.x_q - std::int64_t(placed.origin_x) * pack.cell_q;
  const std::int64_t within_y = pose.y_q - std::int64_t(placed.origin_y) * pack.cell_q;
  const Rotation rotation = rotationOf(pose);
  placed.points.reserve(mesh.vertices.size());
  int x0 = INT32_MAX, x1 = INT32_MIN, y0 = INT32_MAX, y1 = INT32_MIN;
  for (const auto& vertex : mesh.vertices) {
    const auto at = rotate(rotation, vertex);
    const auto x = int(floorDiv((within_x + at[0]) * rules::kSubcells, pack.cell_q));
    const auto y = int(floorDiv((within_y + at[1]) * rules::kSubcells, pack.cell_q));
    placed.points.push_back({x, y, at[2]});
    x0 = std::min(x0, x);
    x1 = std::max(x1, x);
    y0 = std::min(y0, y);
    y1 = std::max(y1, y);
  }
  const auto clip = [](std::int32_t origin, int subcell, int past, std::int32_t limit) {
    return std::clamp(origin + rules::floorDiv(subcell, rules::kSubcells) + past, 0, limit);
  };
  placed.box = {clip(placed.origin_x, x0, 0, pack.width_cells), clip(placed.origin_y, y0, 0, pack.height_cells),
                clip(placed.origin_x, x1, 1, pack.width_cells), clip(placed.origin_y, y1, 1, pack.height_cells)};
  return placed;
}

}  // namespace spoor
