// Craters' spatial hash: what was put into buckets is part of them. In: nodes. Out: heads. In and out: used. A lane
// takes a node; of each bucket one does the work. Twin: CraterSet::insert.
#version 450 core
#include "crater_build.glsl"

void main() {
  int node = invocation();
  if (node >= end_of_all || crater_nodes[node].grown == 0) return;
  int bucket = crater_nodes[node].bucket;
  crater_used[bucket] += crater_nodes[node].grown;
  crater_heads[bucket] = -1;
}
