// Calls every rule with numbers drawn from a seed and folds what comes back: one text, run by C++ and by GLSL.
#ifndef SPOOR_TESTS_RULES_PROBE_H
#define SPOOR_TESTS_RULES_PROBE_H
#include "../shaders/rules/displace.h"
#include "../shaders/rules/exchange.h"
#include "../shaders/rules/mix.h"
#include "../shaders/rules/nearest.h"
#include "../shaders/rules/penetration.h"
#include "../shaders/rules/raster.h"

SPOOR_RULES_BEGIN

RULE_CONST kProbeCount = 11;

/// A number in [low, high] for draw `i` of a seed; high - low < 2^31.
RULE int drawn(int seed, int i, int low, int high) {
  return low + int((mix32(uint(seed) * 0x9e3779b1u + uint(i)) >> 1) % uint(high - low + 1));
}
RULE int folded(int sum, int value) { return int(mix32(uint(sum) ^ uint(value))); }
RULE int foldedWide(int sum, wide value) {
  wide high = wideFloorDiv(value, wideMul(1 << 16, 1 << 16));
  return folded(folded(sum, wideLow(value)), wideLow(high));
}

RULE int probeWide(int seed) {
  int a = drawn(seed, 1, -1073741823, 1073741823);
  int b = drawn(seed, 2, -1073741823, 1073741823);
  int c = drawn(seed, 3, -65536, 65536);
  int shift = drawn(seed, 4, 0, 29);
  wide product = wideMul(a, b);
  int sum = foldedWide(seed, product);
  sum = foldedWide(sum, wideAdd(product, wideMul(b, c)));
  sum = foldedWide(sum, wideSub(product, wideMul(a, c)));
  sum = foldedWide(sum, wideTimes(wideMul(a >> 8, c), c >> 8));
  sum = foldedWide(sum, wideFloorDiv(product, wideFrom(maxInt(c, 1))));
  sum = foldedWide(sum, wideFloorDiv(product, wideAdd(wideMul(maxInt(b, 1), 1 << shift), wideFrom(1))));
  sum = folded(sum, wideClamp(product, -1000000000, 1000000000));
  return folded(sum, floorDiv(a, maxInt(c, 1)));
}

RULE RasterPoint drawnPoint(int seed, int i, int reach) {
  RasterPoint p;
  p.x = drawn(seed, i, -reach, reach);
  p.y = drawn(seed, i + 1, -reach, reach);
  p.z = drawn(seed, i + 2, -524288, 524287);
  return p;
}

RULE int probeTriangle(int seed) {
  int reach = 1 << drawn(seed, 20, 6, 18);
  RasterTriangle t =
      rasterTriangle(drawnPoint(seed, 21, reach), drawnPoint(seed, 24, reach), drawnPoint(seed, 27, reach));
  int sum = foldedWide(foldedWide(folded(folded(seed, t.step), t.step_fraction), t.slope_x), t.slope_y);
  if (wideZero(t.area)) return sum;
  RasterSpan whole;
  whole.begin = -2048;
  whole.end = 2048;
  int row = drawn(seed, 30, floorDiv(-reach, kSubcells), floorDiv(reach, kSubcells));
  RasterSpan span = triangleSpan(t, row, whole);
  sum = folded(folded(sum, span.begin), span.end);
  if (span.end <= span.begin) return sum;
  int first = triangleHeight(t, span.begin, row);
  return folded(folded(sum, first),
                triangleHeightAlong(first, t.step, t.step_fraction, span.end - span.begin - 1, t.lowest, t.highest));
}

RULE int probeEdge(int seed) {
  int reach = 1 << drawn(seed, 40, 4, 18);
  RasterEdge e = rasterEdge(drawnPoint(seed, 41, reach), drawnPoint(seed, 44, reach));
  int column = drawn(seed, 47, floorDiv(e.u0, kSubcells), floorDiv(e.u1, kSubcells));
  EdgeColumn cells = edgeColumn(e, column);
  return folded(folded(folded(seed, cells.first), cells.last), cells.height);
}

/// Result number `which` (0 .. kProbeCount - 1) for a seed.
RULE int probeRule(int which, int seed) {
  int height_a = drawn(seed, 60, -kHeightLimit, kHeightLimit);
  int height_b =
      (seed & 1) != 0 ? drawn(seed, 61, -kHeightLimit, kHeightLimit) : height_a + drawn(seed, 61, -2000, 2000);
  height_b = clampInt(height_b, -kHeightLimit, kHeightLimit);
  int small = drawn(seed, 62, 0, 5000);
  int threshold = drawn(seed, 63, 1, 2000);
  if (which == 0) return probeWide(seed);
  if (which == 1) return probeTriangle(seed);
  if (which == 2) return probeEdge(seed);
  if (which == 3) return int(cellMixLow(cellKey(height_a, height_b, seed & 3), small));
  if (which == 4) return int(cellMixHigh(cellKey(height_a, height_b, seed & 3), small));
  if (which == 5)
    return pairFlow(height_a, height_b, threshold, small, drawn(seed, 64, 0, 5000), drawn(seed, 65, 0, kHeightLimit),
                    drawn(seed, 66, 0, 500));
  if (which == 6) return roomBeneath(height_a, height_b, threshold);
  if (which == 7)
    return return cellOverlap(height_a, height_a - minInt(small, height_a + kHeightLimit), height_b,
                              drawn(seed, 95, -kHeightLimit, kHeightLimit), threshold);
  if (which == 8)
    return nearestSwitch(small, drawn(seed, 67, -3000, 0), drawn(seed, 68, -3000, 3000), drawn(seed, 69, 1, 3000),
                         drawn(seed, 70, -3000, 3000));
  if (which == 9)
    return nearestBefore(small, threshold, threshold, drawn(seed, 71, 0, 40), drawn(seed, 72, 0, 40), small,
                         drawn(seed, 75, 0, 2))
               ? 1
               : 0;
  int request = drawn(seed, 73, 1, kHeightLimit);
  return grantedShare(request, drawn(seed, 74, 0, kHeightLimit), wideAdd(wideFrom(request), wideMul(small, threshold)));
}

SPOOR_RULES_END

#endif
