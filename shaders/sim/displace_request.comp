// Stage displace, first pass: sums up at every target what its sources want to push there; lists the targets' rows.
// In: row chunks, overlap, target. Out: requested, row flags, receivers, tick. A lane takes a cell.
// Twin: displace.cpp, addToTargets.
#version 450 core
#include "tick.glsl"

layout(std430, binding = kBindDomains) readonly buffer Domains { DomainEntry domains[]; };
layout(std430, binding = kBindRowChunks) readonly buffer RowChunks { RowChunk row_chunks[]; };
layout(std430, binding = kBindOverlap) readonly buffer Overlap { int overlap[]; };
layout(std430, binding = kBindTarget) readonly buffer Target { int target[]; };
layout(std430, binding = kBindRequestedLow) buffer RequestedLow { uint requested_low[]; };
layout(std430, binding = kBindRequestedHigh) buffer RequestedHigh { uint requested_high[]; };
layout(std430, binding = kBindReceivers) writeonly buffer Receivers { RowChunk receivers[]; };

void listRow(int domain, int row) {
  int flag = domains[domain].first_row + row;
  if ((row_flags[flag] & kRowReceives) != 0 || (atomicOr(row_flags[flag], kRowReceives) & kRowReceives) != 0) return;
  int chunks = (domains[domain].width + kGroup - 1) / kGroup;
  int first = atomicAdd(tick.lists[sub_step].receivers.used, chunks);
  atomicMax(tick.lists[sub_step].receivers.y, (first + chunks + kDispatchColumns - 1) / kDispatchColumns);
  for (int i = 0; i < chunks; ++i) receivers[first + i] = RowChunk(domain, row, i);
}

void main() {
  if (groupIndex() >= tick.lists[sub_step].rows.used) return;
  RowChunk chunk = row_chunks[groupIndex()];
  int column = chunk.chunk * kGroup + lane();
  int width = domains[chunk.domain].width;
  if (column >= width) return;
  int cell = domains[chunk.domain].first_cell + chunk.row * width + column;
  int amount = overlap[cell];
  if (amount <= 0 || target[cell] == kNoTarget) return;
  int to = domains[chunk.domain].first_cell + target[cell];
  uint before = atomicAdd(requested_low[to], uint(amount));
  if (before + uint(amount) < before) atomicAdd(requested_high[to], 1u);
  listRow(chunk.domain, target[cell] / width);
}
