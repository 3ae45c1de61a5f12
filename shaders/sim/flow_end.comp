// Stage displace, iterative, after the last step: what a cell carries lies on it.
// In: blocks, overlap, carried. In and out: height, tick.highest. Out: tile states, tick. A lane takes 32 cells of a
// column. Twin: displace_iterative.cpp.
#version 450 core
#include "domain_column.glsl"
#include "kept_back.glsl"

layout(std430, binding = kBindTileStates) writeonly buffer TileStates { TileState tile_states[]; };
layout(std430, binding = kBindHeight) buffer Height { int height[]; };
layout(std430, binding = kBindOverlap) readonly buffer Overlap { int overlap[]; };
layout(std430, binding = kBindCarried) readonly buffer Carried { int carried[]; };
layout(location = 2) uniform int relax_step;  // of the relaxation, that comes next

void main() {
  DomainColumn own = domainColumn();
  DomainEntry domain = domains[own.domain];
  TileGrid grid = tileGrid(own.domain);
  for (int row = own.first_row; row < own.end_row; ++row) {
    int cell = domain.first_cell + row * domain.width + own.column;
    int gained = carried[cell] - max(overlap[cell], 0);
    if (overlap[cell] != kFree && carried[cell] > 0) keepBack(carried[cell]);
    if (gained == 0) continue;
    int at = tileCell(grid, domain.x0 + own.column, domain.y0 + row);
    int after = height[at] + gained;
    height[at] = after;
    if (after > tick.highest) atomicMax(tick.highest, after);
    tile_states[at / kTileCells].changed_at[at % kTileCells / kSlabCells] = relax_step;
  }
}
