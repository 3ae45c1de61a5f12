// Triangles and edges of bodies in their poses, and how they lower undersides.
#ifndef SPOOR_SIM_PRIMITIVES_GLSL
#define SPOOR_SIM_PRIMITIVES_GLSL
#include "../rules/raster.h"
#include "domains.glsl"

layout(std430, binding = kBindUnderside) buffer Underside { int underside[]; };
layout(std430, binding = kBindBodies) readonly buffer Bodies { BodyEntry bodies[]; };
layout(std430, binding = kBindPoints) readonly buffer Points { int points[]; };
layout(std430, binding = kBindIndices) readonly buffer Indices { int indices[]; };

/// A primitive: its points, and the rows of cells it lies in, out of its body's; for an edge along x, the columns.
struct Primitive {
  int body;
  bool is_edge;
  RasterPoint a;
  RasterPoint b;
  RasterPoint c;
  bool along_y;
  int first;
  int last;
};

RasterPoint pointAt(int body, int index) {
  int from = 3 * (bodies[body].first_point + index);
  return RasterPoint(points[from], points[from + 1], points[from + 2]);
}

/// Primitive `i` of a body: its triangles, then its edges.
Primitive primitiveAt(int body, int i) {
  Primitive p;
  p.body = body;
  p.is_edge = i >= bodies[body].triangle_count;
  p.along_y = true;
  if (p.is_edge) {
    int at = bodies[body].first_edge + 2 * (i - bodies[body].triangle_count);
    p.a = pointAt(body, indices[at]);
    p.b = pointAt(body, indices[at + 1]);
    p.c = p.b;
    p.along_y = rasterEdge(p.a, p.b).along_y != 0;
  } else {
    int at = bodies[body].first_triangle + 3 * i;
    p.a = pointAt(body, indices[at]);
    p.b = pointAt(body, indices[at + 1]);
    p.c = pointAt(body, indices[at + 2]);
  }
  int low = p.along_y ? min(p.a.y, min(p.b.y, p.c.y)) : min(p.a.x, min(p.b.x, p.c.x));
  int high = p.along_y ? max(p.a.y, max(p.b.y, p.c.y)) : max(p.a.x, max(p.b.x, p.c.x));
  int origin = p.along_y ? bodies[body].origin_y : bodies[body].origin_x;
  p.first = max(floorDiv(low, kSubcells) + origin, p.along_y ? bodies[body].y0 : bodies[body].x0);
  p.last = min(floorDiv(high, kSubcells) + origin, (p.along_y ? bodies[body].y1 : bodies[body].x1) - 1);
  return p;
}

void lower(int at, int reached) {
  if (underside[at] > reached) atomicMin(underside[at], reached);
}

void drawTriangleRow(Primitive p, RasterTriangle t, int y) {
  int body = p.body;
  int domain = bodies[body].domain;
  RasterSpan whole = RasterSpan(bodies[body].x0 - bodies[body].origin_x, bodies[body].x1 - bodies[body].origin_x);
  int row = y - bodies[body].origin_y;
  RasterSpan span = triangleSpan(t, row, whole);
  if (span.end <= span.begin) return;
  int first = heightInWorld(bodies[body].z, triangleHeight(t, span.begin, row));
  int lowest = heightInWorld(bodies[body].z, t.lowest);
  int highest = heightInWorld(bodies[body].z, t.highest);
  int x = bodies[body].origin_x + span.begin;
  int count = span.end - span.begin;
  for (int i = 0; i < count;) {
    int at = tileCell(domain, x + i, y);
    int stop = min(count, i + kTileSize - (x + i) % kTileSize);  // up to the tile's border
    for (; i < stop; ++i) lower(at++, triangleHeightAlong(first, t.step, t.step_fraction, i, lowest, highest));
  }
}

/// `u`: a row where the edge runs along y, else a column.
void drawEdgeColumn(Primitive p, RasterEdge e, int u) {
  int body = p.body;
  EdgeColumn column = edgeColumn(e, u - (p.along_y ? bodies[body].origin_y : bodies[body].origin_x));
  int v_origin = p.along_y ? bodies[body].origin_x : bodies[body].origin_y;
  int first = max(column.first + v_origin, p.along_y ? bodies[body].x0 : bodies[body].y0);
  int last = min(column.last + v_origin, (p.along_y ? bodies[body].x1 : bodies[body].y1) - 1);
  int domain = bodies[body].domain;
  int reached = heightInWorld(bodies[body].z, column.height);
  for (int v = first; v <= last; ++v) lower(tileCell(domain, p.along_y ? v : u, p.along_y ? u : v), reached);
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
