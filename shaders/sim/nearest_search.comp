// Stage nearest, second pass: the nearest free cell, by the best column of a row.
// The best column never falls from one cell of a row to the next, so cells that are found first (every `stride`-th)
// bound the search of those between them; and no column farther away than the best so far is looked at.
// In: row chunks, nearest row, overlap. Out: target of every stride-th cell, and at stride 1 of those that need one.
// SPOOR_METRIC is that of rules/nearest.h. A lane takes a cell. Twin: nearest.cpp, RowEnvelope.
#version 450 core
#include "../rules/nearest.h"
#include "tick.glsl"

layout(std430, binding = kBindDomains) readonly buffer Domains { DomainEntry domains[]; };
layout(std430, binding = kBindRowChunks) readonly buffer RowChunks { RowChunk row_chunks[]; };
layout(std430, binding = kBindNearestRow) readonly buffer NearestRow { int nearest_row[]; };
layout(std430, binding = kBindOverlap) readonly buffer Overlap { int overlap[]; };
layout(std430, binding = kBindTarget) buffer Target { int target[]; };
layout(location = 2) uniform int stride;
layout(location = 3) uniform int found_stride;   // of the cells found before; 0: none
layout(location = 4) uniform int least_overlap;  // of cells that need a target: 1, or kObstacle

int row_start;
int row;
int x;
ivec2 best;
int best_distance;

void consider(int column) {
  int free_row = nearest_row[row_start + column];
  if (free_row == kNoFreeRow) return;
  if (best.x >= 0 && !nearestBefore(x, row, column, free_row, best.x, best.y, SPOOR_METRIC)) return;
  best = ivec2(column, free_row);
  best_distance = metricDistance(column - x, free_row - row, SPOOR_METRIC);
}

void search(int low, int high) {
  best = ivec2(-1, -1);
  best_distance = 0x7fffffff;
  for (int k = max(0, max(low - x, x - high)); x - k >= low || x + k <= high; ++k) {
    if (metricDistance(k, 0, SPOOR_METRIC) > best_distance) return;
    if (x - k >= low && x - k <= high) consider(x - k);
    if (k > 0 && x + k >= low && x + k <= high) consider(x + k);
  }
}

void main() {
  if (groupIndex() >= lists[list].rows.used) return;
  RowChunk chunk = row_chunks[groupIndex()];
  DomainEntry domain = domains[chunk.domain];
  row = chunk.row;
  row_start = domain.first_cell + row * domain.width;
  x = (chunk.chunk * kGroup + lane()) * stride;
  if (x >= domain.width) return;
  if (found_stride > 0 && x % found_stride == 0) return;
  if (stride == 1 && overlap[row_start + x] < least_overlap) return;
  int low = 0;
  int high = domain.width - 1;
  if (found_stride > 0) {
    int before = x / found_stride * found_stride;
    int low_target = target[row_start + before];
    if (low_target == kNoTarget) {
      target[row_start + x] = kNoTarget;  // there is no free cell at all
      return;
    }
    low = low_target % domain.width;
    if (before + found_stride < domain.width) high = target[row_start + before + found_stride] % domain.width;
  }
  search(low, high);
  target[row_start + x] = best.x < 0 ? kNoTarget : best.y * domain.width + best.x;
}
