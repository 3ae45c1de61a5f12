// Stage depth: which cells a triangle or an edge covers, and how low it reaches there, in integers.
//
// Positions are subcells (kSubcells per cell side) relative to a window of at most 4096 cells; heights are relative to
// the lowest point of the body, at most 2^20 units. A triangle covers the cells whose centre lies inside it (top-left
// rule: a centre on a shared edge belongs to one triangle). An edge covers every cell that it crosses, so that a body
// thinner than a cell still presses.
// Source: Persson 2019, section 4.1.2 (an orthographic depth pass from below), with fixed-point edge functions.
#ifndef SPOOR_RULES_RASTER_H
#define SPOOR_RULES_RASTER_H
#include "limits.h"

SPOOR_RULES_BEGIN

RULE_CONST kRasterSpanCells = 4096;
RULE_CONST kRasterHeightSpan = 1 << 20;

struct RasterPoint {
  int x;
  int y;
  int z;
};

/// Height of a body's point in the world. Ranges: a valid pose's z, a point of its mesh.
RULE int heightInWorld(int body_z, int point_z) { return clampInt(body_z + point_z, -kHeightLimit, kNoUnderside); }

/// A triangle with its plane, wound so that its area is positive. area: twice the area, subcells^2.
struct RasterTriangle {
  RasterPoint a;
  RasterPoint b;
  RasterPoint c;
  wide area;
  wide slope_x;
  wide slope_y;  // height = a.z + (slope_x * (x - a.x) + slope_y * (y - a.y)) / area
  int step;
  int step_fraction;  // height per cell along x: whole units, and 1/65536 units
  int lowest;
  int highest;
};

RULE RasterTriangle rasterTriangle(RasterPoint a, RasterPoint b, RasterPoint c) {
  RasterTriangle t;
  wide area = wideSub(wideMul(b.x - a.x, c.y - a.y), wideMul(b.y - a.y, c.x - a.x));
  t.a = a;
  t.b = b;
  t.c = c;
  if (wideNegative(area)) {
    t.b = c;
    t.c = b;
    area = wideSub(wideFrom(0), area);
  }
  t.area = area;
  t.lowest = minInt(a.z, minInt(b.z, c.z));
  t.highest = maxInt(a.z, maxInt(b.z, c.z));
  t.slope_x = wideSub(wideMul(t.b.z - a.z, t.c.y - a.y), wideMul(t.c.z - a.z, t.b.y - a.y));
  t.slope_y = wideSub(wideMul(t.c.z - a.z, t.b.x - a.x), wideMul(t.b.z - a.z, t.c.x - a.x));
  t.step = 0;
  t.step_fraction = 0;
  if (!wideZero(area)) {
    wide per_cell = wideTimes(t.slope_x, kSubcells);
    // A face so steep that this clamps has at most one cell centre per row, where the step is not used.
    wide whole = wideFloorDiv(per_cell, area);
    t.step = wideClamp(whole, -kHeightLimit, kHeightLimit);
    if (wideZero(wideSub(whole, wideFrom(t.step)))) {
      wide rest = wideSub(per_cell, wideTimes(area, t.step));
      t.step_fraction = wideClamp(wideFloorDiv(wideTimes(rest, 65536), area), 0, 65535);
    }
  }
  return t;
}

/// A range of cells [begin, end); empty where end <= begin.
struct RasterSpan {
  int begin;
  int end;
};

/// The cells whose centres lie in [low, high]: a triangle covers no others in a direction in which it reaches so far.
RULE RasterSpan centresBetween(int low, int high) {
  RasterSpan span;
  span.begin = -floorDiv(kSubcells / 2 - low, kSubcells);
  span.end = floorDiv(high - kSubcells / 2, kSubcells) + 1;
  return span;
}

/// The cells of a row whose centres lie on the inner side of the edge p -> q, out of those of `span`.
RULE RasterSpan clipToEdge(RasterPoint p, RasterPoint q, int row, RasterSpan span) {
  int dx = q.x - p.x;
  int dy = q.y - p.y;
  int excludes_ties = (dy < 0 || (dy == 0 && dx < 0)) ? 0 : 1;
  // Inside where dy * (x - p.x) <= limit.
  wide limit = wideSub(wideMul(dx, row * kSubcells + kSubcells / 2 - p.y), wideFrom(excludes_ties));
  int bound = 1 << 28;
  if (dy > 0) {
    int x = p.x + wideClamp(wideFloorDiv(limit, wideFrom(dy)), -bound, bound);
    span.end = minInt(span.end, floorDiv(x - kSubcells / 2, kSubcells) + 1);
  } else if (dy < 0) {
    int x = p.x - wideClamp(wideFloorDiv(limit, wideFrom(-dy)), -bound, bound);
    span.begin = maxInt(span.begin, -floorDiv(kSubcells / 2 - x, kSubcells));
  } else if (wideNegative(limit)) {
    span.end = span.begin;
  }
  return span;
}

/// The cells of a row, out of those of `span`, whose centres the triangle covers. Its area must not be zero.
RULE RasterSpan triangleSpan(RasterTriangle t, int row, RasterSpan span) {
  return clipToEdge(t.c, t.a, row, clipToEdge(t.b, t.c, row, clipToEdge(t.a, t.b, row, span)));
}

/// Height of the triangle's plane over the centre of the cell (x, row), rounded down.
RULE int triangleHeight(RasterTriangle t, int x, int row) {
  wide along_x = wideTimes(t.slope_x, x * kSubcells + kSubcells / 2 - t.a.x);
  wide along_y = wideTimes(t.slope_y, row * kSubcells + kSubcells / 2 - t.a.y);
  int rise = wideClamp(wideFloorDiv(wideAdd(along_x, along_y), t.area), -kHeightLimit, kHeightLimit);
  return clampInt(t.a.z + rise, t.lowest, t.highest);
}

/// Height `cells` further along the span whose first cell has height `first`: at most 2 units below the plane.
RULE int triangleHeightAlong(int first, int step, int step_fraction, int cells, int lowest, int highest) {
  return clampInt(first + step * cells + ((step_fraction * cells) >> 16), lowest, highest);
}

/// An edge seen along its longer horizontal axis u (u0 <= u1); v is the other one.
struct RasterEdge {
  int u0;
  int v0;
  int z0;
  int u1;
  int v1;
  int z1;
  int along_y;
};

RULE RasterEdge rasterEdge(RasterPoint a, RasterPoint b) {
  int length_x = maxInt(a.x - b.x, b.x - a.x);
  int length_y = maxInt(a.y - b.y, b.y - a.y);
  RasterEdge e;
  e.along_y = length_y > length_x ? 1 : 0;
  int ua = e.along_y != 0 ? a.y : a.x;
  int ub = e.along_y != 0 ? b.y : b.x;
  int va = e.along_y != 0 ? a.x : a.y;
  int vb = e.along_y != 0 ? b.x : b.y;
  // A total order of the ends, so that an edge covers the same cells whichever way it is listed.
  bool swap = ub < ua || (ub == ua && (vb < va || (vb == va && b.z < a.z)));
  e.u0 = swap ? ub : ua;
  e.u1 = swap ? ua : ub;
  e.v0 = swap ? vb : va;
  e.v1 = swap ? va : vb;
  e.z0 = swap ? b.z : a.z;
  e.z1 = swap ? a.z : b.z;
  return e;
}

/// What an edge covers in one column of cells along u: cells first..last along v, and its lowest height there.
struct EdgeColumn {
  int first;
  int last;
  int height;
};

RULE int alongEdge(int start, int end, int from, int at, int to) {
  if (to == from) return minInt(start, end);
  return start + wideLow(wideFloorDiv(wideMul(end - start, at - from), wideFrom(to - from)));
}

/// Range: the column meets [u0, u1].
RULE EdgeColumn edgeColumn(RasterEdge e, int column) {
  int enter = maxInt(e.u0, column * kSubcells);
  int leave = minInt(e.u1, column * kSubcells + kSubcells - 1);
  int v_enter = alongEdge(e.v0, e.v1, e.u0, enter, e.u1);
  int v_leave = alongEdge(e.v0, e.v1, e.u0, leave, e.u1);
  EdgeColumn c;
  c.first = floorDiv(minInt(v_enter, v_leave), kSubcells);
  c.last = floorDiv(maxInt(v_enter, v_leave), kSubcells);
  c.height = minInt(alongEdge(e.z0, e.z1, e.u0, enter, e.u1), alongEdge(e.z0, e.z1, e.u0, leave, e.u1));
  return c;
}

SPOOR_RULES_END
#endif
