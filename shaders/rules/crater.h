// What an explosion does to the ground (Cossetin Neto et al., Algorithm 1): a cavity with a smooth step up to a crest,
// a circular fall outside it, radial noise over both; and what several craters do together. Lengths in 0.1 mm.
#ifndef SPOOR_RULES_CRATER_H
#define SPOOR_RULES_CRATER_H
#include "fraction.h"
#include "limits.h"
#include "mix.h"

SPOOR_RULES_BEGIN

RULE_CONST kCraterReachLimit = (1 << 23) - 1;  // R3
RULE_CONST kCraterHeightLimit = 1 << 20;       // H4 and D5
RULE_CONST kCraterSumLimit = (1 << 29) - 1;    // of depths, and of rims, at a cell: deeper than any soil
RULE_CONST kNoiseSpokes = 12;                  // lattice cells round the centre, of the first octave
RULE_CONST kNoiseBits = 27;                    // of fractions in the noise
RULE_CONST kNoiseOne = 1 << kNoiseBits;

/// A crater ready to be evaluated: its record and what follows from it. All 4-byte, so that both languages lay it out
/// alike.
struct CraterShape {
  int x;                // centre
  int y;                //
  int inner;            // R1
  int crest;            // R2
  int outer;            // R3 = 2 R2 - R1: nothing changes beyond it
  int rim;              // H4 at the crest
  int depth;            // D5 at the centre
  int amplitude;        // of the noise, in 1/256 units
  uint seed;            // of the noise
  uint square_part;     // 1 / R2^2: reciprocal() of its mantissa ..
  int square_exponent;  // .. and the exponent of R2^2
  uint band_part;       // the same of R3 - R2
  int band_exponent;    //
  uint band_share;      // (R3 - R2) / R2, Q31
  int id;               // of its record
  int reserved;         // 0
};

/// @param noise_q16  amplitude as a share of rim + depth, 0 .. 65535
/// Ranges: 0 <= inner <= crest, 1 <= crest, outer <= kCraterReachLimit, 0 <= rim, depth <= kCraterHeightLimit.
RULE CraterShape craterShape(int x, int y, int inner, int crest, int rim, int depth, int seed, int noise_q16, int id) {
  CraterShape shape;
  shape.x = x;
  shape.y = y;
  shape.inner = inner;
  shape.crest = crest;
  shape.outer = 2 * crest - inner;
  shape.rim = rim;
  shape.depth = depth;
  shape.amplitude = timesQ16((rim + depth) << 8, noise_q16);
  shape.seed = mix32(uint(seed) + 0x3c6ef372u);
  Scaled square = scaledFrom(wideMul(crest, crest));
  shape.square_part = reciprocal(square.mantissa);
  shape.square_exponent = square.exponent;
  Scaled band = scaledFrom(wideFrom(maxInt(crest - inner, 1)));
  shape.band_part = reciprocal(band.mantissa);
  shape.band_exponent = band.exponent;
  Scaled radius = scaledFrom(wideFrom(crest));
  shape.band_share = mulHigh(uint(crest - inner) << uint(-radius.exponent), reciprocal(radius.mantissa));
  shape.id = id;
  shape.reserved = 0;
  return shape;
}

/// Offset from a lattice point times its gradient, which is one of (+-1, +-1/2), (+-1/2, +-1). Q27. Without branches,
/// as all of the noise, so that loops over it are vectorised.
RULE int noiseSlope(uint seed, int spoke, int ring, int du, int dv) {
  uint drawn = mix32(seed + uint(spoke) * 0x9e3779b1u + uint(ring) * 0x85ebca77u) >> 29;
  int flip_u = -int(drawn & 1u), flip_v = -int(drawn >> 1 & 1u), half_v = int(drawn >> 2);
  int u = (du ^ flip_u) - flip_u;
  int v = (dv ^ flip_v) - flip_v;
  return (u >> (1 - half_v)) + (v >> half_v);
}

/// a + (b - a) * part / 2^27, rounded down. |a|, |b| < 2^29.
RULE int noiseBlend(int a, int b, int part) { return a + wideLow(wideDown(wideMul(b - a, part), kNoiseBits)); }

/// Smooth step of a fraction 0 <= t < 1, Q27: 3 t^2 - 2 t^3.
RULE int noiseFade(int t) {
  uint part = uint(t) << (32 - kNoiseBits);
  return int(mulHigh(mulHigh(part, part), (3u << kNoiseBits) - (uint(t) << 1)));
}

/// One octave of gradient noise (Perlin 1985) in polar coordinates, periodic in `around`.
/// @param around  lattice cells round the centre, Q27, below spokes * 2^27
/// @param out     lattice cells from the centre, Q27
RULE int noiseOctave(uint seed, int spokes, uint around, uint out_q27) {
  int spoke = int(around >> kNoiseBits);
  int next = (spoke + 1) * int(spoke + 1 != spokes);
  int ring = int(out_q27 >> kNoiseBits);
  int u = int(around & uint(kNoiseOne - 1));
  int v = int(out_q27 & uint(kNoiseOne - 1));
  int part = noiseFade(u);
  int within = noiseBlend(noiseSlope(seed, spoke, ring, u, v), noiseSlope(seed, next, ring, u - kNoiseOne, v), part);
  int without = noiseBlend(noiseSlope(seed, spoke, ring + 1, u, v - kNoiseOne),
                           noiseSlope(seed, next, ring + 1, u - kNoiseOne, v - kNoiseOne), part);
  return noiseBlend(within, without, noiseFade(v));
}

/// Radial noise: two octaves, in Q27, -1 .. 1.
/// @param turn    angle about the centre; without a seam at the full turn
/// @param radius  distance from the centre by R2, Q30, 0 .. 2
RULE int craterNoise(uint seed, uint turn, uint radius) {
  int first = noiseOctave(seed, kNoiseSpokes, mulHigh(turn, uint(kNoiseSpokes) << kNoiseBits), radius >> 1);
  int second =
      noiseOctave(seed + 0x68bc21ebu, 2 * kNoiseSpokes, mulHigh(turn, uint(2 * kNoiseSpokes) << kNoiseBits), radius);
  return clampInt(first + (second >> 1), -kNoiseOne, kNoiseOne);
}

/// Where a place lies in a crater's profile.
struct CraterPlace {
  uint share;   // of the way from the bottom of its zone, R3 or the centre, to the crest: 0 .. 1 in Q29
  uint radius;  // distance from the centre by R2, Q30
};

/// Smooth step of the root of t: 3 t - 2 t^(3/2), as share.
/// @param t, root  Q31
RULE uint craterShare(uint t, uint root) { return mulHigh(t, 0xc0000000u - root); }

/// In the cavity and the inner zone, d < R2.
/// @param square  d^2
RULE CraterPlace placeInside(CraterShape shape, wide square) {
  uint t = minUint(mulHigh(scaledTo(square, shape.square_exponent), shape.square_part), 0x80000000u);
  uint root = rootQ31(t);
  CraterPlace place;
  place.share = craterShare(t, root);
  place.radius = root >> 1;
  return place;
}

/// In the outer zone, R2 <= d <= R3. There x = (d - R2) / (R3 - R2) is found as (d^2 - R2^2) / ((d + R2) (R3 - R2)): as
/// exact however near d is to R2.
/// @param square  d^2
/// @param beyond  d^2 - R2^2
RULE CraterPlace placeOutside(CraterShape shape, wide square, wide beyond) {
  int even = (wideTop(square) - 30) & ~1;  // d^2 * 2^-even is 1/4 or more as Q32
  uint a = scaledTo(square, even);
  uint distance = mulHigh(a, reciprocalRoot(a));  // d * 2^(15 - even / 2), below 2^31
  int places = 15 - (even >> 1);
  Scaled sum = scaledFrom(wideAdd(wideFrom(int(distance)), wideUp(wideFrom(shape.crest), places)));
  Scaled top = scaledFrom(beyond);
  uint quotient = mulHigh(mulHigh(top.mantissa, reciprocal(sum.mantissa)), shape.band_part);  // Q30, below 4
  int exponent = top.exponent - (sum.exponent - places) - shape.band_exponent - 31;
  uint x = (quotient >> uint(clampInt(-exponent, 0, 31))) << uint(clampInt(exponent, 0, 2));
  x = minUint(x, 0x80000000u);
  uint t = 0x80000000u - (mulHigh(x, x) << 1);
  CraterPlace place;
  place.share = craterShare(t, rootQ31(t));
  place.radius = (1u << 30) + mulHigh(x, shape.band_share);
  return place;
}

/// The noise's part of a crater's height at (dx, dy) from its centre, in 1/256 units.
RULE int craterRoughness(CraterShape shape, int dx, int dy, uint radius) {
  return wideLow(wideDown(wideMul(shape.amplitude, craterNoise(shape.seed, turnOf(dx, dy), radius)), kNoiseBits));
}

/// What the crater adds to the ground at (dx, dy) from its centre, in a zone, rounded to nearest.
/// @param inside  is it the cavity or the inner zone?
/// @param rough   is there noise?
RULE int craterLift(CraterShape shape, int dx, int dy, CraterPlace place, bool inside, bool rough) {
  int depth = inside ? shape.depth : 0;
  int height = (shape.rim + depth) << 8;
  if (rough) height += craterRoughness(shape, dx, dy, place.radius);
  const int bias = 1 << 25;  // keeps what is shifted above 0
  wide lifted =
      wideAdd(wideMul(height, int(place.share)), wideAdd(wideUp(wideFrom(1), 36), wideUp(wideFrom(bias), 37)));
  return wideLow(wideDown(lifted, 37)) - bias - depth;
}

/// What a crater adds to the ground at (dx, dy) from its centre: + rim, - cavity, 0 beyond R3. Less than one unit from
/// Algorithm 1 in real numbers.
/// Ranges: dx, dy any that do not overflow.
RULE int craterDisplacement(CraterShape shape, int dx, int dy) {
  if (dx > shape.outer || dx < -shape.outer || dy > shape.outer || dy < -shape.outer) return 0;
  wide square = wideAdd(wideMul(dx, dx), wideMul(dy, dy));
  if (wideNegative(wideSub(wideMul(shape.outer, shape.outer), square))) return 0;
  wide beyond = wideSub(square, wideMul(shape.crest, shape.crest));
  bool inside = wideNegative(beyond);
  CraterPlace place;
  if (inside)
    place = placeInside(shape, square);
  else
    place = placeOutside(shape, square, beyond);
  return craterLift(shape, dx, dy, place, inside, shape.amplitude > 0);
}

/// What the craters of a set do to one cell, so far. The order in which they are added does not show.
struct CraterSum {
  int depth;    // sum of what lies below the ground before, >= 0
  int rims;     // sum of what lies above
  int highest;  // the highest of these rims
};

RULE CraterSum craterSumOfNone() {
  CraterSum sum;
  sum.depth = 0;
  sum.rims = 0;
  sum.highest = 0;
  return sum;
}

/// @param displacement  craterDisplacement at the cell
/// @param rim           H4; noise may reach higher
RULE CraterSum withCrater(CraterSum sum, int displacement, int rim) {
  if (displacement < 0) sum.depth = minInt(sum.depth - displacement, kCraterSumLimit);
  if (displacement > 0) {
    sum.rims = minInt(sum.rims + displacement, kCraterSumLimit);
    sum.highest = maxInt(sum.highest, maxInt(rim, displacement));
  }
  return sum;
}

/// D(S): depths add up, rims as far as the highest.
RULE int craterTotal(CraterSum sum) { return minInt(sum.rims, sum.highest) - sum.depth; }

/// Ground that craters change: never below bedrock.
/// @param change  a difference of two craterTotal
RULE int craterGround(int height, int bedrock, int change) { return clampInt(height + change, bedrock, kHeightLimit); }

SPOOR_RULES_END

#endif
