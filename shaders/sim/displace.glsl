// Stage displace, direct and spread: where a source's overlap goes, and what its targets have room for.
// SPOOR_SPREAD is 1 for spread.
#ifndef SPOOR_SIM_DISPLACE_GLSL
#define SPOOR_SIM_DISPLACE_GLSL
#include "../rules/displace.h"
#include "domains.glsl"
#include "tick.glsl"

layout(std430, binding = kBindOverlap) buffer Overlap { int overlap[]; };

/// A penetrating cell, and the cells of its domain's box that it wants to push soil into.
struct Source {
  int amount;
  ivec2 target;  // the nearest free cell
  ivec2 way;     // to it
  int longest;   // of the way
  int parts;
  int passed;  // cells of the line, from the nearest free cell on, that take no part
};

/// The cell that takes part i.
ivec2 partTarget(Source source, int i) {
#if SPOOR_SPREAD
  return source.target + ivec2(spreadOffset(source.way.x, source.longest, i + source.passed),
                               spreadOffset(source.way.y, source.longest, i + source.passed));
#else
  return source.target;
#endif
}

int partAmount(Source source, int i) {
#if SPOOR_SPREAD
  return spreadPart(source.amount, source.parts, i);
#else
  return source.amount;
#endif
}

Source sourceAt(DomainEntry domain, int cell, int target_cell) {
  Source source;
  source.amount = overlap[domain.first_cell + cell];
  source.target = ivec2(target_cell % domain.width, target_cell / domain.width);
  source.way = source.target - ivec2(cell % domain.width, cell / domain.width);
  source.longest = max(abs(source.way.x), abs(source.way.y));
  source.parts = 1;
  source.passed = 0;
#if SPOOR_SPREAD
  source.passed = 1;
  int wanted = spreadTargets(source.amount, tick.penetration_divider, tick.spread_cells);
  int free = 0;
  for (; free < wanted; ++free) {
    ivec2 to = partTarget(source, free);
    if (to.x < 0 || to.y < 0 || to.x >= domain.width || to.y >= domain.rows) break;
    if (overlap[domain.first_cell + to.y * domain.width + to.x] != kFree) break;
  }
  if (free == 0) source.passed = 0;
  source.parts = max(free, 1);
#endif
  return source;
}

#endif
