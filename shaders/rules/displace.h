// Stage displace: what a target grants to each cell that wants to push soil into it.
// Source: Persson 2019, section 4.1.4, method 2, with the limit of what fits (DESIGN.md, "too much for the room").
#ifndef SPOOR_RULES_DISPLACE_H
#define SPOOR_RULES_DISPLACE_H
#include "limits.h"

SPOOR_RULES_BEGIN

/// What a source may move of its request: all of it where the requests fit, else floor(request * room / total).
/// Ranges: 0 < request <= total, 0 <= room < 2^31, total < 2^62.
RULE int grantedShare(int request, int room, wide total) {
  if (!wideNegative(wideSub(wideFrom(room), total))) return request;
  return wideLow(wideFloorDiv(wideMul(request, room), total));
}

SPOOR_RULES_END
#endif
