// Stage displace, second pass: sources give what their targets grant; those that keep soil are listed.
// In: row chunks, target, requested, underside. In and out: overlap, height of sources. Out: granted, left, row flags,
// tick. A lane takes a cell. Twin: displace.cpp, takeFromSources.
#version 450 core
#include "displace_targets.glsl"

layout(std430, binding = kBindRowChunks) readonly buffer RowChunks { RowChunk row_chunks[]; };
layout(std430, binding = kBindTarget) readonly buffer Target { int target[]; };
layout(std430, binding = kBindLeft) writeonly buffer Left { int left[]; };

void main() {
  if (groupIndex() >= tick.lists[sub_step].rows.used) return;
  RowChunk chunk = row_chunks[groupIndex()];
  DomainEntry domain = domains[chunk.domain];
  int column = chunk.chunk * kGroup + lane();
  if (column >= domain.width) return;
  int cell = chunk.row * domain.width + column;
  if (overlap[domain.first_cell + cell] <= 0) return;
  int to = target[domain.first_cell + cell];
  if (to != kNoTarget && takeFrom(domain, tileGrid(chunk.domain), cell, to) == 0) return;
  left[domain.first_cell + atomicAdd(row_flags[domain.first_row + domain.rows], 1)] = cell;
  atomicMax(tick.lists[sub_step].rounds.y, tick.lists[sub_step].rounds.used);
  atomicMax(tick.lists[sub_step].floods.y, tick.lists[sub_step].floods.used);
}
