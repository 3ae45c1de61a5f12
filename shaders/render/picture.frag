// Picture, fragment stage: puts bodies, ground and sky together and shades the last two, once a pixel where
// samples lie close together. In: bodies' colours (alpha 1) and depths of all samples.
// Out: colour; alpha: share that is no sky.
#version 450 core
#include "ground.glsl"

layout(binding = kColourUnit) uniform sampler2DMS colour_in;
layout(binding = kDepthUnit) uniform sampler2DMS depth_in;
layout(location = 0) out vec4 colour_out;

const int kSampleLimit = 8;
const vec3 kPaper = vec3(0.97);  // behind columns

/// The place that a depth stands for, through the middle of the pixel.
vec3 placeAt(vec2 screen, float depth) {
  vec3 aside = screen.x * frame.ray_right.xyz + screen.y * frame.ray_up.xyz;
  if (frame.eye.w > 0.0) return frame.eye.xyz + aside + (1.0 - depth) * frame.ray_forward.w * frame.ray_forward.xyz;
  return frame.eye.xyz + frame.ray_forward.w / depth * (frame.ray_forward.xyz + aside);
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec2 screen = gl_FragCoord.xy / vec2(textureSize(depth_in)) * 2.0 - 1.0;
  int sample_count = min(int(frame.look.z), kSampleLimit);
  vec4 sum = vec4(0.0);
  float ground_count = 0.0, depth_sum = 0.0, nearest = 0.0, furthest = 1.0;
  float depths[kSampleLimit];
  for (int i = 0; i < sample_count; ++i) {
    vec4 body = texelFetch(colour_in, pixel, i);
    float depth = texelFetch(depth_in, pixel, i).r;
    bool ground = depth > 0.0 && body.a == 0.0;
    depths[i] = ground ? depth : 0.0;
    sum += body.a == 0.0 ? vec4(0.0) : body;
    if (!ground) continue;
    ground_count += 1.0;
    depth_sum += depth;
    nearest = max(nearest, depth);
    furthest = min(furthest, depth);
  }
  // Shaded once where samples lie close together.
  vec2 places[kSampleLimit];  // depth, how many samples it stands for
  int place_count = 0;
  if (ground_count > 0.0 && crater_head.mask >= 0 && nearest > 1.01 * furthest && nearest < 1.15 * furthest) {
    // Between a rim and what lies behind it there is nothing to be shaded: both, by how many samples show them.
    float middle = 0.5 * (nearest + furthest);
    vec2 near = vec2(0.0), far = vec2(0.0);  // sum of depths, count
    for (int i = 0; i < sample_count; ++i) {
      if (depths[i] > middle) near += vec2(depths[i], 1.0);
      if (depths[i] > 0.0 && depths[i] <= middle) far += vec2(depths[i], 1.0);
    }
    places[0] = vec2(near.x / near.y, near.y);
    places[1] = vec2(far.x / far.y, far.y);
    place_count = 2;
  } else if (ground_count > 0.0 && (frame.eye.w > 0.0 || nearest < 1.15 * furthest)) {
    places[0] = vec2(depth_sum / ground_count, ground_count);
    place_count = 1;
  } else if (ground_count > 0.0) {
    for (int i = 0; i < sample_count; ++i)
      if (depths[i] > 0.0) places[place_count++] = vec2(depths[i], 1.0);
  }
  // In one place: what it calls is long, and drivers put it wherever it is called.
  for (int i = 0; i < place_count; ++i) sum += vec4(groundColour(placeAt(screen, places[i].x)), 1.0) * places[i].y;
  float covered = sum.a / float(sample_count);
  vec3 direction = normalize(frame.ray_forward.xyz + screen.x * frame.ray_right.xyz + screen.y * frame.ray_up.xyz);
  vec3 behind = covered < 1.0 ? toScreen(skyWithSun(direction)) : vec3(0.0);
  if (frame.world.w == kShadeColumns) behind = kPaper;
  colour_out = vec4(sum.rgb / float(sample_count) + (1.0 - covered) * behind, covered);
}
