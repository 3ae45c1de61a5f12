// Stage relax, flux: a sweep in one pass, in which every cell finds the flows over its eight edges.
// In: tiles, tile states, height, bedrock, underside, materials. Out: next height. A lane takes a column of a slab.
// Twin: slopes.cpp.
#version 450 core
#include "slope.glsl"

layout(std430, binding = kBindNextHeight) writeonly buffer NextHeight { int next_height[]; };

int thresholdOf(int kind, bool diagonal) {
  return diagonal ? materials[kind].diagonal_threshold : materials[kind].slope_threshold;
}

int lossTo(Row row, Row neighbours, int i, bool diagonal) {
  int own = row.kind.y;
  int other = neighbours.kind[i];
  return slopeFlux(row.height.y, neighbours.height[i], thresholdOf(own, diagonal), thresholdOf(other, diagonal),
                   materials[own].roughness, materials[other].roughness, row.soil.y, neighbours.soil[i], row.room.y,
                   neighbours.room[i]);
}

/// What the middle cell of `row` loses to a row beneath or above it.
int lossTo(Row row, Row neighbours) {
  return lossTo(row, neighbours, 0, true) + lossTo(row, neighbours, 1, false) + lossTo(row, neighbours, 2, true);
}

void main() {
  if (!beginColumn()) return;
  Row below = rowAt(first_y - 1);
  Row row = rowAt(first_y);
  for (int y = first_y; y < first_y + kSlabRows; ++y) {
    Row above = rowAt(y + 1);
    next_height[row.at.y] = row.height.y - lossTo(row, below) - lossTo(row, above) - lossTo(row, row, 0, false) -
                            lossTo(row, row, 2, false);
    below = row;
    row = above;
  }
}
