// Stage relax, the rules beside pair exchange (exchange.h): the thesis's average rule, and antisymmetric flux.
// A sweep reads heights as they were before it and moves soil over all eight edges of every cell at once. Only edges
// between active cells count. Heights only change by flows that one cell loses and the other gains, so nothing is lost.
#ifndef SPOOR_RULES_SLOPE_H
#define SPOOR_RULES_SLOPE_H
#include "exchange.h"

SPOOR_RULES_BEGIN

/// No difference counts for more, so that the sum over eight neighbours fits an int: 26 km.
RULE_CONST kDifferenceMost = (1 << 28) - 1;

/// Is a neighbour one that a cell gives to? `drop`: the cell's height less the neighbour's; `room`: roomBeneath of the
/// neighbour. Source: Persson 2019, equation 4.1, as an integer threshold (parameters.h).
RULE bool slopeGives(int drop, int threshold, int room) { return drop > threshold && room > 0; }

/// What a cell gives each of its `count` receiving neighbours: their mean drop times roughness, divided by their
/// number, rounded down at each step; no more than its soil allows. 0 where there are none: so are their drops then.
/// @param drops      sum over them of minInt(drop, kDifferenceMost)
/// @param roughness  0..2^16
/// Source: Persson 2019, equation 4.2 and the text after it
RULE int slopeAmount(int drops, int count, int roughness, int soil) {
  int divisor = maxInt(count, 1);
  return dividedByCount(minInt(timesQ16(dividedByCount(drops, divisor), roughness), soil), divisor);
}

/// What flows over an edge of the amount that a cell gives: a neighbour lets in an eighth of its room from each side,
/// so that all eight together fit. (A share of the exact sum would need a pass more.)
RULE int slopeFlow(int amount, int room) { return minInt(amount, room >> 3); }

/// Flux: what flows from cell a to cell b (negative: back). An eighth of the excess over the threshold, times
/// roughness, toward 0; at most an eighth of the giver's soil and of the taker's room. Odd in its cells, so that both
/// sides of an edge find the same; excess below 8 units never moves. Threshold and roughness are the higher cell's.
RULE int slopeFlux(int height_a, int height_b, int threshold_a, int threshold_b, int roughness_a, int roughness_b,
                   int soil_a, int soil_b, int room_a, int room_b) {
  int difference = height_a - height_b;
  int forward = maxInt(difference, threshold_a) - threshold_a;
  int backward = maxInt(-difference, threshold_b) - threshold_b;
  int from_a = minInt(timesQ16(forward, roughness_a), minInt(soil_a, room_b)) >> 3;
  int from_b = minInt(timesQ16(backward, roughness_b), minInt(soil_b, room_a)) >> 3;
  return from_a - from_b;
}

SPOOR_RULES_END
#endif
