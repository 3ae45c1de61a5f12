// Stage depth: integer rasterisation of undersides.
//
// Only the lowest surface over a cell counts, and a minimum does not mind the order: low primitives are drawn first,
// and one that lies above everything already drawn where it could fall is left out. On a closed mesh that is most of
// them.
#include <algorithm>
#include <numeric>
#include <span>

#include "shared/sim/native_stages.h"

namespace spoor {
namespace {

/// A body's triangles, then its edges, in rough order of their lowest points.
struct DrawOrder {
  const PlacedBody* body;
  const Mesh* mesh;
  std::vector<std::uint32_t> primitives;  // below triangles.size(): a triangle; from there on: an edge
};

DrawOrder orderOf(const ScenePack& pack, const PlacedBody& body) {
  constexpr int kBuckets = 32;
  DrawOrder order{&body, &pack.meshes[std::size_t(pack.bodies[std::size_t(body.body_index)].mesh_index)], {}};
  const auto& points = body.points;
  const auto [low, high] = std::ranges::minmax(points, {}, &rules::RasterPoint::z);
  const std::size_t triangle_count = order.mesh->triangles.size();
  const std::size_t count = triangle_count + order.mesh->edges.size();
  std::vector<std::uint8_t> bucket_of(count);
  std::array<std::uint32_t, kBuckets + 1> start{};
  for (std::size_t i = 0; i < count; ++i) {
    int z;
    if (i < triangle_count) {
      const auto& [a, b, c] = order.mesh->triangles[i];
      z = std::min({points[a].z, points[b].z, points[c].z});
    } else {
      const auto& [a, b] = order.mesh->edges[i - triangle_count];
      z = std::min(points[a].z, points[b].z);
    }
    bucket_of[i] = std::uint8_t(std::int64_t(z - low.z) * kBuckets / (std::int64_t(high.z) - low.z + 1));
    ++start[bucket_of[i] + 1];
  }
  std::partial_sum(start.begin(), start.end(), start.begin());
  order.primitives.resize(count);
  for (std::size_t i = 0; i < count; ++i) order.primitives[start[bucket_of[i]]++] = std::uint32_t(i);
  return order;
}

/// Some rows of one domain's undersides.
class RowTarget {
 public:
  /// `row_offset`: of the box's rows in the area's planes.
  RowTarget(const NativeContext& context, const CellBox& box, const std::size_t* row_offset)
      : context_(context), box_(box), row_offset_(row_offset) {}

  void draw(const DrawOrder& order) {
    const PlacedBody& body = *order.body;
    const std::size_t triangle_count = order.mesh->triangles.size();
    for (const std::uint32_t primitive : order.primitives) {
      if (primitive < triangle_count) {
        const auto& [a, b, c] = order.mesh->triangles[primitive];
        drawTriangle(body.points[a], body.points[b], body.points[c], body);
      } else {
        const auto& [a, b] = order.mesh->edges[primitive - triangle_count];
        drawEdge(body.points[a], body.points[b], body);
      }
    }
  }

 private:
  std::int32_t* cellAt(int x, int y) {
    return context_.area.underside.data() + row_offset_[y - box_.y0] + std::size_t(x - box_.x0);
  }

  /// The part of a box of cells, relative to the body's, that lies in these rows.
  CellBox clipped(const PlacedBody& body, const rules::RasterSpan& columns, const rules::RasterSpan& rows) const {
    return {std::max(columns.begin + body.origin_x, box_.x0), std::max(rows.begin + body.origin_y, box_.y0),
            std::min(columns.end + body.origin_x, box_.x1), std::min(rows.end + body.origin_y, box_.y1)};
  }

  /// True where something at this height or above can change nothing. Looks only at boxes small enough to be worth it.
  bool hidden(const CellBox& cells, std::int32_t height) {
    constexpr int kWorthwhile = 64;
    if ((cells.x1 - cells.x0) * (cells.y1 - cells.y0) > kWorthwhile) return false;
    for (int y = cells.y0; y < cells.y1; ++y) {
      const std::int32_t* row = cellAt(cells.x0, y);
      for (int i = 0; i < cells.x1 - cells.x0; ++i)
        if (row[i] > height) return false;
    }
    return true;
  }

  void drawTriangle(const rules::RasterPoint& a, const rules::RasterPoint& b, const rules::RasterPoint& c,
                    const PlacedBody& body) {
    const rules::RasterSpan columns = rules::centresBetween(std::min({a.x, b.x, c.x}), std::max({a.x, b.x, c.x}));
    const rules::RasterSpan rows = rules::centresBetween(std::min({a.y, b.y, c.y}), std::max({a.y, b.y, c.y}));
    const CellBox cells = clipped(body, columns, rows);
    const std::int32_t lowest = rules::heightInWorld(body.z_q, std::min({a.z, b.z, c.z}));
    if (cells.empty() || hidden(cells, lowest)) return;
    const rules::RasterTriangle t = rules::rasterTriangle(a, b, c);
    if (rules::wideZero(t.area)) return;
    const std::int32_t highest = rules::heightInWorld(body.z_q, t.highest);
    // Clipped to the body, not to the domain: heights along a row are counted from where its span begins.
    const rules::RasterSpan whole = {body.box.x0 - body.origin_x, body.box.x1 - body.origin_x};
    for (int y = cells.y0; y < cells.y1; ++y) {
      const rules::RasterSpan span = rules::triangleSpan(t, y - body.origin_y, whole);
      if (span.end <= span.begin) continue;
      const int start = rules::triangleHeight(t, span.begin, y - body.origin_y);
      context_.kernels.lowerAlong(cellAt(span.begin + body.origin_x, y), span.end - span.begin,
                                  rules::heightInWorld(body.z_q, start), t.step, t.step_fraction, lowest, highest);
    }
  }

  void drawEdge(const rules::RasterPoint& a, const rules::RasterPoint& b, const PlacedBody& body) {
    const auto cellsBetween = [](int p, int q) {
      return rules::RasterSpan{rules::floorDiv(std::min(p, q), rules::kSubcells),
                               rules::floorDiv(std::max(p, q), rules::kSubcells) + 1};
    };
    const CellBox cells = clipped(body, cellsBetween(a.x, b.x), cellsBetween(a.y, b.y));
    if (cells.empty() || hidden(cells, rules::heightInWorld(body.z_q, std::min(a.z, b.z)))) return;
    const rules::RasterEdge e = rules::rasterEdge(a, b);
    const bool along_y = e.along_y != 0;
    const int u_origin = along_y ? body.origin_y : body.origin_x;
    const int v_origin = along_y ? body.origin_x : body.origin_y;
    for (int u = along_y ? cells.y0 : cells.x0; u < (along_y ? cells.y1 : cells.x1); ++u) {
      const rules::EdgeColumn column = rules::edgeColumn(e, u - u_origin);
      const std::int32_t height = rules::heightInWorld(body.z_q, column.height);
      const int first = std::max(column.first + v_origin, along_y ? box_.x0 : box_.y0);
      const int last = std::min(column.last + v_origin, (along_y ? box_.x1 : box_.y1) - 1);
      for (int v = first; v <= last; ++v) {
        std::int32_t& underside = *(along_y ? cellAt(v, u) : cellAt(u, v));
        underside = std::min(underside, height);
      }
    }
  }

  const NativeContext& context_;
  CellBox box_;
  const std::size_t* row_offset_;
};

struct Chunk {
  const Domain* domain;
  CellBox box;
};

/// Every chunk looks at every primitive of its domain: as few chunks as still share the work out.
std::vector<Chunk> chunksOf(const std::vector<Domain>& domains, int thread_count) {
  constexpr int kLeastRows = 16;
  std::vector<Chunk> chunks;
  for (const Domain& domain : domains) {
    const int rows = domain.box.y1 - domain.box.y0;
    const int chunk_rows = std::max<int>(kLeastRows, rows * int(domains.size()) / thread_count + 1);
    for (int y = domain.box.y0; y < domain.box.y1; y += chunk_rows)
      chunks.push_back({&domain, {domain.box.x0, y, domain.box.x1, std::min(y + chunk_rows, domain.box.y1)}});
  }
  return chunks;
}

void drawChunk(const NativeContext& context, const SubStep& sub_step, const std::vector<DrawOrder>& orders,
               const Chunk& chunk) {
  const CellBox& box = chunk.box;
  std::vector<std::size_t> row_offset;
  for (int y = box.y0; y < box.y1; ++y) row_offset.push_back(context.area.offsetAt(box.x0, y));
  RowTarget target(context, box, row_offset.data());
  for (const int body : chunk.domain->bodies)
    if (sub_step.bodies[body].box.meets(box)) target.draw(orders[body]);
}

/// Draws a sub-step's bodies into its domains, which are disjoint.
void drawDomains(const NativeContext& context, const SubStep& sub_step, const std::vector<DrawOrder>& orders) {
  const std::vector<Chunk> chunks = chunksOf(sub_step.domains, context.pool.threadCount());
  context.pool.forEach(int(chunks.size()), [&](int i, int) { drawChunk(context, sub_step, orders, chunks[i]); });
}

/// Sorts domains into groups so that those of different groups are disjoint.
std::vector<std::vector<const Domain*>> groupsOf(std::span<const Domain> domains) {
  std::vector<std::vector<const Domain*>> groups;
  for (const Domain& domain : domains) {
    std::vector<const Domain*> joined{&domain};
    std::erase_if(groups, [&](const std::vector<const Domain*>& group) {
      const bool touches =
          std::ranges::any_of(group, [&](const Domain* other) { return other->box.meets(domain.box); });
      if (touches) joined.insert(joined.end(), group.begin(), group.end());
      return touches;
    });
    groups.push_back(std::move(joined));
  }
  return groups;
}

std::vector<DrawOrder> ordersOf(const NativeContext& context, const SubStep& sub_step) {
  std::vector<DrawOrder> orders(sub_step.bodies.size());
  context.pool.forEach(int(orders.size()), [&](int i, int) { orders[i] = orderOf(context.pack, sub_step.bodies[i]); });
  return orders;
}

/// Once all are drawn (a segment may lie under several domains): the lowest of each segment.
void findLowest(const NativeContext& context) {
  context.pool.forEach(int(context.area.runs.size()), [&](int i, int) {
    const Run& run = context.area.runs[i];
    const std::int32_t frustum_height = context.parameters.frustum_height_q;
    for (int row = 0; row < rules::kTileSize; ++row) {
      if (frustum_height > 0)
        context.kernels.hideAbove(context.area.underside.data() + run.rowOffset(row),
                                  context.area.bedrock.data() + run.rowOffset(row), run.width(), frustum_height);
      for (int tile = 0; tile < run.tile_count; ++tile)
        context.area.lowest_underside[run.segment_offset + std::size_t(row * run.tile_count + tile)] =
            context.kernels.lowest(
                context.area.underside.data() + run.rowOffset(row) + std::size_t(tile * rules::kTileSize),
                rules::kTileSize);
    }
  });
}

}  // namespace

void runDepth(const NativeContext& context, const SubStep& sub_step) {
  drawDomains(context, sub_step, ordersOf(context, sub_step));
  findLowest(context);
}

void runStood(const NativeContext& context, const SubStep& stood) {
  const std::vector<DrawOrder> orders = ordersOf(context, stood);
  const auto groups = groupsOf(stood.domains);
  if (groups.size() == stood.domains.size())
    drawDomains(context, stood, orders);
  else
    context.pool.forEach(int(groups.size()), [&](int i, int) {
      for (const Domain* domain : groups[i]) drawChunk(context, stood, orders, {domain, domain->box});
    });
  if (context.parameters.frustum_height_q > 0) findLowest(context);  // for what it hides; nobody asks for the lowest
}

}  // namespace spoor
