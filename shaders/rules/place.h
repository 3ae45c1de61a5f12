// Stage depth: where a point of a mesh lies, in subcells, once its body has a pose.
#ifndef SPOOR_RULES_PLACE_H
#define SPOOR_RULES_PLACE_H
#include "raster.h"

SPOOR_RULES_BEGIN

/// A pose as the raster needs it: the rotation in Q30, row-major (world = matrix * local), and where in its cell the
/// origin lies, 0 <= within < cell (all 0.1 mm; cell <= 10^6).
struct Placement {
  int matrix[9];
  int within_x;
  int within_y;
  int cell;
};

/// One row of matrix * point, rounded to nearest. Range: |point| < 2^30.
RULE int rotatedCoordinate(int m0, int m1, int m2, int x, int y, int z) {
  wide sum = wideAdd(wideAdd(wideMul(m0, x), wideMul(m1, y)), wideAdd(wideMul(m2, z), wideFrom(1 << 29)));
  return wideFromQ30(sum);
}

/// floor(at * kSubcells / cell). Range: |at| < 2^30, the result's magnitude < 2^22.
RULE int subcellAt(int at, int cell) {
  int whole = floorDiv(at, cell);
  return whole * kSubcells + (at - whole * cell) * kSubcells / cell;
}

/// A mesh's point relative to its body's cell and height: vertices are placed to the subcell below.
RULE RasterPoint placedPoint(Placement p, int x, int y, int z) {
  RasterPoint placed;
  placed.x = subcellAt(p.within_x + rotatedCoordinate(p.matrix[0], p.matrix[1], p.matrix[2], x, y, z), p.cell);
  placed.y = subcellAt(p.within_y + rotatedCoordinate(p.matrix[3], p.matrix[4], p.matrix[5], x, y, z), p.cell);
  placed.z = rotatedCoordinate(p.matrix[6], p.matrix[7], p.matrix[8], x, y, z);
  return placed;
}

SPOOR_RULES_END
#endif
