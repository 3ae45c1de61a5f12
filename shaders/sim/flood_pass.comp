// Stage nearest by jump flooding, a pass: every cell looks at what the eight cells `stride` away know.
// In: blocks, known. Out: next known. A lane takes 32 cells of a column. Twin: nearest_flood.cpp.
#version 450 core
#include "../rules/flood.h"
#include "domain_column.glsl"
#include "flood.glsl"

layout(std430, binding = kBindKnown) readonly buffer Known { int known[]; };
layout(std430, binding = kBindNextKnown) writeonly buffer NextKnown { int next_known[]; };
layout(location = 2) uniform int stride;
layout(location = 3) uniform int last;  // 1: what comes out is a target

void main() {
  DomainColumn own = domainColumn();
  DomainEntry domain = domains[own.domain];
  int x = own.column;
  for (int y = own.first_row; y < own.end_row; ++y) {
    int best = known[domain.first_cell + y * domain.width + x];
    ivec2 offset = ivec2(0);
    if (best != kNoTarget) offset = ivec2(x, y) - placeOf(best);
    int order = floodOrder(domain.x0 + x, domain.y0 + y);
    for (int k = 0; k < 8; ++k) {
      int direction = floodNeighbour(order, k);
      ivec2 near = ivec2(x, y) + stride * ivec2(neighbourX(direction), neighbourY(direction));
      if (!inDomain(domain, near.x, near.y)) continue;
      int candidate = known[domain.first_cell + near.y * domain.width + near.x];
      if (candidate == kNoTarget) continue;
      ivec2 candidate_offset = ivec2(x, y) - placeOf(candidate);
      if (!floodTakes(best != kNoTarget, offset.x, offset.y, candidate_offset.x, candidate_offset.y, SPOOR_METRIC))
        continue;
      best = candidate;
      offset = candidate_offset;
    }
    if (last != 0 && best != kNoTarget) best = placeOf(best).y * domain.width + placeOf(best).x;
    next_known[domain.first_cell + y * domain.width + x] = best;
  }
}
