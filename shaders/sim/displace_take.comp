// Stage displace, second pass of a round: sources give what their targets grant.
// In: row chunks, target, requested, underside. In and out: overlap, height of sources. Out: granted, tick, and that
// the next round has something to do. A lane takes a cell. Twin: displace.cpp, takeFromSources.
#version 450 core
#include "../rules/exchange.h"
#include "displace.glsl"
#include "kept_back.glsl"

layout(std430, binding = kBindRowChunks) readonly buffer RowChunks { RowChunk row_chunks[]; };
layout(std430, binding = kBindTarget) readonly buffer Target { int target[]; };
layout(std430, binding = kBindRequestedLow) readonly buffer RequestedLow { uint requested_low[]; };
layout(std430, binding = kBindRequestedHigh) readonly buffer RequestedHigh { uint requested_high[]; };
layout(std430, binding = kBindGranted) buffer Granted { uint granted[]; };
layout(std430, binding = kBindHeight) buffer Height { int height[]; };
layout(std430, binding = kBindUnderside) readonly buffer Underside { int underside[]; };
layout(location = 2) uniform int last;  // 1: no round follows

/// Takes from a source what its targets grant; returns how much.
/// Targets are free cells and sources are not, so a target's height is still what it was.
int takeFrom(DomainEntry domain, TileGrid grid, int cell, int target_cell) {
  Source source = sourceAt(domain, cell, target_cell);
  int given = 0;
  for (int i = 0; i < source.parts; ++i) {
    ivec2 to = partTarget(source, i);
    int at = tileCell(grid, domain.x0 + to.x, domain.y0 + to.y);
    int to_cell = domain.first_cell + to.y * domain.width + to.x;
    int room = roomBeneath(height[at], underside[at], tick.obstacle_threshold);
    wide total = wide(requested_low[to_cell], requested_high[to_cell]);
    int share = grantedShare(partAmount(source, i), room, total);
    given += share;
    // Together no more than the room, so one word holds it.
    if (share != 0 && wideNegative(wideSub(wideFrom(room), total))) atomicAdd(granted[to_cell], uint(share));
  }
  height[tileCell(grid, domain.x0 + cell % domain.width, domain.y0 + cell / domain.width)] -= given;
  overlap[domain.first_cell + cell] = source.amount - given;
  return given;
}

/// The next round takes the same rows.
void beginNextRound() {
  lists[list + 1].rows.used = lists[list].rows.used;
  lists[list + 1].rows.y = lists[list].rows.y;
  lists[list + 1].wholes.y = lists[list + 1].wholes.used;
}

void main() {
  if (groupIndex() >= lists[list].rows.used) return;
  RowChunk chunk = row_chunks[groupIndex()];
  DomainEntry domain = domains[chunk.domain];
  int column = chunk.chunk * kGroup + lane();
  if (column >= domain.width) return;
  int cell = chunk.row * domain.width + column;
  int amount = overlap[domain.first_cell + cell];
  if (amount <= 0) return;
  int to = target[domain.first_cell + cell];
  if (to != kNoTarget) amount -= takeFrom(domain, tileGrid(chunk.domain), cell, to);
  if (amount == 0) return;
  if (last != 0)
    keepBack(amount);
  else
    beginNextRound();
}
