// Blurred slopes: one pass of the 3 x 3 Gaussian over the slopes of a box of level 0 (Persson 2019, 4.1.6), from which
// normals are made. The last pass writes to the relief map, whose other half stays.
// In: heights in the first pass, what the pass before left (image kBlurFromImage) in others.
// Out: dz/dx, dz/dy (image kBlurToImage; kReliefImage in the last pass). Beyond the window: the border's slopes.
// Group: 8 x 8 samples.
#version 450 core
#include "relief_job.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = kBlurFromImage, rg32f) readonly uniform image2D slopes_in;
layout(binding = kBlurToImage, rg32f) writeonly uniform image2D slopes_out;
layout(binding = kReliefImage, rgba16f) uniform image2D relief_map;

vec2 slopeBefore(ivec2 at) {
  if (job.blur.x == 1) return slopeOf(clamp(at, ivec2(0), ivec2(job.window.x - 1)));
  return imageLoad(slopes_in, wrapped(at)).xy;
}

void main() {
  ivec2 in_box = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(in_box, job.box.zw))) return;
  ivec2 at = job.box.xy + in_box;
  vec2 sum = vec2(0.0);
  for (int y = -1; y <= 1; ++y)
    for (int x = -1; x <= 1; ++x) sum += float((2 - abs(x)) * (2 - abs(y))) * slopeBefore(at + ivec2(x, y));
  ivec2 texel = wrapped(at);
  if (job.blur.x < job.blur.y)
    imageStore(slopes_out, texel, vec4(sum / 16.0, 0.0, 0.0));
  else
    imageStore(relief_map, texel, vec4(sum / 16.0, imageLoad(relief_map, texel).zw));
}
