// Stage relax, rule `drift`: drift and diffusion of soil over the edges to four neighbours.
//
// Source: Gilardi, Watten and Newbury, "Drift-Diffusion Based Real-Time Dynamic Terrain Deformation", equations 2 to 8:
// dh/dt = w . (D d2h/dx2 - d(F/zeta)/dx). Written here as what flows over an edge in a step,
//   moved = step * w * (D (h_a - h_b) + (F_a/zeta_a + F_b/zeta_b) / 2),
// whose differences are equation 6 to the letter. Departures, and why:
// - A cell's weight (equations 4 and 8) multiplies both of its edges and takes from one neighbour what the other does
//   not get: volume comes and goes. Here the edge has the weight, found from what moves over the edge, alike from both
//   sides.
// - As printed, weights look at how far soil moves in a unit of time (kDriftByDisplacement), not at how steep it lies;
//   a cone's flank, whose second derivative is 0, rests at any angle. Weighed by the edge's flow it rests where
//   tan(slope) = alpha / D. kDriftBySlope instead takes w = 1 - tan(alpha) / tan(slope), which is 0 at the angle of
//   repose and 1 upright as the paper's is, and makes the flow D (h_a - h_b - T): linear in the excess, so stable
//   where diffusion is, and at rest at T exactly. It does not hold back the force, which could else not break flat
//   ground.
// - No more flows out of a cell than the soil it holds over bedrock, nor into one than there is room for: a quarter
//   over each edge. Steps are short enough (driftSteps in parameters.h) that diffusion alone never asks for more over
//   flat bedrock.
// - Amounts are whole units. The fraction is rounded up or down in turn (driftDither), so that small steps lose nothing
//   on the mean; what would not move by 1/256 of a unit stays, and so does a difference of a unit.
#ifndef SPOOR_RULES_DRIFT_H
#define SPOOR_RULES_DRIFT_H
#include "exchange.h"

SPOOR_RULES_BEGIN

RULE_CONST kDriftUnweighted = 0;
RULE_CONST kDriftByDisplacement = 1;
RULE_CONST kDriftBySlope = 2;

/// No difference of heights, and no push, counts for more, so that products fit an int: 419 m.
RULE_CONST kDriftMost = (1 << 22) - 1;

/// What all edges share in a step. Lengths with 8 bits below the unit.
struct DriftStep {
  int weights;           // kDriftUnweighted, ..
  int step;              // units of time in Q16, 1 .. 2^16
  int quarter;           // by displacement: the arc of a right angle times `step`, 1 .. 2^29
  int shift;             // takes `quarter` to within 2^30 .. 2^31
  uint inverse_quarter;  // 2^48 / (quarter << shift)
};

/// What its material says of a cell in a step.
struct DriftNumbers {
  int rest;      // by slope: height difference that rests where this is the higher cell, >= 1; by displacement: the
                 // angle of repose as a share of a right angle in Q16
  int rate;      // D * step in Q16, 0 .. 2^13
  uint inverse;  // by displacement: about 2^32 / (2^16 - rest)
};

/// A cell as its edges see it.
struct DriftCell {
  int height;
  int soil;  // above bedrock
  int room;  // roomBeneath
  int rest;  // the material's numbers
  int rate;
  uint inverse;
};

/// floor(a * b / 2^8). Ranges: 0 <= a <= kDriftMost, 0 <= b <= 2^16.
RULE int timesQ8(int a, int b) { return (a >> 8) * b + ((a & 255) * b >> 8); }

RULE int withSign(int magnitude, int signed_value) { return signed_value < 0 ? -magnitude : magnitude; }

/// Share in Q16 of what moves over an edge that equation 4 lets through.
/// @param moved  magnitude, with 8 bits below the unit
/// @param rest, inverse  of the cell that gives
RULE int driftWeight(DriftStep step, int moved, int rest, uint inverse) {
  uint share = minUint(mulHigh(uint(minInt(moved, step.quarter)) << uint(step.shift), step.inverse_quarter), 0xffffu);
  return int(minUint(mulHigh(uint(maxInt(int(share) - rest, 0)) << 16u, inverse), 0x10000u));
}

/// Soil that flows from cell a to its neighbour b on the side of larger x or y (negative: back), height units.
/// @param push    height units per unit of time that forces move from a to b
/// @param dither  0..255 (driftDither)
RULE int driftFlow(DriftStep step, DriftCell a, DriftCell b, int push, int dither) {
  int difference = clampInt(a.height - b.height, -kDriftMost, kDriftMost);
  bool by_displacement = step.weights == kDriftByDisplacement;
  int height = absInt(difference);
  int resting = difference < 0 ? b.rest : a.rest;
  int excess = step.weights == kDriftBySlope ? maxInt(height - resting, 0) : height > 1 ? height : 0;
  int diffused = withSign(timesQ8(excess, (a.rate + b.rate) >> 1), difference);
  int pushed = withSign(timesQ8(minInt(absInt(push), kDriftMost), step.step), push);
  int moved = diffused + pushed;
  int magnitude = absInt(moved);
  int weight = driftWeight(step, magnitude, moved < 0 ? b.rest : a.rest, moved < 0 ? b.inverse : a.inverse);
  magnitude = by_displacement ? timesQ16(magnitude, weight) : magnitude;
  int fits = moved < 0 ? minInt(b.soil, a.room) : minInt(a.soil, b.room);
  return withSign(minInt((magnitude + dither) >> 8, fits >> 2), moved);
}

/// Which edges round up, of a step whose number is in `phase`: evenly spread over each edge's steps (a Weyl sequence).
/// @param x, y  of the edge's cell a
/// @param axis  0: along x, 1: along y
RULE int driftDither(int x, int y, int axis, uint phase) {
  return int((uint(x) * 0xb5297a4du + uint(y) * 0x68e31da5u + uint(axis) * 0x5bd1e995u + phase) >> 24u);
}
RULE uint driftPhase(int tick, int sweep) { return (uint(tick) * 1009u + uint(sweep)) * 0x9e3779b1u; }

/// With what each of `count` cells beneath a body pushes: newtons * height units (the side of a cell).
/// @param total  force * side of a cell, >= 0
/// @param most   bound, so that the sum over all bodies fits an int
RULE int pushStrength(wide total, int count, int most) {
  return wideClamp(wideFloorDiv(total, wideFrom(maxInt(count, 1))), 0, most);
}
/// Its part along an axis. direction: Q30, -2^30 .. 2^30; strength: 0 .. 2^30.
RULE int pushAlong(int strength, int direction) { return wideFromQ30(wideMul(strength, direction)); }
/// How far that moves soil in a unit of time, height units.
/// @param strength  sum of pushAlong over bodies, magnitude at most 2^30
/// @param friction_inverse  1/zeta * 2^32, 0 .. 2^31 - 1
RULE int pushedSoil(int strength, int friction_inverse) {
  return clampInt(wideFromQ30(wideMul(strength, friction_inverse)) >> 2, -kDriftMost, kDriftMost);
}
/// Does a body that is this low over a cell push its soil?
RULE bool isContact(int height, int underside, int obstacle_threshold) {
  return underside < kNoUnderside && underside - height <= obstacle_threshold;
}

SPOOR_RULES_END
#endif
