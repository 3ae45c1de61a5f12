// Stage penetration: which cells a body overlaps, and by how much; where SPOOR_COMPACTS is 1, presses a share of that
// together in its place. Lists the rows that have any cell of at least least_listed.
// In: blocks (owner: domain; x: chunk of columns; y: first row of 32), height, bedrock, undersides, materials.
// Out: overlap, free mask, row flags, row chunks, tick. In and out where it compacts: height, compacted. A lane takes
// 32 cells of a column. Twin: penetration.cpp.
#version 450 core
#include "../rules/penetration.h"
#include "domains.glsl"
#include "tick.glsl"

layout(std430, binding = kBindBlocks) readonly buffer Blocks { Block blocks[]; };
#if SPOOR_COMPACTS
#define MATERIAL_BINDING kBindDomainMaterial
#include "materials.glsl"
layout(std430, binding = kBindHeight) buffer Height { int height[]; };
layout(std430, binding = kBindCompacted) buffer Compacted { int compacted[]; };
#else
layout(std430, binding = kBindHeight) readonly buffer Height { int height[]; };
#endif
layout(std430, binding = kBindBedrock) readonly buffer Bedrock { int bedrock[]; };
layout(std430, binding = kBindUnderside) readonly buffer Underside { int underside[]; };
layout(std430, binding = kBindUndersideBefore) readonly buffer UndersideBefore { int underside_before[]; };
layout(std430, binding = kBindOverlap) writeonly buffer Overlap { int overlap[]; };
layout(std430, binding = kBindFreeMask) writeonly buffer FreeMask { uint free_mask[]; };
layout(std430, binding = kBindRowChunks) writeonly buffer RowChunks { RowChunk row_chunks[]; };
layout(std430, binding = kBindRowFlags) buffer RowFlags { int row_flags[]; };
layout(location = 2) uniform int least_listed;  // 1; kObstacle where obstacles need a target too

shared int penetrating_in_group;

void listRow(int domain, int row) {
  int flag = domains[domain].first_row + row;
  if ((row_flags[flag] & kRowPenetrates) != 0 || (atomicOr(row_flags[flag], kRowPenetrates) & kRowPenetrates) != 0)
    return;
  int chunks = (domains[domain].width + kGroup - 1) / kGroup;
  int first = atomicAdd(lists[list].rows.used, chunks);
  atomicMax(lists[list].rows.y, (first + chunks + kDispatchColumns - 1) / kDispatchColumns);
  for (int i = 0; i < chunks; ++i) row_chunks[first + i] = RowChunk(domain, row, i);
}

/// What is left of a penetrating cell's overlap once a share of it is pressed together.
int press(int at, int value) {
#if SPOOR_COMPACTS
  int kind = materialOf(at);
  int share = compactedShare(value, height[at] - bedrock[at], compacted[at], materials[kind].compression,
                             materials[kind].compaction_limit);
  compacted[at] += share;
  height[at] -= share;
  return value - share;
#else
  return value;
#endif
}

void main() {
  if (groupIndex() >= group_count) return;
  if (lane() == 0) penetrating_in_group = 0;
  barrier();
  Block block = blocks[groupIndex()];
  DomainEntry domain = domains[block.owner];
  int column = block.x * kGroup + lane();
  if (column < domain.width) {
    uint free = 0u;
    int penetrating = 0;
    int end = min(kMaskRows, domain.rows - block.y);
    int at = 0;
    TileGrid grid = tileGrid(block.owner);
    for (int i = 0; i < end; ++i) {
      int row = block.y + i;
      bool enters = i == 0 || (domain.y0 + row) % kTileSize == 0;  // another tile
      at = enters ? tileCell(grid, domain.x0 + column, domain.y0 + row) : at + kTileSize;
      int value = cellOverlap(height[at], bedrock[at], underside[at], underside_before[at], tick.obstacle_threshold);
      if (value > 0) {
        ++penetrating;
        value = press(at, value);
      }
      overlap[domain.first_cell + row * domain.width + column] = value;
      if (value == kFree) free |= 1u << uint(i);
      if (value >= least_listed) listRow(block.owner, row);
    }
    free_mask[domain.first_word + block.y / kMaskRows * domain.width + column] = free;
    if (penetrating != 0) atomicAdd(penetrating_in_group, penetrating);
  }
  barrier();
  if (lane() != 0 || penetrating_in_group == 0) return;
  atomicAdd(tick.penetrating_cells, penetrating_in_group);
  lists[list].wholes.y = lists[list].wholes.used;
}
