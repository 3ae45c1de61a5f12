// Slopes and light of the ground at any place, from the relief maps that relief.comp made: a function of the place and
// of the pixel's footprint, whichever patch drew it, so that shading has no seams.
#include "surface.glsl"

layout(binding = kFineReliefUnit) uniform sampler2D fine_relief;
layout(binding = kCoarseReliefUnit) uniform sampler2DArray coarse_relief;

struct Relief {
  vec2 gradient;   // dz/dx, dz/dy
  float sky;       // share of the sky that is seen
  float sun;       // share of the sun that is seen
};

vec4 reliefSample(int level, vec2 rel_cells) {
  LevelWindow w = frame.levels[level];
  vec2 from_first = rel_cells + vec2(frame.origin.xy - w.window.xy - w.texel.z);
  vec2 place = (from_first / float(1 << w.window.w) + vec2(w.texel.xy) + 0.5) / float(w.window.z);
  if (level == 0) return textureLod(fine_relief, place, 0.0);
  return textureLod(coarse_relief, vec3(place, float(level - 1)), 0.0);
}

/// Which level shows a place: at least what its footprint [cells a pixel] asks for, and what the windows cover.
float reliefLevel(vec2 rel_cells, float footprint_cells) {
  float covered = 0.0;
  for (int level = 0; level < kLevelCount - 1; ++level) {
    float morph = morphAt(level, rel_cells);
    if (morph <= 0.0) break;
    covered = float(level) + morph;
    if (morph < 1.0) break;
  }
  float asked = log2(max(footprint_cells, 1.0)) / float(kLevelShift);
  return clamp(max(covered, asked), 0.0, float(kLevelCount - 1));
}

/// Slope without what is finer than a sample of level 1: how the ground as a whole faces the eye.
vec2 coarseGradient(vec2 rel_cells) {
  float level = max(reliefLevel(rel_cells, 1.0), 1.0);
  int lower = int(level);
  vec2 gradient = reliefSample(lower, rel_cells).xy;
  return level == float(lower) ? gradient : mix(gradient, reliefSample(lower + 1, rel_cells).xy, level - float(lower));
}

Relief reliefAt(vec2 rel_cells, float footprint_cells) {
  float level = reliefLevel(rel_cells, footprint_cells);
  int lower = int(level);
  float part = level - float(lower);
  vec4 r = reliefSample(lower, rel_cells);
  float sun = mix(r.w, 1.0, part);
  for (int next = lower + 1; next < min(lower + 4, kLevelCount); ++next) {
    vec4 coarse = reliefSample(next, rel_cells);
    if (next == lower + 1) r = mix(r, coarse, part);
    sun *= coarse.w;
  }
  return Relief(r.xy, r.z, sun);
}
