// What materials look like close by, by their textures. What is plain, or snow, has but the grain of detail.glsl.
// All of it fades to the material's colour before it gets finer than a pixel.

struct GroundCover {
  vec3 albedo;
  vec2 slope;
  float wet;  // 0 .. 1: how much it mirrors
  float sky;  // shares of the sky and the sun that its own grains let through
  float sun;
  float lift;  // how high a place lies among them, 0 .. 1
};

GroundCover coverOf(vec3 albedo, vec2 slope) { return GroundCover(albedo, slope, 0.0, 1.0, 1.0, 0.0); }

/// Soil in grains and small clods: brightness about 0, and slope. All of it fades out before it gets finer than a
/// pixel.
vec3 clodsAt(ivec2 at, float footprint_m, uint seed) {
  vec3 sum = vec3(0.0);
  const int bits[5] = int[5](13, 12, 11, 10, 8);
  const float bright[5] = float[5](0.10, 0.12, 0.14, 0.14, 0.16);
  const float high_m[5] = float[5](0.050, 0.034, 0.022, 0.012, 0.0020);
  for (int i = 0; i < 5; ++i) {
    float shown = shownDetail(footprint_m, bitsSize(bits[i]));
    if (shown <= 0.0) break;
    vec3 n = placeNoise(at, bits[i], seed + uint(i) * 0x632be5abu);
    // Clods are round on top, with narrow gaps between them.
    float gap = sqrt(n.x * n.x + 0.01);
    sum += shown * vec3(bright[i] * (min(gap, 0.6) * 2.6 - 0.75), n.yz * (n.x / gap) * high_m[i] * 0.9);
  }
  return sum;
}

/// Drawn out along a direction: blades of grass that lie about.
float strands(ivec2 at, ivec2 along, uint seed) { return turnedNoise(at, along, ivec2(9, 12), seed).x; }

GroundCover grassAt(ivec2 at, float footprint_m) {
  float meadow = placeNoise(at, 17, 11u).x * shownDetail(footprint_m, bitsSize(17));
  float patches = placeNoise(at, 15, 12u).x * shownDetail(footprint_m, bitsSize(15));
  float clumps = placeNoise(at, 14, 16u).x * shownDetail(footprint_m, bitsSize(14));
  vec3 tufts = placeNoise(at, 12, 13u) * shownDetail(footprint_m, bitsSize(12));
  vec3 leaves = placeNoise(at, 10, 14u) * shownDetail(footprint_m, bitsSize(10));
  float blades = 0.0;
  float shown = shownDetail(footprint_m, 0.03);
  if (shown > 0.0) {
    blades = strands(at, ivec2(1, 3), 21u);
    blades = max(blades, strands(at, ivec2(-2, 3), 22u));
    blades = max(blades, strands(at, ivec2(3, 1), 23u));
    blades = (blades - 0.30) * shown;
  }
  float dry = clamp(0.34 + 0.45 * meadow + 0.40 * patches + 0.20 * tufts.x, 0.0, 1.0);
  vec3 albedo = mix(vec3(0.085, 0.135, 0.034), vec3(0.215, 0.210, 0.085), dry);
  albedo *= 1.0 + 0.22 * clumps + 0.20 * tufts.x + 0.30 * leaves.x + 0.90 * blades;
  return coverOf(max(albedo, vec3(0.01)), 0.026 * tufts.yz + 0.012 * leaves.yz);
}

GroundCover dirtAt(ivec2 at, float footprint_m) {
  float wide = placeNoise(at, 17, 31u).x * shownDetail(footprint_m, bitsSize(17));
  float patches = placeNoise(at, 15, 32u).x * shownDetail(footprint_m, bitsSize(15));
  vec3 clods = clodsAt(at, footprint_m, 33u);
  vec3 albedo =
      mix(vec3(0.30, 0.135, 0.070), vec3(0.40, 0.215, 0.125), clamp(0.5 + 0.5 * wide + 0.45 * patches, 0.0, 1.0));
  return coverOf(albedo * (1.0 + 0.7 * clods.x), 0.45 * clods.yz);
}

/// Ripples of the wind and single grains.
GroundCover sandAt(vec3 colour, ivec2 at, float footprint_m) {
  float wide = placeNoise(at, 16, 41u).x * shownDetail(footprint_m, bitsSize(16));
  vec3 ripples = turnedNoise(at, ivec2(1, 3), ivec2(14, 11), 42u) * shownDetail(footprint_m, 0.06);
  vec3 dents = placeNoise(at, 9, 43u) * shownDetail(footprint_m, bitsSize(9));
  float grains = detailValue(at >> 4, 44u) * shownDetail(footprint_m, 0.004) +
                 placeNoise(at, 7, 45u).x * shownDetail(footprint_m, bitsSize(7));
  vec3 albedo = colour * (1.0 + 0.10 * wide + 0.04 * ripples.x + 0.05 * dents.x + 0.16 * grains);
  return coverOf(albedo, 0.0030 * ripples.yz + 0.0016 * dents.yz);
}

/// Smooth lumps, wet in patches.
GroundCover mudAt(vec3 colour, float wet, ivec2 at, float footprint_m) {
  float wide = placeNoise(at, 15, 51u).x * shownDetail(footprint_m, bitsSize(15));
  float patches = placeNoise(at, 13, 52u).x * shownDetail(footprint_m, bitsSize(13));
  vec3 clods = clodsAt(at, footprint_m, 53u);
  vec3 lumps = placeNoise(at, 10, 54u) * shownDetail(footprint_m, bitsSize(10));
  float damp = clamp(0.5 + 0.8 * wide + 0.6 * patches, 0.0, 1.0);
  GroundCover cover = coverOf(colour * (1.12 - 0.24 * damp) * (1.0 + 0.5 * clods.x + 0.08 * lumps.x),
                              (0.50 - 0.25 * damp) * clods.yz + 0.004 * lumps.yz);
  cover.wet = wet * (0.25 + 0.75 * damp);
  return cover;
}

/// Fine powder: even, with faint drifts.
GroundCover dustAt(vec3 colour, ivec2 at, float footprint_m) {
  float wide = placeNoise(at, 16, 61u).x * shownDetail(footprint_m, bitsSize(16));
  vec3 drifts = placeNoise(at, 13, 62u) * shownDetail(footprint_m, bitsSize(13));
  float puffs = placeNoise(at, 10, 63u).x * shownDetail(footprint_m, bitsSize(10));
  return coverOf(colour * (1.0 + 0.08 * wide + 0.05 * drifts.x + 0.03 * puffs), 0.006 * drifts.yz);
}
