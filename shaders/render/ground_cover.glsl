// What dirt and grass look like close by. Snow, sand and mud are plain: their grain is in detail.glsl.

struct GroundCover {
  vec3 albedo;
  vec2 slope;
};

/// Soil in grains and small clods: brightness about 0, and slope. All of it fades out before it gets finer than a pixel.
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
  return GroundCover(max(albedo, vec3(0.01)), 0.026 * tufts.yz + 0.012 * leaves.yz);
}

GroundCover dirtAt(ivec2 at, float footprint_m) {
  float wide = placeNoise(at, 17, 31u).x * shownDetail(footprint_m, bitsSize(17));
  float patches = placeNoise(at, 15, 32u).x * shownDetail(footprint_m, bitsSize(15));
  vec3 clods = clodsAt(at, footprint_m, 33u);
  vec3 albedo =
      mix(vec3(0.30, 0.135, 0.070), vec3(0.40, 0.215, 0.125), clamp(0.5 + 0.5 * wide + 0.45 * patches, 0.0, 1.0));
  return GroundCover(albedo * (1.0 + 0.7 * clods.x), 0.45 * clods.yz);
}
