// Stage relax: one pair of neighbouring cells of one matching.
// Source: edge-coloured pair exchange; the excess over the threshold is halved, rounded up, so that every pair ends at
// or under its threshold and the whole comes to rest in finite time (the sum of squares falls with every move).
#ifndef SPOOR_RULES_EXCHANGE_H
#define SPOOR_RULES_EXCHANGE_H
#include "limits.h"

SPOOR_RULES_BEGIN

/// A sweep is eight matchings, in this order. Bit 0 is the parity of the pair's first cell (lower x, or lower y) in
/// global coordinates; the other bits are the direction of the second cell.
RULE_CONST kMatchingCount = 8;
RULE_CONST kMatchHorizontal = 0;    // matchings 0, 1: (x, y) - (x+1, y), parity of x
RULE_CONST kMatchVertical = 2;      // matchings 2, 3: (x, y) - (x, y+1), parity of y
RULE_CONST kMatchDiagonal = 4;      // matchings 4, 5: (x, y) - (x+1, y+1), parity of y
RULE_CONST kMatchAntidiagonal = 6;  // matchings 6, 7: (x, y) - (x-1, y+1), parity of y

/// The threshold that pairs exchange by: not less than 1, or a pair that differs by 1 would swap for ever.
RULE int exchangeThreshold(int slope_threshold) { return maxInt(slope_threshold, 1); }

/// Soil that flows from cell a to cell b (negative: from b to a), in height units.
/// @param threshold_a, threshold_b  largest height difference that rests where a, where b is the higher one, >= 1: what
/// slides is the higher cell's soil, so its material decides
/// @param soil_a, soil_b  height above bedrock, >= 0: a cell gives no more than that
/// @param room_a, room_b  what each can take beneath a body, >= 0 (roomBeneath)
/// Ranges: heights within +-kHeightLimit; the result's magnitude is at most 2^30.
RULE int pairFlow(int height_a, int height_b, int threshold_a, int threshold_b, int soil_a, int soil_b, int room_a,
                  int room_b) {
  int difference = height_a - height_b;
  int forward = maxInt(difference, threshold_a) - threshold_a;
  int backward = maxInt(-difference, threshold_b) - threshold_b;
  int from_a = minInt((forward >> 1) + (forward & 1), minInt(soil_a, room_b));
  int from_b = minInt((backward >> 1) + (backward & 1), minInt(soil_b, room_a));
  return from_a - from_b;
}

/// What a cell can take: all of the gap to the underside above it, or nothing where the gap is at most the obstacle
/// threshold. Range: height and underside within +-kHeightLimit.
RULE int roomBeneath(int height, int underside, int obstacle_threshold) {
  int gap = underside - height;
  return gap > obstacle_threshold ? gap : 0;
}

SPOOR_RULES_END
#endif
