// Calls every rule with numbers drawn from a seed and folds what comes back: one text, run by C++ and by GLSL.
#ifndef SPOOR_TESTS_RULES_PROBE_H
#define SPOOR_TESTS_RULES_PROBE_H
#include "../shaders/rules/crater.h"
#include "../shaders/rules/crater_hash.h"
#include "../shaders/rules/displace.h"
#include "../shaders/rules/drift.h"
#include "../shaders/rules/exchange.h"
#include "../shaders/rules/flood.h"
#include "../shaders/rules/flow.h"
#include "../shaders/rules/mix.h"
#include "../shaders/rules/nearest.h"
#include "../shaders/rules/penetration.h"
#include "../shaders/rules/raster.h"
#include "../shaders/rules/slope.h"
#include "../shaders/rules/snowfall.h"

SPOOR_RULES_BEGIN

RULE_CONST kProbeCount = 27;

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

/// A number whose size is drawn too: as often small as near `most`.
RULE int drawnAmount(int seed, int i, int most) { return drawn(seed, i, 0, most) >> drawn(seed, i + 1, 0, 28); }

RULE int drawnShare(int seed, int i) {
  int share = drawn(seed, i, 0, 3);
  return share == 0 ? 0 : (share == 1 ? 65536 : drawn(seed, i + 1, 0, 65536));
}

/// A slope threshold: small, large, or one that no slope exceeds.
RULE int drawnThreshold(int seed, int i) {
  return drawn(seed, i, 0, 7) == 0 ? 2147483647 : drawnAmount(seed, i + 1, 1 << 29);
}

RULE int probePenetration(int seed) {
  int soil = drawnAmount(seed, 80, 1073741823);
  int overlap = drawn(seed, 82, 0, soil);
  int compacted = drawnAmount(seed, 83, kHeightLimit);
  int compression = drawnShare(seed, 85);
  int limit = drawnShare(seed, 87);
  int sum = folded(seed, compactedShare(overlap, soil, compacted, compression, limit));
  sum = folded(sum, timesQ16(overlap, compression));
  int bedrock = drawn(seed, 89, -kHeightLimit, kHeightLimit);
  int underside = clampInt(bedrock + drawn(seed, 90, -5000, 5000), -kHeightLimit, kNoUnderside);
  if (drawn(seed, 91, 0, 3) == 0) underside = drawn(seed, 91, 0, 1) == 0 ? -kHeightLimit : kNoUnderside;
  return folded(sum, seenUnderside(underside, bedrock, drawnAmount(seed, 92, 5000)));
}

RULE int probeNearest(int seed) {
  int metric = drawn(seed, 100, 0, 2);
  int dx = drawn(seed, 101, -16384, 16384);
  int dy = drawn(seed, 102, -16384, 16384);
  int sum = folded(seed, metricDistance(dx, dy, metric));
  int row = drawn(seed, 103, 0, 16383);
  int beneath = drawn(seed, 104, 0, 2) == 0 ? kNoFreeRow : drawn(seed, 105, 0, row);
  int above = drawn(seed, 106, 0, 2) == 0 ? kNoFreeRow : drawn(seed, 107, row, 16383);
  return folded(sum, nearestInColumn(row, beneath, above));
}

RULE int probeFlood(int seed) {
  int metric = drawn(seed, 110, 0, 2);
  int order = floodOrder(drawn(seed, 111, 0, 1 << 20), drawn(seed, 112, 0, 1 << 20));
  int sum = folded(seed, order);
  for (int k = 0; k < 8; ++k) {
    int direction = floodNeighbour(order, k);
    sum = folded(folded(sum, neighbourX(direction)), neighbourY(direction));
  }
  bool known = drawn(seed, 113, 0, 3) != 0;
  return folded(sum, floodTakes(known, drawn(seed, 114, -40, 40), drawn(seed, 115, -40, 40), drawn(seed, 116, -40, 40),
                                drawn(seed, 117, -40, 40), metric)
                         ? 1
                         : 0);
}

RULE int probeSpread(int seed) {
  int overlap = 1 + drawnAmount(seed, 120, kHeightLimit - 1);
  int count = spreadTargets(overlap, 1 + drawnAmount(seed, 122, (1 << 29) - 1), drawn(seed, 124, 1, 64));
  int longest = 1 + drawnAmount(seed, 125, 16383);
  int d = drawn(seed, 127, -longest, longest);
  int sum = folded(folded(seed, count), spreadOffset(d, longest, drawn(seed, 128, 1, 64)));
  return folded(sum, spreadPart(overlap, count, drawn(seed, 129, 0, count - 1)));
}

RULE int probeFlow(int seed) {
  int count = drawn(seed, 130, 0, 8);
  int ground = drawn(seed, 131, -kHeightLimit, kHeightLimit);
  int carried = drawnAmount(seed, 132, kHeightLimit - maxInt(ground, 0));
  int underside = clampInt(ground + carried + drawn(seed, 134, -900, 900), -kHeightLimit, kNoUnderside);
  int sum = folded(seed, flowOffer(carried, count));
  return folded(sum, flowRoom(drawn(seed, 135, -1, 1), ground, carried, underside, drawn(seed, 136, 0, 900)));
}

RULE int probeSlope(int seed, int height_a, int height_b) {
  int threshold = drawnThreshold(seed, 140);
  int roughness = drawnShare(seed, 143);
  int soil = drawnAmount(seed, 145, 1073741823);
  int room = drawnAmount(seed, 147, 1073741823);
  int sum = folded(seed, exchangeThreshold(threshold));
  sum = folded(sum, slopeGives(height_a - height_b, threshold, room) ? 1 : 0);
  int count = drawn(seed, 149, 0, 8);
  sum = folded(sum, slopeAmount(count * drawnAmount(seed, 150, kDifferenceMost), count, roughness, soil));
  sum = folded(sum, slopeFlow(soil, room));
  return folded(
      sum, slopeFlux(height_a, height_b, threshold, drawnThreshold(seed, 156), roughness, drawnShare(seed, 159), soil,
                     drawnAmount(seed, 152, 1073741823), room, drawnAmount(seed, 154, 1073741823)));
}

/// All 64 bits, without a division.
RULE int foldedHalves(int sum, wide value) { return folded(folded(sum, wideLow(value)), wideLow(wideDown(value, 32))); }

RULE int probeFraction(int seed) {
  uint bits = mix32(uint(seed) * 0x85ebca77u + 160u);
  uint more = mix32(bits);
  uint shift = uint(drawn(seed, 161, 0, 31));
  int sum = folded(seed, int(reciprocal(bits | 0x80000000u)));
  sum = folded(sum, int(reciprocalRoot(bits >= 0x40000000u ? bits : bits | 0x40000000u)));
  sum = folded(sum, int(rootQ31(more >> shift)));
  sum = folded(sum, int(eighthTurn(more)));
  sum = folded(folded(sum, topBit(more >> shift)), int(mulHigh(bits, more)));
  int reach = 1 << drawn(seed, 162, 0, 24);
  return folded(sum, int(turnOf(drawn(seed, 163, -reach, reach), drawn(seed, 164, -reach, reach))));
}

RULE int probeScaled(int seed) {
  wide value = wideMul(drawnAmount(seed, 170, 2147483646), drawnAmount(seed, 172, 2147483646));
  wide negative = wideMul(drawn(seed, 174, -1073741823, 1073741823), drawn(seed, 175, -1073741823, 1073741823));
  int places = drawn(seed, 176, 0, 63);
  int sum = foldedHalves(foldedHalves(seed, wideUp(negative, places)), wideDown(negative, places));
  Scaled scaled = scaledFrom(value);
  sum = folded(folded(sum, int(scaled.mantissa)), scaled.exponent);
  sum = folded(sum, wideTop(value));
  return wideZero(value) ? sum : folded(sum, int(scaledTo(value, scaled.exponent + drawn(seed, 177, 0, 2))));
}

/// A crater of any size, often one that is only just allowed.
RULE CraterShape drawnCrater(int seed) {
  int crest = 1 + drawnAmount(seed, 180, kCraterReachLimit - 1);
  int kind = drawn(seed, 182, 0, 3);
  int inner = kind == 0 ? 0 : (kind == 1 ? crest : drawn(seed, 183, 0, crest));
  inner = maxInt(inner, 2 * crest - kCraterReachLimit);
  int rim = drawn(seed, 184, 0, 3) == 0 ? kCraterHeightLimit : drawnAmount(seed, 185, kCraterHeightLimit);
  int depth = drawn(seed, 187, 0, 3) == 0 ? kCraterHeightLimit : drawnAmount(seed, 188, kCraterHeightLimit);
  int noise = drawn(seed, 190, 0, 2);
  noise = noise == 0 ? 0 : (noise == 1 ? 65535 : drawn(seed, 191, 0, 65535));
  return craterShape(drawn(seed, 192, -1000000, 1000000), drawn(seed, 193, -1000000, 1000000), inner, crest, rim, depth,
                     drawn(seed, 194, 0, 65535), noise, drawn(seed, 195, 0, 1 << 20));
}

RULE int probeCraterShape(int seed) {
  CraterShape c = drawnCrater(seed);
  int sum = folded(folded(folded(folded(seed, c.x), c.y), c.inner), c.crest);
  sum = folded(folded(folded(folded(sum, c.outer), c.rim), c.depth), c.amplitude);
  sum = folded(folded(folded(sum, int(c.seed)), int(c.square_part)), c.square_exponent);
  sum = folded(folded(folded(sum, int(c.band_part)), c.band_exponent), int(c.band_share));
  return folded(folded(sum, c.id), c.reserved);
}

RULE int probeCraterNoise(int seed) {
  uint bits = mix32(uint(seed) * 0x85ebca77u + 200u);
  int turn = drawn(seed, 201, 0, 3);  // one in two at the seam
  return craterNoise(bits, turn == 0 ? 0u : (turn == 1 ? 0xffffffffu : mix32(bits)), mix32(bits + 1u) >> 1);
}

/// Anywhere in its square, near the crest, near its end, on an axis, or far beyond.
RULE int probeCrater(int seed) {
  CraterShape c = drawnCrater(seed);
  int sum = seed;
  for (int i = 0; i < 6; ++i) {
    int dx = drawn(seed, 210 + 8 * i, -c.outer, c.outer), dy = drawn(seed, 211 + 8 * i, -c.outer, c.outer);
    if (i == 1 || i == 2) dx = c.crest + drawn(seed, 212 + 8 * i, -2, 2);
    if (i == 3) dx = c.outer - drawn(seed, 213 + 8 * i, 0, 2);
    if (i == 1 || i == 3) dy = drawn(seed, 214 + 8 * i, -1, 1);
    if (i == 4) dx = drawn(seed, 215 + 8 * i, -1073741823, 1073741823);
    if (i == 5) dx = dx >> drawn(seed, 216 + 8 * i, 0, 23);
    if (i == 5) dy = dy >> drawn(seed, 217 + 8 * i, 0, 23);
    sum = folded(sum, craterDisplacement(c, dx, dy));
  }
  return sum;
}

RULE int probeCraterSum(int seed) {
  CraterSum sum = craterSumOfNone();
  for (int i = 0; i < 6; ++i) {
    int reach = 1 << drawn(seed, 260 + 4 * i, 0, 29);
    sum = withCrater(sum, drawn(seed, 261 + 4 * i, -reach, reach), drawnAmount(seed, 262 + 4 * i, kCraterHeightLimit));
  }
  int total = craterTotal(sum);
  int bedrock = drawn(seed, 290, -kHeightLimit, 0);
  int height = drawn(seed, 291, bedrock, kHeightLimit);
  int result = folded(folded(folded(folded(seed, sum.depth), sum.rims), sum.highest), total);
  return folded(result, craterGround(height, bedrock, total));
}

RULE int probeCraterHash(int seed) {
  int side = 1 + drawnAmount(seed, 300, 1 << 29);
  int size = 1 + drawnAmount(seed, 302, 2147483646);
  int outer = 1 + drawnAmount(seed, 304, kCraterReachLimit - 1);
  int centre =
      drawn(seed, 306, 0, 3) == 0 ? maxInt(0, size - drawn(seed, 307, 1, 9)) : drawn(seed, 307, -outer, 2130706431);
  int first = craterFirstCell(centre, outer, side), last = craterLastCell(centre, outer, side, size);
  int sum = folded(folded(seed, first), last);
  sum = folded(sum, craterBucket(first, last, (1 << drawn(seed, 309, 0, 30)) - 1));
  return folded(folded(sum, int(craterTag(first, last))), craterCapacity(drawnAmount(seed, 310, 1 << 30)));
}

RULE DriftStep drawnStep(int seed) {
  DriftStep step;
  step.weights = drawn(seed, 320, 0, 2);
  step.step = 1 + drawnAmount(seed, 321, 65535);
  step.quarter = 1 + drawnAmount(seed, 323, (1 << 29) - 1);
  step.shift = 30 - topBit(uint(step.quarter));
  step.inverse_quarter = reciprocal(uint(step.quarter) << uint(step.shift + 1)) >> 1u;  // near enough
  return step;
}

RULE DriftCell drawnDriftCell(int seed, int i, int height) {
  DriftCell cell;
  cell.height = height;
  cell.soil = drawnAmount(seed, i, 1073741823);
  cell.room = drawn(seed, i + 2, 0, 1) == 0 ? 2147483646 : drawnAmount(seed, i + 3, 2147483646);
  cell.rest = 1 + drawnAmount(seed, i + 5, drawn(seed, i + 7, 0, 1) == 0 ? 62258 : 2147483645);
  cell.rate = drawn(seed, i + 8, 0, 3) == 0 ? 1 << 14 : drawnAmount(seed, i + 9, 1 << 14);
  cell.inverse = 0xffffffffu / uint(maxInt(65536 - cell.rest, 1));
  return cell;
}

RULE int probeDrift(int seed, int height_a, int height_b) {
  DriftStep step = drawnStep(seed);
  DriftCell a = drawnDriftCell(seed, 330, height_a), b = drawnDriftCell(seed, 342, height_b);
  int push = drawn(seed, 354, 0, 2) == 0 ? 0 : drawn(seed, 355, -kDriftMost, kDriftMost) >> drawn(seed, 356, 0, 22);
  int moved = drawnAmount(seed, 357, 2147483646);
  uint phase = driftPhase(drawnAmount(seed, 359, 1 << 30), drawn(seed, 361, 0, 1000));
  int dither = driftDither(drawn(seed, 362, 0, 1 << 24), drawn(seed, 363, 0, 1 << 24), drawn(seed, 364, 0, 1), phase);
  int sum = folded(folded(seed, int(phase)), dither);
  sum = folded(sum, timesQ8(drawnAmount(seed, 365, kDriftMost), drawnShare(seed, 367)));
  sum = folded(sum, withSign(moved, push));
  sum = folded(sum, driftWeight(step, moved, minInt(a.rest, 62259), a.inverse));
  return folded(sum, driftFlow(step, a, b, push, dither));
}

RULE int probePush(int seed) {
  wide total = wideMul(drawnAmount(seed, 370, 1 << 26), drawnAmount(seed, 372, 1000000));
  int most = (1 << 30) / drawn(seed, 374, 1, 64);
  int strength = pushStrength(total, drawnAmount(seed, 375, 1 << 24), most);
  int direction = drawn(seed, 377, 0, 3) == 0 ? 1 << 30 : drawn(seed, 378, -1073741823, 1073741823);
  int along = pushAlong(strength, direction);
  int sum = folded(folded(seed, strength), along);
  sum = folded(sum, pushedSoil(along, drawnAmount(seed, 379, 2147483646) + 1));
  int height = drawn(seed, 381, -kHeightLimit, kHeightLimit);
  int underside = drawn(seed, 382, 0, 3) == 0
                      ? kNoUnderside
                      : clampInt(height + drawn(seed, 383, -900, 900), -kHeightLimit, kNoUnderside);
  return folded(sum, isContact(height, underside, drawn(seed, 384, 0, 900)) ? 1 : 0);
}

RULE int probeSnow(int seed) {
  SnowDepth depth;
  depth.layers = drawnAmount(seed, 390, 1 << 23);
  depth.share = mix32(uint(seed) * 0x85ebca77u + 392u) << uint(drawn(seed, 393, 0, 1) * 31);
  uint snow_seed = mix32(uint(seed) + 7u);
  int x = drawn(seed, 394, 0, 1 << 24), y = drawn(seed, 395, 0, 1 << 24);
  int fallen = snowOn(snow_seed, x, y, depth);
  int sum = folded(folded(seed, snowFlake(snow_seed, x, y, depth)), fallen);
  return folded(sum, snowGround(drawn(seed, 396, -kHeightLimit, kHeightLimit), fallen));
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
    return pairFlow(height_a, height_b, threshold, drawn(seed, 59, 1, 2000), small, drawn(seed, 64, 0, 5000),
                    drawn(seed, 65, 0, kHeightLimit), drawn(seed, 66, 0, 500));
  if (which == 6) return roomBeneath(height_a, height_b, threshold);
  if (which == 7)
    return cellOverlap(height_a, height_a - minInt(small, height_a + kHeightLimit), height_b,
                       drawn(seed, 95, -kHeightLimit, kHeightLimit), threshold);
  if (which == 8)
    return nearestSwitch(small, drawn(seed, 67, -3000, 0), drawn(seed, 68, -3000, 3000), drawn(seed, 69, 1, 3000),
                         drawn(seed, 70, -3000, 3000));
  if (which == 9)
    return nearestBefore(small, threshold, threshold, drawn(seed, 71, 0, 40), drawn(seed, 72, 0, 40), small,
                         drawn(seed, 75, 0, 2))
               ? 1
               : 0;
  if (which == 10) return probePenetration(seed);
  if (which == 11) return probeNearest(seed);
  if (which == 12) return probeFlood(seed);
  if (which == 13) return probeSpread(seed);
  if (which == 14) return probeFlow(seed);
  if (which == 15) return probeSlope(seed, height_a, height_b);
  if (which == 16) return probeFraction(seed);
  if (which == 17) return probeScaled(seed);
  if (which == 18) return probeCraterShape(seed);
  if (which == 19) return probeCraterNoise(seed);
  if (which == 20) return probeCrater(seed);
  if (which == 21) return probeCraterSum(seed);
  if (which == 22) return probeCraterHash(seed);
  if (which == 23) return probeDrift(seed, height_a, height_b);
  if (which == 24) return probePush(seed);
  if (which == 25) return probeSnow(seed);
  int request = drawn(seed, 73, 1, kHeightLimit);
  return grantedShare(request, drawn(seed, 74, 0, kHeightLimit), wideAdd(wideFrom(request), wideMul(small, threshold)));
}

SPOOR_RULES_END

#endif
