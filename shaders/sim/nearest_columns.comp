// Stage nearest, first pass: for every cell of the listed rows the nearest free row of its own column.
// In: row chunks, free mask. Out: nearest row. A lane takes a cell. Twin: nearest.cpp, searchColumns.
#version 450 core
#include "tick.glsl"

layout(std430, binding = kBindDomains) readonly buffer Domains { DomainEntry domains[]; };
layout(std430, binding = kBindRowChunks) readonly buffer RowChunks { RowChunk row_chunks[]; };
layout(std430, binding = kBindFreeMask) readonly buffer FreeMask { uint free_mask[]; };
layout(std430, binding = kBindNearestRow) writeonly buffer NearestRow { int nearest_row[]; };
#include "free_rows.glsl"

void main() {
  if (groupIndex() >= lists[list].rows.used) return;
  RowChunk chunk = row_chunks[groupIndex()];
  DomainEntry domain = domains[chunk.domain];
  int column = chunk.chunk * kGroup + lane();
  if (column >= domain.width) return;
  nearest_row[domain.first_cell + chunk.row * domain.width + column] = nearestFreeRow(domain, column, chunk.row);
}
