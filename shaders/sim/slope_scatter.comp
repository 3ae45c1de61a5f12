// Stage relax, scatter: a sweep in one pass. Every cell adds itself, less what it gives, to its place in the next
// plane, and what it gives to its neighbours' places. In: tiles, tile states, height, bedrock, underside, materials.
// In and out: next height, which is 0 before. Out: spare height, which is 0 afterwards. A lane takes a column of a
// slab. Twin: slopes.cpp.
#version 450 core
#include "slope.glsl"

layout(std430, binding = kBindNextHeight) buffer NextHeight { int next_height[]; };
layout(std430, binding = kBindSpareHeight) writeonly buffer SpareHeight { int spare_height[]; };

/// Gives to three neighbours; returns how much in all.
int giveTo(Row row, int amount, Row neighbours, bool with_middle) {
  int given = 0;
  for (int i = 0; i < 3; ++i) {
    if (i == 1 && !with_middle || !givesTo(row, 1, neighbours, i)) continue;
    int flow = slopeFlow(amount, neighbours.room[i]);
    if (flow == 0) continue;
    atomicAdd(next_height[neighbours.at[i]], flow);
    given += flow;
  }
  return given;
}

void main() {
  if (!beginColumn()) return;
  Row below = rowAt(first_y - 1);
  Row row = rowAt(first_y);
  for (int y = first_y; y < first_y + kSlabRows; ++y) {
    Row above = rowAt(y + 1);
    int amount = amountOf(below, row, above);
    int given = giveTo(row, amount, below, true) + giveTo(row, amount, row, false) + giveTo(row, amount, above, true);
    atomicAdd(next_height[row.at.y], row.height.y - given);
    spare_height[row.at.y] = 0;
    below = row;
    row = above;
  }
}
