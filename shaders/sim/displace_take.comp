// Stage displace, second pass: sources give what their target grants.
// In: row chunks, overlap, target, requested, underside. Out: height of sources, granted. A lane takes a cell.
// Twin: displace.cpp, takeFromSources.
#version 450 core
#include "../rules/displace.h"
#include "../rules/exchange.h"
#include "domains.glsl"
#include "tick.glsl"

layout(std430, binding = kBindRowChunks) readonly buffer RowChunks { RowChunk row_chunks[]; };
layout(std430, binding = kBindOverlap) readonly buffer Overlap { int overlap[]; };
layout(std430, binding = kBindTarget) readonly buffer Target { int target[]; };
layout(std430, binding = kBindRequestedLow) readonly buffer RequestedLow { uint requested_low[]; };
layout(std430, binding = kBindRequestedHigh) readonly buffer RequestedHigh { uint requested_high[]; };
layout(std430, binding = kBindGrantedLow) buffer GrantedLow { uint granted_low[]; };
layout(std430, binding = kBindGrantedHigh) buffer GrantedHigh { uint granted_high[]; };
layout(std430, binding = kBindHeight) buffer Height { int height[]; };
layout(std430, binding = kBindUnderside) readonly buffer Underside { int underside[]; };

void main() {
  if (groupIndex() >= tick.lists[sub_step].rows.used) return;
  RowChunk chunk = row_chunks[groupIndex()];
  DomainEntry domain = domains[chunk.domain];
  TileGrid grid = tileGrid(chunk.domain);
  int column = chunk.chunk * kGroup + lane();
  if (column >= domain.width) return;
  int cell = domain.first_cell + chunk.row * domain.width + column;
  int amount = overlap[cell];
  if (amount <= 0 || target[cell] == kNoTarget) return;
  int to = domain.first_cell + target[cell];
  // Targets are free cells and sources are not, so a target's height is still what it was.
  int at = tileCell(grid, domain.x0 + target[cell] % domain.width, domain.y0 + target[cell] / domain.width);
  int room = roomBeneath(height[at], underside[at], tick.obstacle_threshold);
  wide total = wide(requested_low[to], requested_high[to]);
  int share = grantedShare(amount, room, total);
  height[tileCell(grid, domain.x0 + column, domain.y0 + chunk.row)] -= share;
  if (share == 0 || !wideNegative(wideSub(wideFrom(room), total))) return;
  uint before = atomicAdd(granted_low[to], uint(share));
  if (before + uint(share) < before) atomicAdd(granted_high[to], 1u);
}
