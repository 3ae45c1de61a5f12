// Stage displace, third pass: targets take what they let in, and those that were asked for too much are closed.
// In: receivers, underside. In and out: requested, granted, height, overlap, free mask, tick.highest. Out: tile states.
// A lane takes a cell. Twin: displace.cpp, giveToTargets.
#version 450 core
#include "displace_targets.glsl"

layout(std430, binding = kBindRowChunks) readonly buffer RowChunks { RowChunk row_chunks[]; };
layout(location = 2) uniform int relax_step;  // of the relaxation, that comes next

void main() {
  if (groupIndex() >= tick.lists[sub_step].receivers.used) return;
  RowChunk chunk = row_chunks[groupIndex()];
  DomainEntry domain = domains[chunk.domain];
  int column = chunk.chunk * kGroup + lane();
  if (column >= domain.width) return;
  int cell = domain.first_cell + chunk.row * domain.width + column;
  if (wideZero(requestedAt(cell))) return;
  giveTo(domain, tileGrid(chunk.domain), ivec2(column, chunk.row), granted[cell], relax_step);
}
