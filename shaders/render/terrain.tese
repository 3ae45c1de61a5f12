// Terrain, tessellation evaluation: lifts each vertex to the surface, and where patches are cut finer than cells onto
// the stones that lie there. SPOOR_STONES: whether any do; SPOOR_COVER: whether there are cover maps.
#version 450 core
#include "surface.glsl"
#include "detail.glsl"
#include "map_place.glsl"
#include "cover_map.glsl"
#include "stones.glsl"

layout(quads, equal_spacing, ccw) in;
in ivec4 patch_control[];
invariant gl_Position;

/// Between cells' centres, bilinear [m].
float heightBetween(vec2 rel_cells) {
  vec2 low = floor(rel_cells);
  vec2 part = rel_cells - low;
  ivec2 cell = frame.origin.xy + ivec2(low);
  float south = mix(surfaceHeight(0, cell), surfaceHeight(0, cell + ivec2(1, 0)), part.x);
  float north = mix(surfaceHeight(0, cell + ivec2(0, 1)), surfaceHeight(0, cell + ivec2(1, 1)), part.x);
  return mix(south, north, part.y);
}

/// How far stones stand out of the ground at a place [m].
float stonesRise(vec3 rel, vec2 rel_cells) {
  float away_m = frame.eye.w > 0.0 ? 0.0 : distance(rel, frame.eye.xyz);
  float shown = frame.look.x * (1.0 - smoothstep(0.55, 0.95, away_m / frame.stones.x)) * (1.0 - morphAt(0, rel_cells));
  if (shown <= 0.0) return 0.0;
  Cover cover = coverAt(rel_cells, 0.0, vec2(0.0));
  MapPlace place = mapPlace(rel.xy);
  float rise_m = 0.0;
  for (int i = 0; i < cover.count; ++i) {
    MaterialLook look = looks[cover.material[i]];
    if (look.texture_kind.y == 0 || look.tint.w <= 0.0) continue;
    bool broken = look.texture_kind.x == kTextureGravel;
    rise_m += cover.share[i] * look.tint.w * stonesAt(place.at, look.texture_kind.y, broken).height;
  }
  return rise_m * shown * (1.0 - 0.8 * cover.snow);
}

void main() {
  ivec4 piece = patch_control[0];
  vec3 rel;
  if (SPOOR_STONES == 0 || (piece.w & kStonePatch) == 0) {
    ivec2 cell = piece.xy + ivec2(round(gl_TessCoord.xy * float(patchCells(piece.z))));
    rel = surfacePoint(piece.z, cell);
  } else {
    // Whole parts of a cell, so that both patches at an edge find the same place.
    vec2 parts = round(gl_TessCoord.xy * float(kStonePatchSamples * kStoneCuts));
    vec2 rel_cells = vec2(piece.xy - frame.origin.xy) + parts / float(kStoneCuts);
    rel = vec3(rel_cells * frame.scale.x, heightBetween(rel_cells));
    rel.z += stonesRise(rel, rel_cells);
  }
  gl_Position = frame.clip_from_rel * vec4(rel, 1.0);
}
