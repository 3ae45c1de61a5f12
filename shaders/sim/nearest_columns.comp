// Stage nearest, first pass: for every cell of the listed rows the nearest free row of its own column.
// In: row chunks, free mask. Out: nearest row. A lane takes a cell. Twin: nearest.cpp, searchColumns.
#version 450 core
#include "../rules/nearest.h"
#include "tick.glsl"

layout(std430, binding = kBindDomains) readonly buffer Domains { DomainEntry domains[]; };
layout(std430, binding = kBindRowChunks) readonly buffer RowChunks { RowChunk row_chunks[]; };
layout(std430, binding = kBindFreeMask) readonly buffer FreeMask { uint free_mask[]; };
layout(std430, binding = kBindNearestRow) writeonly buffer NearestRow { int nearest_row[]; };

void main() {
  if (groupIndex() >= tick.lists[sub_step].rows.used) return;
  RowChunk chunk = row_chunks[groupIndex()];
  DomainEntry domain = domains[chunk.domain];
  int column = chunk.chunk * kGroup + lane();
  if (column >= domain.width) return;
  int first_word = domain.first_word + column;
  int word = chunk.row / kMaskRows;
  uint bit = uint(chunk.row % kMaskRows);

  uint found = free_mask[first_word + word * domain.width] & (0xffffffffu >> (31u - bit));
  int at = word;
  while (found == 0u && at > 0) found = free_mask[first_word + --at * domain.width];
  int beneath = found != 0u ? at * kMaskRows + findMSB(found) : kNoFreeRow;

  int words = (domain.rows + kMaskRows - 1) / kMaskRows;
  found = free_mask[first_word + word * domain.width] & (0xffffffffu << bit);
  at = word;
  while (found == 0u && at + 1 < words) found = free_mask[first_word + ++at * domain.width];
  int above = found != 0u ? at * kMaskRows + findLSB(found) : kNoFreeRow;

  nearest_row[domain.first_cell + chunk.row * domain.width + column] = nearestInColumn(chunk.row, beneath, above);
}
