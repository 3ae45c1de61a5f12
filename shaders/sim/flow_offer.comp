// Stage displace, iterative, first half of a step: what a cell is offered in all, and what it can take.
// In: blocks, nearer, carried, overlap, height, underside. Out: offered, room. A lane takes 32 cells of a column.
// Twin: displace_iterative.cpp.
#version 450 core
#include "../rules/flow.h"
#include "domain_column.glsl"

layout(std430, binding = kBindHeight) readonly buffer Height { int height[]; };
layout(std430, binding = kBindUnderside) readonly buffer Underside { int underside[]; };
layout(std430, binding = kBindOverlap) readonly buffer Overlap { int overlap[]; };
layout(std430, binding = kBindNearer) readonly buffer Nearer { int nearer[]; };
layout(std430, binding = kBindCarried) readonly buffer Carried { int carried[]; };
layout(std430, binding = kBindOffered) writeonly buffer Offered { int offered[]; };
layout(std430, binding = kBindRoom) writeonly buffer Room { int room[]; };

void main() {
  DomainColumn own = domainColumn();
  DomainEntry domain = domains[own.domain];
  TileGrid grid = tileGrid(own.domain);
  for (int row = own.first_row; row < own.end_row; ++row) {
    int total = 0;
    for (int d = 0; d < 8; ++d) {
      ivec2 near = ivec2(own.column + neighbourX(d), row + neighbourY(d));
      if (!inDomain(domain, near.x, near.y)) continue;
      int near_cell = domain.first_cell + near.y * domain.width + near.x;
      int bits = nearer[near_cell];
      if ((bits >> (d ^ 4) & 1) != 0) total += flowOffer(carried[near_cell], bitCount(bits));
    }
    int cell = domain.first_cell + row * domain.width + own.column;
    offered[cell] = total;
    if (total == 0) continue;
    int at = tileCell(grid, domain.x0 + own.column, domain.y0 + row);
    room[cell] = flowRoom(overlap[cell], height[at] - max(overlap[cell], 0), carried[cell], underside[at],
                          tick.obstacle_threshold);
  }
}
