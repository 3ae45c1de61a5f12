// How the ground looks at a place: its materials, craters in it and snow on it, under a low sun.
// SPOOR_TEXTURES: a bit for each texture that a material has; SPOOR_COVER: whether there are cover maps.
#include "relief.glsl"
#include "light.glsl"
#include "body_shadow.glsl"
#include "detail.glsl"
#include "map_place.glsl"
#include "cover_map.glsl"
#include "stones.glsl"
#include "ground_cover.glsl"
#include "material_look.glsl"
#include "crater_look.glsl"
#include "highlight.glsl"

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

const vec3 kSnowAlbedo = vec3(0.86, 0.88, 0.91);

/// What light meets at a place.
struct GroundSurface {
  vec3 albedo;
  vec3 bounced;  // the albedo of the ground about the place
  vec2 slope;
  float sky;  // shares of the sky and the sun that it sees
  float sun;
  float wet;
};

/// How far the borders of materials wander at a place, in cells: by clods and by grains.
vec2 borderWander(ivec2 at, float footprint_cells) {
  float shown = 1.0 - smoothstep(0.3, 1.0, footprint_cells);
  if (SPOOR_COVER == 0 || frame.world.z == 0 || shown <= 0.0) return vec2(0.0);
  int bits = findMSB(max(frame.place.x, 2));
  vec2 wide = vec2(placeNoise(at, bits + 1, 81u).x, placeNoise(at, bits + 1, 82u).x);
  vec2 fine = vec2(placeNoise(at, max(bits - 2, 4), 83u).x, placeNoise(at, max(bits - 2, 4), 84u).x);
  return shown * (0.6 * wide + 0.25 * fine);
}

/// Adds the materials of a place to it. Returns what lies under them.
vec3 addMaterials(Cover cover, MapPlace place, vec2 footprint_m, float grain, inout GroundSurface surface) {
  GroundCover mixed = GroundCover(vec3(0.0), vec2(0.0), 0.0, 0.0, 0.0, 0.0);
  vec3 soil = vec3(0.0);
  for (int i = 0; i < cover.count; ++i) {
    MaterialLook look = looks[cover.material[i]];
    float share = cover.share[i];
    GroundCover one = materialAt(look, look.albedo.rgb * (1.0 + grain), place, footprint_m);
    mixed.albedo += share * one.albedo;
    mixed.slope += share * one.slope;
    mixed.wet += share * one.wet;
    mixed.sky += share * one.sky;
    mixed.sun += share * one.sun;
    mixed.lift += share * one.lift;
    soil += share * look.soil.rgb;
  }
  float hidden = 0.0;
  if (cover.snow > 0.0) hidden = smoothstep(0.6 * mixed.lift, 0.6 * mixed.lift + 0.4, cover.snow);
  surface.albedo = mix(mixed.albedo, kSnowAlbedo * (1.0 + grain), hidden);
  surface.bounced = mix(surface.bounced, kSnowAlbedo, hidden);
  surface.slope = mixed.slope * (1.0 - 0.85 * hidden);
  surface.wet = mixed.wet * (1.0 - hidden);
  surface.sky = mix(mixed.sky, 1.0, hidden);
  surface.sun = mix(mixed.sun, 1.0, hidden);
  return soil;
}

/// What the map's places look like close by, and the craters in them.
GroundSurface surfaceAt(vec3 rel, vec2 rel_cells, vec2 footprint_cells, Relief relief, float level) {
  vec3 grain = grainAt(rel_cells, footprint_cells.y);
  MapPlace place = mapPlace(rel.xy);
  vec2 footprint_m = footprint_cells * frame.scale.x;
  Cover cover = coverAt(rel_cells, level, place.facing * borderWander(place.at, footprint_cells.y));
  GroundSurface surface = GroundSurface(vec3(0.0), vec3(0.0), vec2(0.0), 1.0, 1.0, 0.0);
  for (int i = 0; i < cover.count; ++i) surface.bounced += cover.share[i] * looks[cover.material[i]].albedo.rgb;
  vec3 soil = addMaterials(cover, place, footprint_m, grain.z, surface);
  vec2 fine = surface.slope;
  surface.sky *= relief.sky * relief.sky;
  surface.sun *= relief.sun;
  if (crater_head.mask >= 0) {
    CraterLook look = craterLookAt(place.at, footprint_m, soil);
    surface.albedo = surface.albedo * (1.0 - look.cover) + look.albedo;
    surface.bounced = surface.bounced * (1.0 - look.cover) + look.albedo;
    // A cavity's walls light each other.
    surface.sky = mix(surface.sky, 0.30 + 0.70 * sqrt(surface.sky), look.cover);
    surface.wet *= 1.0 - look.cover;
    fine = fine * (1.0 - look.bare) + look.slope;
  }
  surface.slope = relief.gradient + grain.xy + place.facing * frame.look.x * fine;
  return surface;
}

/// What wet ground mirrors of sun and sky.
vec3 mirroredLight(GroundSurface surface, vec3 normal, vec3 to_eye, float lit) {
  float fresnel = 0.03 + 0.45 * pow(1.0 - max(dot(normal, to_eye), 0.0), 5.0);  // rough: it never mirrors all
  float shine = pow(max(dot(normal, normalize(to_eye + frame.sun.xyz)), 0.0), 60.0);
  return surface.wet *
         (0.5 * fresnel * skyColour(reflect(-to_eye, normal)) * surface.sky + 0.16 * shine * lit * kSunLight);
}

/// Colour that the ground sends to the eye, with fog; kShadeNormals: its normal.
vec3 shadedGround(vec3 rel, vec2 rel_cells, vec2 footprint) {
  // Between the shorter and the longer side: blurring by the longer would wipe out tracks at grazing angles.
  float middle = 0.6 * sqrt(footprint.x * footprint.y);
  Relief relief = reliefAt(rel_cells, middle);
  vec3 smooth_normal = normalize(vec3(-relief.gradient, 1.0));
  if (frame.world.w == kShadeNormals) return smooth_normal * 0.5 + 0.5;

  GroundSurface surface = surfaceAt(rel, rel_cells, footprint, relief, reliefLevel(rel_cells, middle));
  vec3 normal = normalize(vec3(-surface.slope, 1.0));
  vec3 albedo = surface.albedo;
  vec2 cell = rel_cells + vec2(frame.origin.xy);
  bool outside = any(lessThan(cell, vec2(-0.5))) || any(greaterThan(cell, vec2(frame.world.xy) - 0.5));
  if (outside) albedo = mix(albedo, vec3(dot(albedo, vec3(0.3333))), 0.6) * 0.85;

  float lit = max(dot(normal, frame.sun.xyz), 0.0) * surface.sun * bodyShadow(rel, smooth_normal, 0.01);
  vec3 colour = albedo * (kSunLight * lit + skyLight(smooth_normal, surface.bounced) * surface.sky);
  if (HAS_TEXTURE(kTextureMud) && surface.wet > 0.0) {
    vec3 to_eye = frame.eye.w > 0.0 ? vec3(0.0, 0.0, 1.0) : normalize(frame.eye.xyz - rel);
    colour += mirroredLight(surface, normal, to_eye, lit);
  }
  return toScreen(withFog(colour, rel));
}

vec3 groundColour(vec3 rel) {
  vec2 rel_cells = rel.xy / frame.scale.x;
  vec2 footprint = footprintAt(rel, rel_cells);
  return withHighlight(shadedGround(rel, rel_cells, footprint), rel_cells, footprint.y);
}
