// Craters' spatial hash: puts listed entries behind those that their buckets hold, by record, then tag. In: first,
// used, heads. Out: entries. In and out: nodes. A lane takes a node. Twin: CraterSet::insert.
#version 450 core
#include "crater_build.glsl"

bool before(CraterEntry a, CraterEntry b) { return a.record < b.record || (a.record == b.record && a.tag < b.tag); }

void main() {
  int node = invocation();
  if (node == 0) crater_node_count = 0;  // for the next list
  if (node >= end_of_all) return;
  CraterEntry entry = crater_nodes[node].entry;
  int bucket = crater_nodes[node].bucket;
  int rank = 0, count = 0;
  for (int other = crater_heads[bucket]; other >= 0; other = crater_nodes[other].next) {
    ++count;
    if (before(crater_nodes[other].entry, entry)) ++rank;
  }
  crater_entries[crater_first[bucket] + crater_used[bucket] + rank] = entry;
  crater_nodes[node].grown = rank == count - 1 ? count : 0;
}
