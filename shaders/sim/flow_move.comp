// Stage displace, iterative, second half of a step: every cell loses what its neighbours grant it and gains what it
// grants. In: blocks, nearer, carried, offered, room. Out: next carried. A lane takes 32 cells of a column.
// Twin: displace_iterative.cpp.
#version 450 core
#include "../rules/flow.h"
#include "domain_column.glsl"

layout(std430, binding = kBindNearer) readonly buffer Nearer { int nearer[]; };
layout(std430, binding = kBindCarried) readonly buffer Carried { int carried[]; };
layout(std430, binding = kBindNextCarried) writeonly buffer NextCarried { int next_carried[]; };
layout(std430, binding = kBindOffered) readonly buffer Offered { int offered[]; };
layout(std430, binding = kBindRoom) readonly buffer Room { int room[]; };

int offerOf(int cell) { return flowOffer(carried[cell], bitCount(nearer[cell])); }

int granted(int offer, int to_cell) {
  return offer == 0 ? 0 : grantedShare(offer, room[to_cell], wideFrom(offered[to_cell]));
}

void main() {
  DomainColumn own = domainColumn();
  DomainEntry domain = domains[own.domain];
  for (int row = own.first_row; row < own.end_row; ++row) {
    int cell = domain.first_cell + row * domain.width + own.column;
    int offer = offerOf(cell);
    int after = carried[cell];
    bool all_fits = offered[cell] == 0 || offered[cell] <= room[cell];
    if (all_fits) after += offered[cell];
    for (int d = 0; d < 8; ++d) {
      ivec2 near = ivec2(own.column + neighbourX(d), row + neighbourY(d));
      if (!inDomain(domain, near.x, near.y)) continue;
      int near_cell = domain.first_cell + near.y * domain.width + near.x;
      if ((nearer[cell] >> d & 1) != 0) after -= granted(offer, near_cell);
      if (!all_fits && (nearer[near_cell] >> (d ^ 4) & 1) != 0) after += granted(offerOf(near_cell), cell);
    }
    next_carried[cell] = after;
  }
}
