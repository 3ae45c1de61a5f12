// Stage displace, later rounds: soil that found no room looks for the next free cell, and the next. A group takes a
// domain, so that its rounds need no dispatch each; a lane takes a source, or a target.
// In: underside; target where SPOOR_SEARCH is 0, which flooding found. In and out: overlap, height, free mask, left,
// tick.highest. Out: tile states, tick. Twin: displace.cpp.
#version 450 core
#define SPOOR_COHERENT coherent
#include "displace_targets.glsl"
#include "kept_back.glsl"

layout(std430, binding = kBindLeft) coherent buffer Left { int left[]; };
layout(location = 2) uniform int relax_step;  // of the relaxation, that comes next
layout(location = 3) uniform int round_count;
layout(location = 4) uniform int last;  // 1: nothing looks for a free cell after this dispatch

shared int receiver_count;
const uint kListed = 0x80000000u;  // in `granted` of a target, which never needs that bit

#if SPOOR_SEARCH
#include "free_rows.glsl"

/// The first free cell in the order of rules/nearest.h.
int findTarget(DomainEntry domain, int cell) {
  int row = cell / domain.width;
  int x = cell % domain.width;
  ivec2 best = ivec2(-1, -1);
  int best_distance = 0x7fffffff;
  for (int k = 0; x - k >= 0 || x + k < domain.width; ++k) {
    if (metricDistance(k, 0, SPOOR_METRIC) > best_distance) break;
    for (int side = -1; side <= (k == 0 ? -1 : 1); side += 2) {
      int column = x + side * k;
      if (column < 0 || column >= domain.width) continue;
      int free_row = nearestFreeRow(domain, column, row);
      if (free_row == kNoFreeRow) continue;
      if (best.x >= 0 && !nearestBefore(x, row, column, free_row, best.x, best.y, SPOOR_METRIC)) continue;
      best = ivec2(column, free_row);
      best_distance = metricDistance(column - x, free_row - row, SPOOR_METRIC);
    }
  }
  int found = best.x < 0 ? kNoTarget : best.y * domain.width + best.x;
  granted[domain.first_cell + cell] = uint(found + 1);  // of a source nothing else is kept there
  return found;
}
int knownTarget(DomainEntry domain, int cell) { return int(granted[domain.first_cell + cell]) - 1; }
void dropTarget(DomainEntry domain, int cell) { granted[domain.first_cell + cell] = 0u; }
#else
layout(std430, binding = kBindTarget) readonly buffer Target { int target[]; };
int findTarget(DomainEntry domain, int cell) { return target[domain.first_cell + cell]; }
int knownTarget(DomainEntry domain, int cell) { return target[domain.first_cell + cell]; }
void dropTarget(DomainEntry domain, int cell) {}
#endif

/// @param end  one beyond the domain's last cell
void requestFrom(DomainEntry domain, int cell, int end) {
  int found = findTarget(domain, cell);
  if (found == kNoTarget) return;
  Source source = sourceAt(domain, cell, found);
  for (int i = 0; i < source.parts; ++i) {
    ivec2 to = partTarget(source, i);
    int to_cell = to.y * domain.width + to.x;
    request(domain.first_cell + to_cell, partAmount(source, i));
    if ((atomicOr(granted[domain.first_cell + to_cell], kListed) & kListed) == 0u)
      left[end - 1 - atomicAdd(receiver_count, 1)] = to_cell;
  }
}

void passOver() {
  memoryBarrierBuffer();
  barrier();
}

void main() {
  if (groupIndex() >= group_count) return;
  DomainEntry domain = domains[groupIndex()];
  int left_count = row_flags[domain.first_row + domain.rows];
  if (left_count == 0) return;
  TileGrid grid = tileGrid(groupIndex());
  int end = domain.first_cell + domain.width * domain.rows;
  for (int round = 0; round < round_count; ++round) {
    if (lane() == 0) receiver_count = 0;
    barrier();
    for (int i = lane(); i < left_count; i += kGroup) {
      int cell = left[domain.first_cell + i];
      if (overlap[domain.first_cell + cell] > 0) requestFrom(domain, cell, end);
    }
    passOver();
    if (receiver_count == 0) break;
    for (int i = lane(); i < left_count; i += kGroup) {
      int cell = left[domain.first_cell + i];
      if (overlap[domain.first_cell + cell] <= 0) continue;
      int to = knownTarget(domain, cell);
      if (to != kNoTarget) takeFrom(domain, grid, cell, to);
    }
    passOver();
    for (int i = lane(); i < receiver_count; i += kGroup) {
      int to = left[end - 1 - i];
      giveTo(domain, grid, ivec2(to % domain.width, to / domain.width), granted[domain.first_cell + to] & ~kListed,
             relax_step);
    }
    passOver();
  }
  for (int i = lane(); i < left_count; i += kGroup) {
    int cell = left[domain.first_cell + i];
    dropTarget(domain, cell);
    if (last != 0 && overlap[domain.first_cell + cell] > 0) keepBack(overlap[domain.first_cell + cell]);
  }
}
