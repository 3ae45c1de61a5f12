// Stage displace, third pass of a round: targets take what they let in, and those that were asked for too much are
// closed. In: receivers, underside. In and out: requested, granted, height, overlap, free mask, tick.highest.
// Out: tile states. A lane takes a cell. Twin: displace.cpp, giveToTargets.
#version 450 core
#include "../rules/exchange.h"
#include "domains.glsl"
#include "tick.glsl"

layout(std430, binding = kBindTileStates) writeonly buffer TileStates { TileState tile_states[]; };
layout(std430, binding = kBindHeight) buffer Height { int height[]; };
layout(std430, binding = kBindUnderside) readonly buffer Underside { int underside[]; };
layout(std430, binding = kBindOverlap) writeonly buffer Overlap { int overlap[]; };
layout(std430, binding = kBindRequestedLow) buffer RequestedLow { uint requested_low[]; };
layout(std430, binding = kBindRequestedHigh) buffer RequestedHigh { uint requested_high[]; };
layout(std430, binding = kBindFreeMask) buffer FreeMask { uint free_mask[]; };
layout(std430, binding = kBindGranted) buffer Granted { uint granted[]; };
layout(std430, binding = kBindRowChunks) readonly buffer RowChunks { RowChunk row_chunks[]; };
layout(location = 2) uniform int relax_step;  // of the relaxation, that comes next

void main() {
  if (groupIndex() >= lists[list].receivers.used) return;
  RowChunk chunk = row_chunks[groupIndex()];
  DomainEntry domain = domains[chunk.domain];
  TileGrid grid = tileGrid(chunk.domain);
  int column = chunk.chunk * kGroup + lane();
  if (column >= domain.width) return;
  int cell = domain.first_cell + chunk.row * domain.width + column;
  wide total = wide(requested_low[cell], requested_high[cell]);
  if (wideZero(total)) return;
  int at = tileCell(grid, domain.x0 + column, domain.y0 + chunk.row);
  int room = roomBeneath(height[at], underside[at], tick.obstacle_threshold);
  bool all_fits = !wideNegative(wideSub(wideFrom(room), total));
  int raised = height[at] + int(all_fits ? requested_low[cell] : granted[cell]);
  height[at] = raised;
  if (raised > tick.highest) atomicMax(tick.highest, raised);
  // Sources lie under a body, where a slab is unsettled anyway; targets need not.
  tile_states[at / kTileCells].changed_at[at % kTileCells / kSlabCells] = relax_step;
  requested_low[cell] = 0u;
  requested_high[cell] = 0u;
  granted[cell] = 0u;
  if (all_fits) return;
  overlap[cell] = kObstacle;
  int word = domain.first_word + chunk.row / kMaskRows * domain.width + column;
  atomicAnd(free_mask[word], ~(1u << uint(chunk.row % kMaskRows)));
}
