// Stage displace, first pass: sums up at every target what its sources want to push there; lists the targets' rows.
// In: row chunks, overlap, target. Out: requested, row flags, receivers, tick. A lane takes a cell.
// Twin: displace.cpp, addToTargets.
#version 450 core
#include "displace.glsl"

layout(std430, binding = kBindRowChunks) readonly buffer RowChunks { RowChunk row_chunks[]; };
layout(std430, binding = kBindTarget) readonly buffer Target { int target[]; };
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
  DomainEntry domain = domains[chunk.domain];
  int column = chunk.chunk * kGroup + lane();
  if (column >= domain.width) return;
  int cell = chunk.row * domain.width + column;
  if (overlap[domain.first_cell + cell] <= 0 || target[domain.first_cell + cell] == kNoTarget) return;
  Source source = sourceAt(domain, cell, target[domain.first_cell + cell]);
  for (int i = 0; i < source.parts; ++i) {
    ivec2 to = partTarget(source, i);
    request(domain.first_cell + to.y * domain.width + to.x, partAmount(source, i));
    listRow(chunk.domain, to.y);
  }
}
