// Stage relax, drift: a sweep in one pass, in which every cell finds the flows over its four edges. SPOOR_WEIGHTS is
// DriftStep::weights; SPOOR_PUSHES is 1 where bodies push.
// In: tiles, tile states, height, bedrock, underside, materials, pushes. Out: next height. A lane takes a column of a
// slab. Twin: slopes.cpp.
#version 450 core
#include "../rules/drift.h"
#include "slope.glsl"

layout(std430, binding = kBindNextHeight) writeonly buffer NextHeight { int next_height[]; };
#if SPOOR_PUSHES
layout(std430, binding = kBindPushX) readonly buffer PushX { int push_x[]; };
layout(std430, binding = kBindPushY) readonly buffer PushY { int push_y[]; };
#endif
layout(location = 4) uniform int step_time;  // DriftStep
layout(location = 5) uniform int quarter;
layout(location = 6) uniform int shift;
layout(location = 7) uniform int inverse_quarter;
layout(location = 8) uniform int phase;  // driftPhase

const int kAlongX = 0;
const int kAlongY = 1;

DriftCell driftCell(Row row, int i) {
  int kind = row.kind[i];
  return DriftCell(row.height[i], row.soil[i], row.room[i], materials[kind].slope_threshold, materials[kind].roughness,
                   uint(materials[kind].diagonal_threshold));
}

/// What bodies push from one cell to the next; any number where one of them is not active.
int pushOver(int from, int to, int axis) {
#if SPOOR_PUSHES
  from = max(from, 0);
  to = max(to, 0);
  return (axis == kAlongX ? push_x[from] + push_x[to] : push_y[from] + push_y[to]) >> 1;
#else
  return 0;
#endif
}

/// What flows from cell i of `from`, which is (x, y), to cell j of `to`.
int flowOver(Row from, int i, Row to, int j, int x, int y, int axis) {
  DriftStep drift = DriftStep(SPOOR_WEIGHTS, step_time, quarter, shift, uint(inverse_quarter));
  return driftFlow(drift, driftCell(from, i), driftCell(to, j), pushOver(from.at[i], to.at[j], axis),
                   driftDither(x, y, axis, uint(phase)));
}

void main() {
  if (!beginColumn()) return;
  int x = tiles[tile].x0 + columns.y;
  Row below = rowAt(first_y - 1);
  Row row = rowAt(first_y);
  int from_below = flowOver(below, 1, row, 1, x, tiles[tile].y0 + first_y - 1, kAlongY);
  for (int i = first_y; i < first_y + kSlabRows; ++i) {
    int y = tiles[tile].y0 + i;
    Row above = rowAt(i + 1);
    int from_left = flowOver(row, 0, row, 1, x - 1, y, kAlongX);
    int to_right = flowOver(row, 1, row, 2, x, y, kAlongX);
    int to_above = flowOver(row, 1, above, 1, x, y, kAlongY);
    next_height[row.at.y] = row.height.y + from_below + from_left - to_right - to_above;
    from_below = to_above;
    row = above;
  }
}
