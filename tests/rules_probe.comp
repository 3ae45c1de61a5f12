// Runs rules_probe.h on the GPU. Out: result of rule y for seed x at [x * kProbeCount + y]. Group: 64 seeds. Twin: rules_gl_test.cpp.
#version 450 core
#include "rules_probe.h"

layout(local_size_x = 64) in;
layout(std430, binding = 0) writeonly buffer Results { int results[]; };
layout(location = 0) uniform int seed_count;

void main() {
  int seed = int(gl_GlobalInvocationID.x);
  if (seed >= seed_count) return;
  for (int which = 0; which < kProbeCount; ++which) results[seed * kProbeCount + which] = probeRule(which, seed);
}
