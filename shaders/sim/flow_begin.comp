// Stage displace, iterative, before the first step: what each cell carries, and which neighbours are nearer to a free
// cell. In: blocks, overlap, target. Out: nearer, carried. A lane takes 32 cells of a column.
// Twin: displace_iterative.cpp.
#version 450 core
#include "../rules/nearest.h"
#include "domain_column.glsl"

layout(std430, binding = kBindOverlap) readonly buffer Overlap { int overlap[]; };
layout(std430, binding = kBindTarget) readonly buffer Target { int target[]; };
layout(std430, binding = kBindNearer) writeonly buffer Nearer { int nearer[]; };
layout(std430, binding = kBindCarried) writeonly buffer Carried { int carried[]; };

const int kNowhere = 0x7fffffff;

/// To the nearest free cell.
int distanceAt(DomainEntry domain, int x, int y) {
  int cell = domain.first_cell + y * domain.width + x;
  if (overlap[cell] == kFree) return 0;
  int to = target[cell];
  if (to == kNoTarget) return kNowhere;
  return metricDistance(x - to % domain.width, y - to / domain.width, SPOOR_METRIC);
}

void main() {
  DomainColumn own = domainColumn();
  DomainEntry domain = domains[own.domain];
  for (int row = own.first_row; row < own.end_row; ++row) {
    int cell = domain.first_cell + row * domain.width + own.column;
    int own_distance = distanceAt(domain, own.column, row);
    int bits = 0;
    for (int d = 0; d < 8; ++d) {
      ivec2 near = ivec2(own.column + neighbourX(d), row + neighbourY(d));
      if (inDomain(domain, near.x, near.y) && distanceAt(domain, near.x, near.y) < own_distance) bits |= 1 << d;
    }
    nearer[cell] = own_distance == kNowhere ? 0 : bits;
    carried[cell] = max(overlap[cell], 0);
  }
}
