// Craters' spatial hash, the prefix sum's last step: where each bucket begins; and empties them. In: head, starts. Out:
// first, heads. In and out: used. A lane takes kCraterLaneBuckets buckets. Twin: CraterSet::build.
#version 450 core
#include "crater_build.glsl"

void main() {
  int first = invocation() * kCraterLaneBuckets;
  if (first > crater_head.mask) return;
  int end = min(first + kCraterLaneBuckets, crater_head.mask + 1);
  int start = crater_starts[invocation()];
  for (int bucket = first; bucket < end; ++bucket) {
    crater_first[bucket] = start;
    start += craterCapacity(crater_used[bucket]);
    crater_used[bucket] = 0;
    crater_heads[bucket] = -1;
  }
}
