// Stage displace, direct and spread: what targets grant their sources, and how they take it.
// SPOOR_SEARCH is 1 where a free mask is kept for the next round's search.
#ifndef SPOOR_SIM_DISPLACE_TARGETS_GLSL
#define SPOOR_SIM_DISPLACE_TARGETS_GLSL
#include "displace.glsl"

layout(std430, binding = kBindHeight) SPOOR_COHERENT buffer Height { int height[]; };
layout(std430, binding = kBindUnderside) readonly buffer Underside { int underside[]; };
layout(std430, binding = kBindGranted) SPOOR_COHERENT buffer Granted { uint granted[]; };

wide requestedAt(int cell) { return wide(requested_low[cell], requested_high[cell]); }

/// Takes from a source what its targets grant; returns what is left of its overlap.
/// Targets are free cells and sources are not, so a target's height is still what it was.
int takeFrom(DomainEntry domain, TileGrid grid, int cell, int target_cell) {
  Source source = sourceAt(domain, cell, target_cell);
  int given = 0;
  for (int i = 0; i < source.parts; ++i) {
    ivec2 to = partTarget(source, i);
    int at = tileCell(grid, domain.x0 + to.x, domain.y0 + to.y);
    int to_cell = domain.first_cell + to.y * domain.width + to.x;
    int room = roomBeneath(height[at], underside[at], tick.obstacle_threshold);
    wide total = requestedAt(to_cell);
    int share = grantedShare(partAmount(source, i), room, total);
    given += share;
    // Together no more than the room, so one word holds it.
    if (share != 0 && wideNegative(wideSub(wideFrom(room), total))) atomicAdd(granted[to_cell], uint(share));
  }
  if (given != 0) {
    height[tileCell(grid, domain.x0 + cell % domain.width, domain.y0 + cell / domain.width)] -= given;
    overlap[domain.first_cell + cell] = source.amount - given;
  }
  return source.amount - given;
}

#ifdef SPOOR_SEARCH
layout(std430, binding = kBindTileStates) writeonly buffer TileStates { TileState tile_states[]; };
#if SPOOR_SEARCH
layout(std430, binding = kBindFreeMask) SPOOR_COHERENT buffer FreeMask { uint free_mask[]; };
#endif

/// A target takes what it let in, and is closed where it was asked for more. The sums are 0 again.
/// @param let_in  of it, where not all fits
void giveTo(DomainEntry domain, TileGrid grid, ivec2 to, uint let_in, int relax_step) {
  int cell = domain.first_cell + to.y * domain.width + to.x;
  int at = tileCell(grid, domain.x0 + to.x, domain.y0 + to.y);
  int room = roomBeneath(height[at], underside[at], tick.obstacle_threshold);
  bool all_fits = !wideNegative(wideSub(wideFrom(room), requestedAt(cell)));
  int raised = height[at] + int(all_fits ? requested_low[cell] : let_in);
  height[at] = raised;
  if (raised > tick.highest) atomicMax(tick.highest, raised);
  // Sources lie under a body, where a slab is unsettled anyway; targets need not.
  tile_states[at / kTileCells].changed_at[at % kTileCells / kSlabCells] = relax_step;
  requested_low[cell] = 0u;
  requested_high[cell] = 0u;
  granted[cell] = 0u;
  if (all_fits) return;
  overlap[cell] = kObstacle;
#if SPOOR_SEARCH
  atomicAnd(free_mask[domain.first_word + to.y / kMaskRows * domain.width + to.x], ~(1u << uint(to.y % kMaskRows)));
#endif
}
#endif

#endif
