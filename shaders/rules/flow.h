// Stage displace, iterative: overlapped soil steps from cell to cell down the distance to the nearest free cell.
// Source: Persson 2019, section 4.1.4, method 1 (after Sumner et al. 1999), with the limit of what fits.
//
// At first each penetrating cell carries its overlap, every other cell nothing. A step: a cell divides what it carries
// by the number of neighbours that are nearer to a free cell, offers each that much, and keeps the remainder. Free
// cells offer nothing. Each neighbour grants the offers, or grantedShare() of each where together they exceed its room.
// After the last step what a cell carries lies on it, be it free or not.
#ifndef SPOOR_RULES_FLOW_H
#define SPOOR_RULES_FLOW_H
#include "displace.h"
#include "exchange.h"

SPOOR_RULES_BEGIN

/// No cell offers a neighbour more at once, so that eight offers fit an int: 26 km of soil.
RULE_CONST kOfferMost = (1 << 28) - 1;

/// What a cell offers each of `count` nearer neighbours; 0 where there are none.
RULE int flowOffer(int carried, int count) { return count == 0 ? 0 : minInt(carried / count, kOfferMost); }

/// What a cell can take in a step. Free cells: what fits beneath a body. Others hold soil only in passing: up to the
/// height limit.
/// @param ground  the cell's height without what it carries
RULE int flowRoom(int overlap, int ground, int carried, int underside, int obstacle_threshold) {
  if (overlap == kFree) return roomBeneath(ground + carried, underside, obstacle_threshold);
  return kHeightLimit - ground - carried;
}

SPOOR_RULES_END
#endif
