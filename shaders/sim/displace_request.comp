// Stage displace, first pass of a round: sums up at every target what its sources want to push there; lists the
// targets' rows. In: row chunks, overlap; in the first round, and after flooding, target. Out: requested, row flags,
// receivers, tick. SPOOR_SEARCH is 1 in rounds that find the targets here. A lane takes a cell. Twin: displace.cpp,
// addToTargets.
#version 450 core
#include "displace.glsl"

layout(std430, binding = kBindRowFlags) buffer RowFlags { int row_flags[]; };
layout(std430, binding = kBindRowChunks) readonly buffer RowChunks { RowChunk row_chunks[]; };
layout(std430, binding = kBindTarget) buffer Target { int target[]; };
layout(std430, binding = kBindRequestedLow) buffer RequestedLow { uint requested_low[]; };
layout(std430, binding = kBindRequestedHigh) buffer RequestedHigh { uint requested_high[]; };
layout(std430, binding = kBindReceivers) writeonly buffer Receivers { RowChunk receivers[]; };
layout(location = 2) uniform int round;

#if SPOOR_SEARCH
layout(std430, binding = kBindFreeMask) readonly buffer FreeMask { uint free_mask[]; };
layout(std430, binding = kBindNearestRow) readonly buffer NearestRow { int nearest_row[]; };
#include "free_rows.glsl"

/// What stage nearest found is still right where that cell has not been closed.
int freeRowOf(DomainEntry domain, int column, int row) {
  int known = nearest_row[domain.first_cell + row * domain.width + column];
  if (known == kNoFreeRow) return known;
  uint word = free_mask[domain.first_word + known / kMaskRows * domain.width + column];
  if ((word >> uint(known % kMaskRows) & 1u) != 0u) return known;
  return nearestFreeRow(domain, column, row);
}

/// The first free cell in the order of rules/nearest.h. The few cells that are left are not worth nearest's passes over
/// their whole rows.
int findTarget(DomainEntry domain, int x, int row) {
  ivec2 best = ivec2(-1, -1);
  int best_distance = 0x7fffffff;
  for (int k = 0; x - k >= 0 || x + k < domain.width; ++k) {
    if (metricDistance(k, 0, SPOOR_METRIC) > best_distance) break;
    for (int side = -1; side <= (k == 0 ? -1 : 1); side += 2) {
      int column = x + side * k;
      if (column < 0 || column >= domain.width) continue;
      int free_row = freeRowOf(domain, column, row);
      if (free_row == kNoFreeRow) continue;
      if (best.x >= 0 && !nearestBefore(x, row, column, free_row, best.x, best.y, SPOOR_METRIC)) continue;
      best = ivec2(column, free_row);
      best_distance = metricDistance(column - x, free_row - row, SPOOR_METRIC);
    }
  }
  return best.x < 0 ? kNoTarget : best.y * domain.width + best.x;
}
#endif

void request(int at, int amount) {
  uint before = atomicAdd(requested_low[at], uint(amount));
  if (before + uint(amount) < before) atomicAdd(requested_high[at], 1u);
}

void listRow(int domain, int row) {
  int flag = domains[domain].first_row + row;
  int bit = kRowReceives << round;
  if ((row_flags[flag] & bit) != 0 || (atomicOr(row_flags[flag], bit) & bit) != 0) return;
  int chunks = (domains[domain].width + kGroup - 1) / kGroup;
  int first = atomicAdd(lists[list].receivers.used, chunks);
  atomicMax(lists[list].receivers.y, (first + chunks + kDispatchColumns - 1) / kDispatchColumns);
  for (int i = 0; i < chunks; ++i) receivers[first + i] = RowChunk(domain, row, i);
}

void main() {
  if (groupIndex() >= lists[list].rows.used) return;
  RowChunk chunk = row_chunks[groupIndex()];
  DomainEntry domain = domains[chunk.domain];
  int column = chunk.chunk * kGroup + lane();
  if (column >= domain.width) return;
  int cell = chunk.row * domain.width + column;
  if (overlap[domain.first_cell + cell] <= 0) return;
#if SPOOR_SEARCH
  // Cells are closed but never freed: what found none before finds none now.
  if (target[domain.first_cell + cell] == kNoTarget) return;
  target[domain.first_cell + cell] = findTarget(domain, column, chunk.row);
#endif
  if (target[domain.first_cell + cell] == kNoTarget) return;
  Source source = sourceAt(domain, cell, target[domain.first_cell + cell]);
  for (int i = 0; i < source.parts; ++i) {
    ivec2 to = partTarget(source, i);
    request(domain.first_cell + to.y * domain.width + to.x, partAmount(source, i));
    listRow(chunk.domain, to.y);
  }
}
