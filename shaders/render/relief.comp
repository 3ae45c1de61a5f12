// Relief map: slope, sky and sun seen by each sample of a box of one level, from its heights.
// In: heights (units kFineHeightUnit, kCoarseHeightUnit). Out: dz/dx, dz/dy, sky share, sun share (image kReliefImage).
// Group: 8 x 8 samples. Samples within kShadowSteps of the border see the window extended; the morph rim hides them.
#version 450 core
#include "relief_job.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = kReliefImage, rgba16f) writeonly uniform image2D relief_out;

const float kSunEdge = 0.05;  // half width of the penumbra, as a tangent: soft, since samples are coarse

/// Rise from the sample to another [m].
float rise(int from, ivec2 at) { return float(heightAt(at) - from) / float(kUnitsPerMetre); }

/// Mean over eight directions of the share of the sky above the horizon that the ground makes close by.
float skyShare(ivec2 at, int own) {
  const ivec2 directions[8] = ivec2[8](ivec2(1, 0), ivec2(1, 1), ivec2(0, 1), ivec2(-1, 1),
                                       ivec2(-1, 0), ivec2(-1, -1), ivec2(0, -1), ivec2(1, -1));
  float seen = 0.0;
  for (int i = 0; i < 8; ++i) {
    float unit_m = length(vec2(directions[i])) * job.march.w;
    float near = rise(own, at + directions[i] * 2) / (2.0 * unit_m);
    float far = rise(own, at + directions[i] * kOcclusionReach) / (float(kOcclusionReach) * unit_m);
    float tangent = max(max(near, far), 0.0);
    seen += 1.0 - tangent * inversesqrt(1.0 + tangent * tangent);
  }
  return seen / 8.0;
}

/// Steepest view towards the sun's side, against the sun's own height: 1 lit, 0 in shadow.
float sunShare(ivec2 at, int own) {
  bool along_x = abs(job.march.x) >= abs(job.march.y);
  float step_m = length(job.march.xy) * job.march.w;
  float steepest = -1.0e9;
  for (int i = 1; i <= kShadowSteps; ++i) {
    vec2 place = job.march.xy * float(i);
    ivec2 low = ivec2(floor(place + 1.0e-4));
    vec2 part = clamp(place - vec2(low), 0.0, 1.0);
    float first = rise(own, at + low);
    float second = rise(own, at + low + (along_x ? ivec2(0, 1) : ivec2(1, 0)));
    steepest = max(steepest, mix(first, second, along_x ? part.y : part.x) / (float(i) * step_m));
  }
  return smoothstep(-kSunEdge, kSunEdge, job.march.z - steepest);
}

void main() {
  ivec2 in_box = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(in_box, job.box.zw))) return;
  ivec2 at = job.box.xy + in_box;
  int own = heightAt(at);
  imageStore(relief_out, wrapped(at), vec4(slopeOf(at), skyShare(at, own), sunShare(at, own)));
}
