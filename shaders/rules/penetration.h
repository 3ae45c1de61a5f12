// Stage penetration: what a body above a cell does to it.
// Source: Persson 2019, section 4.1.3; the obstacle test is on the signed gap, so that a cell that a body reaches below
// its bedrock is an obstacle too. Compaction: 4.1.4 and 6.2.
#ifndef SPOOR_RULES_PENETRATION_H
#define SPOOR_RULES_PENETRATION_H
#include "limits.h"

SPOOR_RULES_BEGIN

/// Overlap of a cell: > 0 the soil (height units) that a body pushes out, kObstacle, or kFree.
/// Soil below bedrock does not exist, so no more than height - bedrock is pushed.
/// A cell that a body has just left is an obstacle too: else a body thinner than a cell, which leaves its cells all at
/// once, would push as much backward as forward (Persson 2019, 6.2: "the current and the previous obstacle map").
/// @param underside_before  the same a sub-step earlier
RULE int cellOverlap(int height, int bedrock, int underside, int underside_before, int obstacle_threshold) {
  int pushed = height - maxInt(underside, bedrock);
  return pushed > 0 ? pushed
                    : (minInt(underside, underside_before) - height <= obstacle_threshold ? kObstacle : kFree);
}

/// The underside as far as it is seen: nothing higher above bedrock than the frustum (0: any) is there.
/// Outside the world (underside -kHeightLimit) it stays closed.
RULE int seenUnderside(int underside, int bedrock, int frustum_height) {
  return frustum_height > 0 && underside > -kHeightLimit && underside - bedrock > frustum_height ? kNoUnderside
                                                                                                 : underside;
}

/// What lies deeper does not count towards the limit, so that sums fit an int: 53 km.
RULE_CONST kDeepSoil = (1 << 29) - 1;

/// The part of a cell's overlap that is pressed together where it is; the rest is displaced.
/// With a limit, the share falls in proportion to what the column can still take: a compacted cell yields less.
/// @param soil       of the column, height - bedrock, before
/// @param compacted  what lies on account already, >= 0
/// @param compression, limit_share  0..2^16; limit_share 0: no limit and no memory
/// Range: the result is 0..overlap, and compacted + result at most kHeightLimit.
RULE int compactedShare(int overlap, int soil, int compacted, int compression, int limit_share) {
  int share = compression;
  int room = kHeightLimit - compacted;
  if (limit_share > 0) {
    int limit = timesQ16(minInt(soil, kDeepSoil) + minInt(compacted, kDeepSoil), limit_share);
    room = maxInt(limit - compacted, 0);
    share = limit == 0 ? 0 : wideLow(wideFloorDiv(wideMul(compression, room), wideFrom(limit)));
  }
  return minInt(timesQ16(overlap, share), room);
}

SPOOR_RULES_END
#endif
