// Craters' spatial hash, the prefix sum's first step: adds up the places of a lane's buckets. In: head, used. Out:
// starts. A lane takes kCraterLaneBuckets buckets. Twin: CraterSet::build.
#version 450 core
#include "crater_build.glsl"

void main() {
  int first = invocation() * kCraterLaneBuckets;
  if (first > crater_head.mask) return;
  int end = min(first + kCraterLaneBuckets, crater_head.mask + 1);
  int sum = 0;
  for (int bucket = first; bucket < end; ++bucket) sum += craterCapacity(crater_used[bucket]);
  crater_starts[invocation()] = sum;
}
