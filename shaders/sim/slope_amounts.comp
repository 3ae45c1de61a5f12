// Stage relax, interleaved, first pass of a sweep: what each cell gives each neighbour that it gives to.
// In: tiles, tile states, height, bedrock, underside, materials. Out: amounts. A lane takes a column of a slab. Twin:
// slopes.cpp.
#version 450 core
#include "slope.glsl"

layout(std430, binding = kBindAmounts) writeonly buffer Amounts { int amounts[]; };

void main() {
  if (!beginColumn()) return;
  Row below = rowAt(first_y - 1);
  Row row = rowAt(first_y);
  for (int y = first_y; y < first_y + kSlabRows; ++y) {
    Row above = rowAt(y + 1);
    amounts[row.at.y] = amountOf(below, row, above);
    below = row;
    row = above;
  }
}
