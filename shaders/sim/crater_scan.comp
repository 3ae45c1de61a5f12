// Craters' spatial hash, the prefix sum's second step: from sums to where each lane's buckets begin. In and out:
// starts. One group takes all of them, a lane a stretch. Twin: CraterSet::build.
#version 450 core
#include "crater_build.glsl"

shared int sums[SPOOR_GROUP];

void main() {
  int lane = int(gl_LocalInvocationID.x);
  int stretch = (end_of_all + SPOOR_GROUP - 1) / SPOOR_GROUP;
  int first = min(lane * stretch, end_of_all), end = min(first + stretch, end_of_all);
  int sum = 0;
  for (int i = first; i < end; ++i) sum += crater_starts[i];
  sums[lane] = sum;
  barrier();
  int start = 0;
  for (int i = 0; i < lane; ++i) start += sums[i];
  for (int i = first; i < end; ++i) {
    int places = crater_starts[i];
    crater_starts[i] = start;
    start += places;
  }
}
