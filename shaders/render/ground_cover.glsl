// What dirt and grass look like close by. Snow, sand and mud are plain: their grain is in detail.glsl.

struct GroundCover {
  vec3 albedo;
  vec2 slope;
};

/// Soil in grains and small clods: brightness about 0, and slope. All of it fades out before it gets finer than a
/// pixel.
vec3 clodsAt(ivec2 at, float footprint_m, uint seed) {
  vec3 sum = vec3(0.0);
  const int bits[4] = int[4](13, 11, 10, 8);
  const float bright[4] = float[4](0.10, 0.12, 0.14, 0.12);
  const float high_m[4] = float[4](0.020, 0.014, 0.008, 0.0012);
  for (int i = 0; i < 4; ++i) {
    float shown = shownDetail(footprint_m, bitsSize(bits[i]));
    if (shown <= 0.0) break;
    vec3 n = placeNoise(at, bits[i], seed + uint(i) * 0x632be5abu);
    // Clods are round on top, with sharp gaps between them.
    float gap = 1.0 - abs(n.x);
    sum += shown * vec3(bright[i] * (gap * 2.0 - 1.2), n.yz * (n.x > 0.0 ? -high_m[i] : high_m[i]));
  }
  return sum;
}

/// Noise whose lattice is turned and drawn out: the direction (x, y) in whole numbers, |x|, |y| <= 3. Wraps without a
/// seam.
float strands(ivec2 at, ivec2 along, int bits, int long_bits, uint seed) {
  ivec2 turned = ivec2(at.x * along.y - at.y * along.x, at.x * along.x + at.y * along.y);
  ivec2 shift = ivec2(bits, long_bits);
  ivec2 side = ivec2(1) << shift;
  return latticeNoise(turned >> shift, vec2(turned & (side - 1)) / vec2(side), seed).x;
}

GroundCover grassAt(ivec2 at, float footprint_m) {
  float meadow = placeNoise(at, 17, 11u).x * shownDetail(footprint_m, bitsSize(17));
  float patches = placeNoise(at, 15, 12u).x * shownDetail(footprint_m, bitsSize(15));
  vec3 tufts = placeNoise(at, 12, 13u) * shownDetail(footprint_m, bitsSize(12));
  vec3 leaves = placeNoise(at, 10, 14u) * shownDetail(footprint_m, bitsSize(10));
  float blades = 0.0;
  float shown = shownDetail(footprint_m, 0.03);
  if (shown > 0.0) {
    blades = strands(at, ivec2(1, 3), 9, 12, 21u);
    blades = max(blades, strands(at, ivec2(-2, 3), 9, 12, 22u));
    blades = max(blades, strands(at, ivec2(3, 1), 9, 12, 23u));
    blades = (blades - 0.30) * shown;
  }
  float dry = clamp(0.30 + 0.35 * meadow + 0.30 * patches + 0.12 * tufts.x, 0.0, 1.0);
  vec3 albedo = mix(vec3(0.060, 0.125, 0.026), vec3(0.170, 0.185, 0.060), dry);
  albedo *= 1.0 + 0.22 * tufts.x + 0.20 * leaves.x + 0.75 * blades;
  return GroundCover(max(albedo, vec3(0.01)), 0.020 * tufts.yz + 0.008 * leaves.yz);
}

GroundCover dirtAt(ivec2 at, float footprint_m) {
  float wide = placeNoise(at, 17, 31u).x * shownDetail(footprint_m, bitsSize(17));
  float patches = placeNoise(at, 15, 32u).x * shownDetail(footprint_m, bitsSize(15));
  vec3 clods = clodsAt(at, footprint_m, 33u);
  vec3 albedo =
      mix(vec3(0.30, 0.135, 0.070), vec3(0.40, 0.215, 0.125), clamp(0.5 + 0.4 * wide + 0.35 * patches, 0.0, 1.0));
  return GroundCover(albedo * (1.0 + 0.7 * clods.x), 0.6 * clods.yz);
}
