// How the ground looks at a place: snow, sand or mud under a low sun.
#include "relief.glsl"
#include "light.glsl"
#include "body_shadow.glsl"
#include "detail.glsl"
#include "highlight.glsl"

vec3 groundAlbedo() {
  if (frame.world.z == kGroundSand) return vec3(0.60, 0.43, 0.25);
  if (frame.world.z == kGroundMud) return vec3(0.115, 0.080, 0.052);
  return vec3(0.86, 0.88, 0.91);
}

/// Sides of a pixel's footprint on the ground [cells]: the shorter and the longer.
vec2 footprintAt(vec3 rel, vec2 rel_cells) {
  float per_pixel = 1.0 / (frame.scale.x * frame.scale.y);
  if (frame.eye.w > 0.0) return vec2(per_pixel);
  vec3 ray = rel - frame.eye.xyz;
  float away_m = length(ray);
  vec3 normal = normalize(vec3(-coarseGradient(rel_cells), 1.0));
  float facing = max(abs(dot(normal, ray)) / away_m, 0.03);
  return away_m * per_pixel * vec2(1.0, 1.0 / facing);
}

/// Colour that the ground sends to the eye, with fog; kShadeNormals: its normal.
vec3 shadedGround(vec3 rel, vec2 rel_cells, vec2 footprint) {
  // Between the shorter and the longer side: blurring by the longer would wipe out tracks at grazing angles.
  Relief relief = reliefAt(rel_cells, 0.6 * sqrt(footprint.x * footprint.y));
  vec3 smooth_normal = normalize(vec3(-relief.gradient, 1.0));
  if (frame.world.w == kShadeNormals) return smooth_normal * 0.5 + 0.5;

  vec3 grain = grainAt(rel_cells, footprint.y);
  vec3 normal = normalize(vec3(-relief.gradient - grain.xy, 1.0));
  vec3 albedo = groundAlbedo() * (1.0 + grain.z);
  vec2 cell = rel_cells + vec2(frame.origin.xy);
  bool outside = any(lessThan(cell, vec2(-0.5))) || any(greaterThan(cell, vec2(frame.world.xy) - 0.5));
  if (outside) albedo = mix(albedo, vec3(dot(albedo, vec3(0.3333))), 0.6) * 0.85;

  float lit = max(dot(normal, frame.sun.xyz), 0.0) * relief.sun * bodyShadow(rel, smooth_normal, 0.01);
  float sky = relief.sky * relief.sky;
  vec3 colour = albedo * (kSunLight * lit + skyLight(smooth_normal, groundAlbedo()) * sky);
  return toScreen(withFog(colour, rel));
}

vec3 groundColour(vec3 rel) {
  vec2 rel_cells = rel.xy / frame.scale.x;
  vec2 footprint = footprintAt(rel, rel_cells);
  return withHighlight(shadedGround(rel, rel_cells, footprint), rel_cells, footprint.y);
}
