// The ground's surface as a function of the cell alone, so that patches of all levels agree where they meet.
#include "frame.h"
#include "../rules/limits.h"

layout(binding = kFineHeightUnit) uniform isampler2D fine_height;
layout(binding = kCoarseHeightUnit) uniform isampler2DArray coarse_height;

/// Height of one sample above the origin's height [m]; `at` counts from the window's first sample.
float sampleHeight(int level, ivec2 at) {
  int side = frame.levels[level].window.z;
  ivec2 texel = clamp(at, ivec2(0), ivec2(side - 1)) + frame.levels[level].texel.xy;
  texel -= ivec2(greaterThanEqual(texel, ivec2(side))) * side;
  int height = level == 0 ? texelFetch(fine_height, texel, 0).r
                          : texelFetch(coarse_height, ivec3(texel, level - 1), 0).r;
  return float(height - frame.origin.z) / float(kUnitsPerMetre);
}

/// Height of a level at a cell's centre, bilinear between its samples [m].
float levelHeight(int level, ivec2 cell) {
  ivec2 from_first = cell - frame.levels[level].window.xy - frame.levels[level].texel.z;
  if (level == 0) return sampleHeight(0, from_first);
  int shift = frame.levels[level].window.w;
  ivec2 at = from_first >> shift;
  vec2 part = vec2(from_first - (at << shift)) / float(1 << shift);
  float south = mix(sampleHeight(level, at), sampleHeight(level, at + ivec2(1, 0)), part.x);
  float north = mix(sampleHeight(level, at + ivec2(0, 1)), sampleHeight(level, at + ivec2(1, 1)), part.x);
  return mix(south, north, part.y);
}

/// How far a level has turned into the next at a place (cells from the origin cell): 0 inside, 1 on the rim, outside.
float morphAt(int level, vec2 rel_cells) {
  if (level == kLevelCount - 1) return 0.0;
  LevelWindow w = frame.levels[level];
  vec2 at = (rel_cells + vec2(frame.origin.xy - w.window.xy)) / float(1 << w.window.w);
  vec2 inside = min(at, float(w.window.z) - at);
  float rim = min(inside.x, inside.y);
  return clamp((float(w.texel.w) - rim) / float(w.texel.w - kMorphRimSamples), 0.0, 1.0);
}

/// Height of the drawn surface at a cell's centre [m].
float surfaceHeight(int level, ivec2 cell) {
  float morph = morphAt(level, vec2(cell - frame.origin.xy));
  if (morph <= 0.0) return levelHeight(level, cell);
  if (morph >= 1.0) return levelHeight(level + 1, cell);
  return mix(levelHeight(level, cell), levelHeight(level + 1, cell), morph);
}

vec3 surfacePoint(int level, ivec2 cell) {
  return vec3(vec2(cell - frame.origin.xy) * frame.scale.x, surfaceHeight(level, cell));
}

/// Cells along a side of a level's patch.
int patchCells(int level) {
  return level == 0 ? frame.origin.w : kCoarsePatchSamples << frame.levels[level].window.w;
}
