// Stage displace, direct and spread: where soil goes, and what a target grants to each cell that wants to push soil
// into it. Source: Persson 2019, section 4.1.4, methods 2 and 3, with the limit of what fits (DESIGN.md, "too much for
// the room").
//
// Direct: all of a source's overlap goes to its nearest free cell. Spread: in equal parts to the cells that a straight
// line from the source through its nearest free cell meets beyond it. The thesis marches by unit vectors and writes
// wherever that leads; here the line advances a cell along its longer axis at each step, and ends before the first
// cell that is not free, so that nothing is pushed off the map, under a body or through one.
//
// What finds no room stays at its source; a target that was asked for more than it has room for is closed, and the
// rest goes in the next round to the nearest cell that is still free (Persson 2019, 6.2).
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

/// Spread: how many targets a source wants: one for each `divider` of its overlap, begun ones too, at most `most`.
RULE int spreadTargets(int overlap, int divider, int most) { return minInt((overlap - 1) / divider + 1, most); }

/// Spread: offset along one axis of the k-th cell (1, 2, ..) beyond the nearest free cell, rounded to the nearest,
/// halves outward.
/// @param d        from the source to the nearest free cell along this axis
/// @param longest  the larger magnitude of both axes' d, > 0
RULE int spreadOffset(int d, int longest, int k) {
  int offset = (2 * absInt(d) * k + longest) / (2 * longest);
  return d < 0 ? -offset : offset;
}

/// Spread: the part of target i of `count`; the first ones take one unit more where it does not divide.
RULE int spreadPart(int overlap, int count, int i) { return overlap / count + (i < overlap % count ? 1 : 0); }

SPOOR_RULES_END
#endif
