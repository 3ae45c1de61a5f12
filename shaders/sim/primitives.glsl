// Triangles and edges of bodies in their poses, and how they lower undersides.
#ifndef SPOOR_SIM_PRIMITIVES_GLSL
#define SPOOR_SIM_PRIMITIVES_GLSL
#include "../rules/raster.h"
#include "domains.glsl"

layout(std430, binding = kBindUnderside) buffer Underside { int underside[]; };
layout(std430, binding = kBindBodies) readonly buffer Bodies { BodyEntry bodies[]; };
layout(std430, binding = kBindPoints) readonly buffer Points { int points[]; };
layout(std430, binding = kBindIndices) readonly buffer Indices { int indices[]; };

/// A primitive in its body, with the rows of cells it lies in, out of the body's; for an edge along x, the columns.
struct Primitive {
  bool is_edge;
  bool along_y;
  RasterPoint a;
  RasterPoint b;
  RasterPoint c;
  int first;
  int end;
  int origin_x;
  int origin_y;
  int z;
  ivec4 box;  // x0, y0, x1, y1
  TileGrid grid;
};

RasterPoint pointAt(int first, int index) {
  int from = 3 * (first + index);
  return RasterPoint(points[from], points[from + 1], points[from + 2]);
}

/// Primitive `i` of a body: its triangles, then its edges.
Primitive primitiveAt(int body, int i) {
  Primitive p;
  p.origin_x = bodies[body].origin_x;
  p.origin_y = bodies[body].origin_y;
  p.z = bodies[body].z;
  p.box = ivec4(bodies[body].x0, bodies[body].y0, bodies[body].x1, bodies[body].y1);
  p.grid = tileGrid(bodies[body].domain);
  int triangle_count = bodies[body].triangle_count;
  p.is_edge = i >= triangle_count;
  int at = p.is_edge ? bodies[body].first_edge + 2 * (i - triangle_count) : bodies[body].first_triangle + 3 * i;
  int first_point = bodies[body].first_point;
  p.a = pointAt(first_point, indices[at]);
  p.b = pointAt(first_point, indices[at + 1]);
  p.c = p.b;
  p.along_y = true;
  if (p.is_edge)
    p.along_y = rasterEdge(p.a, p.b).along_y != 0;
  else
    p.c = pointAt(first_point, indices[at + 2]);
  ivec2 low = ivec2(min(p.a.x, min(p.b.x, p.c.x)), min(p.a.y, min(p.b.y, p.c.y)));
  ivec2 high = ivec2(max(p.a.x, max(p.b.x, p.c.x)), max(p.a.y, max(p.b.y, p.c.y)));
  RasterSpan rows;
  if (p.is_edge) {
    rows.begin = floorDiv(p.along_y ? low.y : low.x, kSubcells);
    rows.end = floorDiv(p.along_y ? high.y : high.x, kSubcells) + 1;
  } else {
    rows = centresBetween(low.y, high.y);
    RasterSpan columns = centresBetween(low.x, high.x);
    if (columns.end <= columns.begin) rows.end = rows.begin;
  }
  p.first = max(rows.begin + (p.along_y ? p.origin_y : p.origin_x), p.along_y ? p.box.y : p.box.x);
  p.end = min(rows.end + (p.along_y ? p.origin_y : p.origin_x), p.along_y ? p.box.w : p.box.z);
  return p;
}

void lower(int at, int reached) {
  if (underside[at] > reached) atomicMin(underside[at], reached);
}

void drawTriangleRow(Primitive p, RasterTriangle t, int y) {
  RasterSpan whole = RasterSpan(p.box.x - p.origin_x, p.box.z - p.origin_x);
  int row = y - p.origin_y;
  RasterSpan span = triangleSpan(t, row, whole);
  if (span.end <= span.begin) return;
  int first = heightInWorld(p.z, triangleHeight(t, span.begin, row));
  int lowest = heightInWorld(p.z, t.lowest);
  int highest = heightInWorld(p.z, t.highest);
  int x = p.origin_x + span.begin;
  int count = span.end - span.begin;
  for (int i = 0; i < count;) {
    int at = tileCell(p.grid, x + i, y);
    int stop = min(count, i + kTileSize - (x + i) % kTileSize);  // up to the tile's border
    for (; i < stop; ++i) lower(at++, triangleHeightAlong(first, t.step, t.step_fraction, i, lowest, highest));
  }
}

/// `u`: a row where the edge runs along y, else a column.
void drawEdgeColumn(Primitive p, RasterEdge e, int u) {
  EdgeColumn column = edgeColumn(e, u - (p.along_y ? p.origin_y : p.origin_x));
  int v_origin = p.along_y ? p.origin_x : p.origin_y;
  int first = max(column.first + v_origin, p.along_y ? p.box.x : p.box.y);
  int last = min(column.last + v_origin, (p.along_y ? p.box.z : p.box.w) - 1);
  int reached = heightInWorld(p.z, column.height);
  for (int v = first; v <= last; ++v) lower(tileCell(p.grid, p.along_y ? v : u, p.along_y ? u : v), reached);
}

/// Draws rows (or columns) begin..end - 1, every `stride`-th.
void drawRows(Primitive p, int begin, int end, int stride) {
  if (p.is_edge) {
    RasterEdge e = rasterEdge(p.a, p.b);
    for (int u = begin; u < end; u += stride) drawEdgeColumn(p, e, u);
  } else {
    RasterTriangle t = rasterTriangle(p.a, p.b, p.c);
    if (wideZero(t.area)) return;
    for (int y = begin; y < end; y += stride) drawTriangleRow(p, t, y);
  }
}

#endif
