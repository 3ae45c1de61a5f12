// Stage relax, interleaved, second pass of a sweep: every cell loses what it gives and gains what it is given.
// In: tiles, tile states, height, underside, materials, amounts. Out: next height. A lane takes a column of a slab.
// Twin: slopes.cpp.
#version 450 core
#include "slope.glsl"

layout(std430, binding = kBindAmounts) readonly buffer Amounts { int amounts[]; };
layout(std430, binding = kBindNextHeight) writeonly buffer NextHeight { int next_height[]; };

/// What the middle cell of `row` gains from three neighbours, less what it loses to them.
int gainFrom(Row row, int amount, Row neighbours, bool with_middle) {
  int gain = 0;
  for (int i = 0; i < 3; ++i) {
    if (i == 1 && !with_middle || neighbours.at[i] < 0) continue;
    if (givesTo(row, 1, neighbours, i)) gain -= slopeFlow(amount, neighbours.room[i]);
    if (givesTo(neighbours, i, row, 1)) gain += slopeFlow(amounts[neighbours.at[i]], row.room.y);
  }
  return gain;
}

void main() {
  if (!beginColumn()) return;
  Row below = rowAt(first_y - 1);
  Row row = rowAt(first_y);
  for (int y = first_y; y < first_y + kSlabRows; ++y) {
    Row above = rowAt(y + 1);
    int amount = amounts[row.at.y];
    next_height[row.at.y] = row.height.y + gainFrom(row, amount, below, true) + gainFrom(row, amount, row, false) +
                            gainFrom(row, amount, above, true);
    below = row;
    row = above;
  }
}
