// Craters' spatial hash: counts the entries of each bucket. In: head, shapes. In and out: used, 0 before. A lane takes
// a record. Twin: CraterSet::build.
#version 450 core
#include "crater_build.glsl"

void main() {
  int record = first_of_all + invocation();
  if (record >= end_of_all) return;
  CraterCells cells = cellsOf(record);
  for (int i = 0; i < cells.count; ++i) {
    ivec2 cell = cellAt(cells, i);
    atomicAdd(crater_used[craterBucket(cell.x, cell.y, crater_head.mask)], 1);
  }
}
