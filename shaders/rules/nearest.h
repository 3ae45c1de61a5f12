// Stage nearest: what "nearest" means, and the exact search for it.
// Order: smaller distance, then smaller Euclidean distance, then smaller y, then smaller x of the free cell. The column
// pass keeps, per cell, the nearest free cell of its own column (tie: smaller y), which is the first of its column in
// this order whatever the metric; the row pass picks the best column. Of two columns, seen along a row, each is before
// the other on one side of one place, so the two passes find the same cell as a search over all cells (checked against
// that search in the tests). Source: Meijster et al. 2000 (all three metrics); ties are ours.
#ifndef SPOOR_RULES_NEAREST_H
#define SPOOR_RULES_NEAREST_H
#include "limits.h"

SPOOR_RULES_BEGIN

RULE_CONST kEuclidean = 0;
RULE_CONST kManhattan = 1;
RULE_CONST kChebyshev = 2;

/// In a column without a free cell: so far away that it never wins.
RULE_CONST kNoFreeRow = -(1 << 20);

/// A number that grows with the distance of two cells (dx, dy) apart: Euclidean squared. Range: spans up to 16384
/// cells.
RULE int metricDistance(int dx, int dy, int metric) {
  if (metric == kEuclidean) return dx * dx + dy * dy;
  return metric == kManhattan ? absInt(dx) + absInt(dy) : maxInt(absInt(dx), absInt(dy));
}

/// The nearest free row of a column seen from row y, of the nearest at or beneath it and the nearest at or above it.
RULE int nearestInColumn(int y, int beneath, int above) {
  // The unset value lies beneath every row: seen from above it is far, whichever way the rows run.
  int to_above = above < 0 ? -kNoFreeRow * 2 : above - y;
  return to_above < y - beneath ? above : beneath;
}

/// Is free cell (ax, ay) before (bx, by) in the order, seen from x in row y?
RULE bool nearestBefore(int x, int y, int ax, int ay, int bx, int by, int metric) {
  int da = metricDistance(x - ax, y - ay, metric);
  int db = metricDistance(x - bx, y - by, metric);
  if (da != db) return da < db;
  da = metricDistance(x - ax, y - ay, kEuclidean);
  db = metricDistance(x - bx, y - by, kEuclidean);
  return da < db || (da == db && (ay < by || (ay == by && ax < bx)));
}

/// The first x of row y from which (bx, by) is before (ax, ay) in Euclidean distance, where ax < bx.
RULE int nearestSwitch(int y, int ax, int ay, int bx, int by) {
  int gap = (bx - ax) * (bx + ax) + (y - by) * (y - by) - (y - ay) * (y - ay);
  int twice = 2 * (bx - ax);
  int x = -floorDiv(-gap, twice);
  // Equally near at x only where the division left nothing; compared so because squares there may not fit.
  return twice * x == gap && by >= ay ? x + 1 : x;
}

SPOOR_RULES_END
#endif
