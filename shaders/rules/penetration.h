// Stage penetration: what a body above a cell does to it.
// Source: Persson 2019, section 4.1.3; the obstacle test is on the signed gap, so that a cell that a body reaches below
// its bedrock is an obstacle too.
#ifndef SPOOR_RULES_PENETRATION_H
#define SPOOR_RULES_PENETRATION_H
#include "limits.h"

SPOOR_RULES_BEGIN

/// Overlap of a cell: > 0 the soil (height units) that a body pushes out, kObstacle, or kFree.
/// Soil below bedrock does not exist, so no more than height - bedrock is pushed.
RULE int cellOverlap(int height, int bedrock, int underside, int obstacle_threshold) {
  int pushed = height - maxInt(underside, bedrock);
  return pushed > 0 ? pushed : (underside - height <= obstacle_threshold ? kObstacle : kFree);
}

SPOOR_RULES_END
#endif
