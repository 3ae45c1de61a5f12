// How the ground looks at a place: snow, sand, mud, dirt or grass, and craters in it, under a low sun.
#include "relief.glsl"
#include "light.glsl"
#include "body_shadow.glsl"
#include "detail.glsl"
#include "map_place.glsl"
#include "ground_cover.glsl"
#include "crater_look.glsl"
#include "highlight.glsl"

vec3 groundAlbedo() {
  if (frame.world.z == kGroundSand) return vec3(0.60, 0.43, 0.25);
  if (frame.world.z == kGroundMud) return vec3(0.115, 0.080, 0.052);
  if (frame.world.z == kGroundDirt) return vec3(0.350, 0.175, 0.097);
  if (frame.world.z == kGroundGrass) return vec3(0.090, 0.140, 0.035);
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

/// What the map's places look like close by, and the craters in them.
/// @param bounced  the albedo of the ground about the place
void addDetail(vec2 rel, vec2 footprint_cells, inout vec3 albedo, inout vec3 bounced, inout vec2 slope,
               inout float sky) {
  MapPlace place = mapPlace(rel);
  vec2 footprint_m = footprint_cells * frame.scale.x;
  GroundCover cover = GroundCover(albedo, vec2(0.0));
  if (frame.world.z == kGroundDirt) cover = dirtAt(place.at, footprint_m.y);
  if (frame.world.z == kGroundGrass) cover = grassAt(place.at, footprint_m.y);
  CraterLook look = craterLookAt(place.at, footprint_m);
  albedo = cover.albedo * (1.0 - look.cover) + look.albedo;
  bounced = bounced * (1.0 - look.cover) + look.albedo;
  sky = mix(sky, 0.30 + 0.70 * sqrt(sky), look.cover);  // a cavity's walls light each other
  slope += place.facing * frame.look.x * (cover.slope * (1.0 - look.bare) + look.slope);
}

/// Colour that the ground sends to the eye, with fog; kShadeNormals: its normal.
vec3 shadedGround(vec3 rel, vec2 rel_cells, vec2 footprint) {
  // Between the shorter and the longer side: blurring by the longer would wipe out tracks at grazing angles.
  Relief relief = reliefAt(rel_cells, 0.6 * sqrt(footprint.x * footprint.y));
  vec3 smooth_normal = normalize(vec3(-relief.gradient, 1.0));
  if (frame.world.w == kShadeNormals) return smooth_normal * 0.5 + 0.5;

  vec3 grain = grainAt(rel_cells, footprint.y);
  vec2 slope = relief.gradient + grain.xy;
  float sky = relief.sky * relief.sky;
  vec3 bounced = groundAlbedo();
  vec3 albedo = bounced * (1.0 + grain.z);
  if (crater_head.mask >= 0 || frame.world.z >= kGroundDirt) addDetail(rel.xy, footprint, albedo, bounced, slope, sky);
  vec3 normal = normalize(vec3(-slope, 1.0));
  vec2 cell = rel_cells + vec2(frame.origin.xy);
  bool outside = any(lessThan(cell, vec2(-0.5))) || any(greaterThan(cell, vec2(frame.world.xy) - 0.5));
  if (outside) albedo = mix(albedo, vec3(dot(albedo, vec3(0.3333))), 0.6) * 0.85;

  float lit = max(dot(normal, frame.sun.xyz), 0.0) * relief.sun * bodyShadow(rel, smooth_normal, 0.01);
  vec3 colour = albedo * (kSunLight * lit + skyLight(smooth_normal, bounced) * sky);
  return toScreen(withFog(colour, rel));
}

vec3 groundColour(vec3 rel) {
  vec2 rel_cells = rel.xy / frame.scale.x;
  vec2 footprint = footprintAt(rel, rel_cells);
  return withHighlight(shadedGround(rel, rel_cells, footprint), rel_cells, footprint.y);
}
