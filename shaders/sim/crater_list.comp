// Craters' spatial hash: lists the entries of new records by bucket, in no particular order. In: head, shapes. In and
// out: nodes, heads. A lane takes a record. Twin: CraterSet::insert.
#version 450 core
#include "crater_build.glsl"

void main() {
  int record = first_of_all + invocation();
  if (record >= end_of_all) return;
  CraterCells cells = cellsOf(record);
  for (int i = 0; i < cells.count; ++i) {
    ivec2 cell = cellAt(cells, i);
    int node = atomicAdd(crater_node_count, 1);
    int bucket = craterBucket(cell.x, cell.y, crater_head.mask);
    crater_nodes[node].entry = CraterEntry(record, craterTag(cell.x, cell.y));
    crater_nodes[node].bucket = bucket;
    crater_nodes[node].next = atomicExchange(crater_heads[bucket], node);
  }
}
