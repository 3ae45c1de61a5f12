// Stage depth: integer rasterisation of undersides.
#include <algorithm>

#include "shared/sim/native_stages.h"

namespace spoor {
namespace {

constexpr int kLeastChunkRows = 16;

/// A body's triangles and edges, set up once per sub-step.
struct BodyRaster {
  const PlacedBody* body;
  std::vector<rules::RasterTriangle> triangles;
  std::vector<rules::RasterEdge> edges;
};

BodyRaster setUp(const ScenePack& pack, const PlacedBody& body) {
  const Mesh& mesh = pack.meshes[std::size_t(pack.bodies[std::size_t(body.body_index)].mesh_index)];
  BodyRaster raster{&body, {}, {}};
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto triangle = rules::rasterTriangle(body.points[a], body.points[b], body.points[c]);
    if (!rules::wideZero(triangle.area)) raster.triangles.push_back(triangle);
  }
  for (const auto& [a, b] : mesh.edges) raster.edges.push_back(rules::rasterEdge(body.points[a], body.points[b]));
  return raster;
}

std::int32_t absoluteHeight(std::int64_t z) {
  return std::int32_t(std::clamp<std::int64_t>(z, -rules::kHeightLimit, rules::kNoUnderside));
}

/// The underside rows of one domain; the caller of the per-primitive functions clips to rows [y0, y1).
class RowTarget {
 public:
  RowTarget(const NativeContext& context, const CellBox& box) : context_(context), box_(box) {}

  void drawTriangle(const rules::RasterTriangle& t, const PlacedBody& body) {
    const int low = std::min({t.a.y, t.b.y, t.c.y}), high = std::max({t.a.y, t.b.y, t.c.y});
    const int first = std::max(rules::floorDiv(low, rules::kSubcells), box_.y0 - body.origin_y);
    const int last = std::min(rules::floorDiv(high, rules::kSubcells), box_.y1 - 1 - body.origin_y);
    // Clipped to the body, not to the domain: heights along a row are counted from where its span begins.
    const rules::RasterSpan whole = {body.box.x0 - body.origin_x, body.box.x1 - body.origin_x};
    for (int row = first; row <= last; ++row) {
      const rules::RasterSpan span = rules::triangleSpan(t, row, whole);
      if (span.end <= span.begin) continue;
      const int start = rules::triangleHeight(t, span.begin, row);
      context_.kernels.lowerAlong(cellsAt(span.begin + body.origin_x, row + body.origin_y), span.end - span.begin,
                                  absoluteHeight(std::int64_t(body.z_q) + start), t.step, t.step_fraction,
                                  absoluteHeight(std::int64_t(body.z_q) + t.lowest),
                                  absoluteHeight(std::int64_t(body.z_q) + t.highest));
    }
  }

  void drawEdge(const rules::RasterEdge& e, const PlacedBody& body) {
    const bool along_y = e.along_y != 0;
    const int u_origin = along_y ? body.origin_y : body.origin_x;
    const int first = std::max(rules::floorDiv(e.u0, rules::kSubcells), (along_y ? box_.y0 : box_.x0) - u_origin);
    const int last = std::min(rules::floorDiv(e.u1, rules::kSubcells), (along_y ? box_.y1 : box_.x1) - 1 - u_origin);
    const int v_origin = along_y ? body.origin_x : body.origin_y;
    if (rules::floorDiv(std::max(e.v0, e.v1), rules::kSubcells) < (along_y ? box_.x0 : box_.y0) - v_origin ||
        rules::floorDiv(std::min(e.v0, e.v1), rules::kSubcells) >= (along_y ? box_.x1 : box_.y1) - v_origin)
      return;
    for (int column = first; column <= last; ++column) {
      const rules::EdgeColumn cells = rules::edgeColumn(e, column);
      for (int v = cells.first; v <= cells.last; ++v) {
        const int x = (along_y ? v : column) + body.origin_x;
        const int y = (along_y ? column : v) + body.origin_y;
        if (x < box_.x0 || x >= box_.x1 || y < box_.y0 || y >= box_.y1) continue;
        std::int32_t& underside = *cellsAt(x, y);
        underside = std::min(underside, absoluteHeight(std::int64_t(body.z_q) + cells.height));
      }
    }
  }

  /// Keeps each segment's lowest underside.
  void noteLowest() {
    for (int y = box_.y0; y < box_.y1; ++y)
      for (int x = box_.x0; x < box_.x1;) {
        const int end = std::min((x / rules::kTileSize + 1) * rules::kTileSize, box_.x1);
        std::int32_t& lowest = context_.area.lowest_underside[context_.area.segmentAt(x, y)];
        lowest = std::min(lowest, context_.kernels.lowest(cellsAt(x, y), end - x));
        x = end;
      }
  }

 private:
  std::int32_t* cellsAt(int x, int y) { return context_.area.underside.data() + context_.area.offsetAt(x, y); }

  const NativeContext& context_;
  CellBox box_;
};

}  // namespace

void runDepth(const NativeContext& context, const SubStep& sub_step) {
  std::vector<BodyRaster> rasters(sub_step.bodies.size());
  context.pool.forEach(int(rasters.size()), [&](int i, int) { rasters[i] = setUp(context.pack, sub_step.bodies[i]); });
  for (const Domain& domain : sub_step.domains) {
    // Every chunk looks at every primitive: as few chunks as still share the work out evenly.
    const int rows = domain.box.y1 - domain.box.y0;
    const int chunk_rows = std::max(kLeastChunkRows, rows / (4 * context.pool.threadCount()) + 1);
    const int chunk_count = (rows + chunk_rows - 1) / chunk_rows;
    context.pool.forEach(chunk_count, [&](int chunk, int) {
      const int y0 = domain.box.y0 + chunk * chunk_rows;
      RowTarget target(context, {domain.box.x0, y0, domain.box.x1, std::min(y0 + chunk_rows, domain.box.y1)});
      for (const int body : domain.bodies) {
        for (const auto& triangle : rasters[body].triangles) target.drawTriangle(triangle, *rasters[body].body);
        for (const auto& edge : rasters[body].edges) target.drawEdge(edge, *rasters[body].body);
      }
      target.noteLowest();
    });
  }
}

}  // namespace spoor
