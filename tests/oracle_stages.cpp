// Stages depth and penetration, cell by cell, as DESIGN.md and the rule headers describe them.
#include <algorithm>

#include "shaders/rules/limits.h"
#include "shared/base/fixed.h"
#include "tests/oracle.h"

namespace spoor::test {
namespace {

using rules::kSubcells;
using Wide = __int128;
constexpr std::int64_t kDeepSoil = (1 << 29) - 1;  // 0.1 mm; soil deeper than that does not count

/// Twice the area of p, q and a third point, positive where the three turn left.
std::int64_t turnArea(const rules::RasterPoint& p, const rules::RasterPoint& q, std::int64_t x, std::int64_t y) {
  return std::int64_t(q.x - p.x) * (y - p.y) - std::int64_t(q.y - p.y) * (x - p.x);
}

bool isInside(const rules::RasterPoint& p, const rules::RasterPoint& q, std::int64_t x, std::int64_t y) {
  const std::int64_t side = turnArea(p, q, x, y);
  if (side != 0) return side > 0;
  return q.y < p.y || (q.y == p.y && q.x < p.x);  // down the left side, or along the top from right to left
}

int centreOf(int cell) { return cell * kSubcells + kSubcells / 2; }

void lower(std::int32_t& underside, std::int64_t height) {
  const auto limited = std::clamp<std::int64_t>(height, -rules::kHeightLimit, rules::kNoUnderside);
  underside = std::min(underside, std::int32_t(limited));
}

void lowerToTriangle(DenseWorld& world, const OracleBody& body, const std::array<std::uint32_t, 3>& corners, int x0,
                     int y0, int x1, int y1) {
  const auto &a = body.points[corners[0]], &b = body.points[corners[1]], &c = body.points[corners[2]];
  if (turnArea(a, b, c.x, c.y) == 0) return;
  const rules::RasterTriangle triangle = rules::rasterTriangle(a, b, c);
  for (int y = y0; y < y1; ++y) {
    // The rounding of a row's heights counts from the row's first cell; the rule header defines it.
    int first = x1;
    for (int x = x0; x < x1; ++x) {
      if (!world.inside(x + body.origin_x, y + body.origin_y) || !coversCentre(a, b, c, x, y)) continue;
      first = std::min(first, x);
      const int start = rules::triangleHeight(triangle, first, y);
      const int height = rules::triangleHeightAlong(start, triangle.step, triangle.step_fraction, x - first,
                                                    triangle.lowest, triangle.highest);
      lower(world.underside[world.at(x + body.origin_x, y + body.origin_y)], body.z_q + height);
    }
  }
}

void lowerToEdge(DenseWorld& world, const OracleBody& body, const std::array<std::uint32_t, 2>& ends, int x0, int y0,
                 int x1, int y1) {
  const rules::RasterEdge edge = rules::rasterEdge(body.points[ends[0]], body.points[ends[1]]);
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) {
      if (!world.inside(x + body.origin_x, y + body.origin_y)) continue;
      const int u = edge.along_y != 0 ? y : x;
      const int v = edge.along_y != 0 ? x : y;
      const bool beside = edge.u1 < u * kSubcells || edge.u0 >= (u + 1) * kSubcells;
      if (beside) continue;
      const rules::EdgeColumn column = rules::edgeColumn(edge, u);
      if (v >= column.first && v <= column.last)
        lower(world.underside[world.at(x + body.origin_x, y + body.origin_y)], body.z_q + column.height);
    }
}

}  // namespace

DenseWorld::DenseWorld(const BaseTerrain& base) {
  const ScenePack& pack = base.pack();
  const TileCoordinate extent = tileExtent(pack);
  columns = extent.x * rules::kTileSize;
  rows = extent.y * rules::kTileSize;
  inside_columns = pack.width_cells;
  inside_rows = pack.height_cells;
  height.assign(std::size_t(columns) * std::size_t(rows), 0);
  cell_q = pack.cell_q;
  bedrock = compacted = material = push_x = push_y = height;
  for (int y = 0; y < inside_rows; ++y)
    for (int x = 0; x < inside_columns; ++x) {
      height[at(x, y)] = base.height(x, y);
      bedrock[at(x, y)] = height[at(x, y)] - pack.soil_depth_q;
      material[at(x, y)] = oracleMaterial(base, x, y);
    }
  underside.assign(height.size(), rules::kNoUnderside);
  underside_before = underside;
  active.assign(height.size(), 0);
}

OracleBody placeForOracle(const ScenePack& pack, int body_index, const Pose& pose) {
  OracleBody body;
  body.mesh = &pack.meshes[std::size_t(pack.bodies[std::size_t(body_index)].mesh_index)];
  body.origin_x = int(floorDiv(pose.x_q, pack.cell_q));
  body.origin_y = int(floorDiv(pose.y_q, pack.cell_q));
  body.z_q = pose.z_q;
  const Rotation rotation = rotationOf(pose);
  for (const auto& vertex : body.mesh->vertices) {
    const auto turned = rotate(rotation, vertex);
    // From the world's corner in subcells, rounded down; then from the origin's corner.
    const std::int64_t x = floorDiv((std::int64_t(pose.x_q) + turned[0]) * kSubcells, pack.cell_q);
    const std::int64_t y = floorDiv((std::int64_t(pose.y_q) + turned[1]) * kSubcells, pack.cell_q);
    body.points.push_back({int(x - std::int64_t(body.origin_x) * kSubcells),
                           int(y - std::int64_t(body.origin_y) * kSubcells), turned[2]});
  }
  return body;
}

bool coversCentre(const rules::RasterPoint& a, const rules::RasterPoint& b, const rules::RasterPoint& c, int x, int y) {
  const std::int64_t area = turnArea(a, b, c.x, c.y);
  if (area == 0) return false;
  const auto &second = area > 0 ? b : c, &third = area > 0 ? c : b;
  const int px = centreOf(x), py = centreOf(y);
  return isInside(a, second, px, py) && isInside(second, third, px, py) && isInside(third, a, px, py);
}

std::int64_t planeHeight(const rules::RasterPoint& a, const rules::RasterPoint& b, const rules::RasterPoint& c, int x,
                         int y) {
  // Barycentric: the height is the corners' heights weighted by the areas opposite to them.
  const int px = centreOf(x), py = centreOf(y);
  Wide area = turnArea(a, b, c.x, c.y);
  Wide sum =
      Wide(turnArea(b, c, px, py)) * a.z + Wide(turnArea(c, a, px, py)) * b.z + Wide(turnArea(a, b, px, py)) * c.z;
  if (area < 0) {
    area = -area;
    sum = -sum;
  }
  const Wide quotient = sum / area;
  return std::int64_t(quotient - (sum % area < 0 ? 1 : 0));
}

void oracleDepth(DenseWorld& world, const OracleBody& body) {
  // Every cell from two cells before the mesh's box to two cells behind it.
  int x0 = INT32_MAX, y0 = INT32_MAX, x1 = INT32_MIN, y1 = INT32_MIN;
  for (const auto& point : body.points) {
    x0 = std::min(x0, point.x);
    x1 = std::max(x1, point.x);
    y0 = std::min(y0, point.y);
    y1 = std::max(y1, point.y);
  }
  x0 = x0 / kSubcells - 3;
  y0 = y0 / kSubcells - 3;
  x1 = x1 / kSubcells + 3;
  y1 = y1 / kSubcells + 3;
  for (const auto& triangle : body.mesh->triangles) lowerToTriangle(world, body, triangle, x0, y0, x1, y1);
  for (const auto& edge : body.mesh->edges) lowerToEdge(world, body, edge, x0, y0, x1, y1);
}

OracleBox wholeWorld(const DenseWorld& world) { return {0, 0, world.inside_columns, world.inside_rows}; }

void oracleFrustum(DenseWorld& world, int frustum_height) {
  if (frustum_height == 0) return;
  for (int y = 0; y < world.inside_rows; ++y)
    for (int x = 0; x < world.inside_columns; ++x) {
      const std::size_t i = world.at(x, y);
      const std::int64_t above_bedrock = std::int64_t(world.underside[i]) - world.bedrock[i];
      // Where a body reaches down as far as heights go, there is nothing to be seen or not (rules/penetration.h).
      if (above_bedrock > frustum_height && world.underside[i] > -rules::kHeightLimit)
        world.underside[i] = rules::kNoUnderside;
    }
}

std::vector<std::int32_t> oracleOverlap(const DenseWorld& world, int obstacle_threshold) {
  std::vector<std::int32_t> overlap(world.height.size(), rules::kObstacle);
  for (int y = 0; y < world.inside_rows; ++y)
    for (int x = 0; x < world.inside_columns; ++x) {
      const std::size_t i = world.at(x, y);
      const int lowest = std::max(world.underside[i], world.bedrock[i]);
      if (world.height[i] > lowest)
        overlap[i] = world.height[i] - lowest;
      else if (world.underside[i] - world.height[i] > obstacle_threshold &&
               world.underside_before[i] - world.height[i] > obstacle_threshold)
        overlap[i] = rules::kFree;
    }
  return overlap;
}

void oracleCompact(DenseWorld& world, std::vector<std::int32_t>& overlap, const Parameters& parameters,
                   const OracleBox& domain) {
  for (int y = domain.y0; y < domain.y1; ++y)
    for (int x = domain.x0; x < domain.x1; ++x) {
      const std::size_t i = world.at(x, y);
      if (overlap[i] <= 0) continue;
      const MaterialRules& own = world.rulesOf(parameters, i);
      const std::int64_t compacted = world.compacted[i];
      std::int64_t share_q16 = own.compression_q16;
      std::int64_t room = rules::kHeightLimit - compacted;
      if (own.compaction_limit_q16 > 0) {
        // All the soil that the column ever had, as far as it counts.
        const std::int64_t soil = std::min<std::int64_t>(std::int64_t(world.height[i]) - world.bedrock[i], kDeepSoil) +
                                  std::min<std::int64_t>(compacted, kDeepSoil);
        const std::int64_t limit = soil * own.compaction_limit_q16 / kOneQ16;
        room = std::max<std::int64_t>(limit - compacted, 0);
        share_q16 = limit == 0 ? 0 : share_q16 * room / limit;
      }
      const auto pressed = std::int32_t(std::min(overlap[i] * share_q16 / kOneQ16, room));
      world.compacted[i] += pressed;
      world.height[i] -= pressed;
      overlap[i] -= pressed;  // 0: an obstacle
    }
}

}  // namespace spoor::test
