// What lies at a place, from the cover maps: shares of materials, and how much snow hides them. Materials blend over
// about a cell, along borders that wander a little, so that no cell shows by itself.
// Needs surface.glsl; SPOOR_COVER: 0 where there are no such maps.
layout(binding = kFineCoverUnit) uniform usampler2D fine_cover;  // a sample: material, snow 0 .. 255
layout(binding = kCoarseCoverUnit) uniform usampler2DArray coarse_cover;
layout(std140, binding = kLooksBinding) uniform LooksBlock { MaterialLook looks[kLooksLimit]; };

const int kCoverMost = 4;  // materials that meet at a place and count

struct Cover {
  int count;
  int material[kCoverMost];
  float share[kCoverMost];  // sum 1
  float snow;
};

uvec2 coverSample(int level, ivec2 from_first) {
  int side = frame.levels[level].window.z;
  ivec2 texel = clamp(from_first, ivec2(0), ivec2(side - 1)) + frame.levels[level].texel.xy;
  texel -= ivec2(greaterThanEqual(texel, ivec2(side))) * side;
  return level == 0 ? texelFetch(fine_cover, texel, 0).rg : texelFetch(coarse_cover, ivec3(texel, level - 1), 0).rg;
}

void addShare(inout Cover cover, int material, float share) {
  int slot = 0;
  while (slot < cover.count && cover.material[slot] != material) ++slot;
  if (slot == kCoverMost) return;
  if (slot == cover.count) {
    cover.material[slot] = material;
    cover.share[slot] = 0.0;
    ++cover.count;
  }
  cover.share[slot] += share;
}

/// Adds one level's samples about a place, weighed by a quadratic B-spline: its borders have no corners of cells.
void addLevel(inout Cover cover, int level, vec2 rel_cells, float share) {
  LevelWindow w = frame.levels[level];
  vec2 at = (rel_cells + vec2(frame.origin.xy - w.window.xy - w.texel.z)) / float(1 << w.window.w);
  ivec2 middle = ivec2(floor(at + 0.5));
  vec2 t = at - vec2(middle);
  vec2 weights[3] = vec2[3](0.5 * (0.5 - t) * (0.5 - t), 0.75 - t * t, 0.5 * (0.5 + t) * (0.5 + t));
  for (int i = 0; i < 9; ++i) {
    ivec2 which = ivec2(i % 3, i / 3);
    uvec2 texel = coverSample(level, middle + which - 1);
    float weight = share * weights[which.x].x * weights[which.y].y;
    cover.snow += weight * float(texel.y) / 255.0;
    addShare(cover, int(texel.x), weight);
  }
}

Cover oneMaterial() {
  Cover cover;
  cover.count = 1;
  cover.material[0] = 0;
  cover.share[0] = 1.0;
  cover.snow = 0.0;
  return cover;
}

/// @param level  which of the maps, as reliefLevel tells it
/// @param aside  how far borders wander here, in samples of the level
Cover coverAt(vec2 rel_cells, float level, vec2 aside) {
  Cover cover = oneMaterial();
  if (SPOOR_COVER == 0) return cover;
  cover.count = 0;
  int lower = int(level);
  float part = level - float(lower);
  int last = part > 0.0 ? lower + 1 : lower;
  for (int i = lower; i <= last; ++i)
    addLevel(cover, i, rel_cells + (i == lower ? aside * float(1 << frame.levels[i].window.w) : vec2(0.0)),
             i == lower ? 1.0 - part : part);
  if (frame.world.z == 0) {
    float snow = cover.snow;
    cover = oneMaterial();
    cover.snow = snow;
  }
  return cover;
}
