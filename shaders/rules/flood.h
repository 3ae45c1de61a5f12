// Stage nearest by jump flooding: in which order a cell looks at its neighbours, and when it takes over what they know.
// A pass with step s looks at the eight cells s away; steps are n/2, n/4, .. 1 for n the smallest power of two that is
// not smaller than the domain. Source: Rong & Tan 2006; Persson 2019, 4.1.4 (random order of examination). Variants:
// JFA+1 and JFA+2 append steps 1 and 2, 1 (Rong & Tan 2006), 1+JFA begins with step 1 (Rong & Tan 2007), JFA^2 repeats
// all.
#ifndef SPOOR_RULES_FLOOD_H
#define SPOOR_RULES_FLOOD_H
#include "mix.h"
#include "nearest.h"

SPOOR_RULES_BEGIN

RULE_CONST kFloodSalt = 0x666c;  // in place of a plane, in the hash of a cell's place

/// From a cell's place in the world to its order of examination.
RULE int floodOrder(int x, int y) { return int(cellKey(x, y, kFloodSalt) & 31u); }

/// The k-th neighbour (0..7, limits.h) that a cell examines: each once, from any of the eight on, in strides of 1, 3, 5
/// or 7.
RULE int floodNeighbour(int order, int k) { return (order + k * (((order >> 3) & 3) * 2 + 1)) & 7; }

/// Does a cell change to a neighbour's free cell? Only if that is nearer; what was examined first stays otherwise.
/// dx, dy: from the cell to the free cell it knows (`known`: does it know any?) and to its neighbour's.
RULE bool floodTakes(bool known, int dx, int dy, int neighbour_dx, int neighbour_dy, int metric) {
  return !known || metricDistance(neighbour_dx, neighbour_dy, metric) < metricDistance(dx, dy, metric);
}

SPOOR_RULES_END
#endif
