// Places of the map in whole units of 0.1 mm, which do not jitter however far from the map's corner the camera is, and
// noise that is bound to them.

struct MapPlace {
  ivec2 at;     // from the map's corner, 0.1 mm
  vec2 facing;  // -1 along an axis where the ground beyond the border mirrors the map
};

MapPlace mapPlace(vec2 rel) {
  int cell = frame.place.x;
  ivec2 size = frame.world.xy * cell;
  ivec2 place = frame.origin.xy * cell + cell / 2 + ivec2(floor(rel * float(kUnitsPerMetre)));
  MapPlace result = MapPlace(place, vec2(1.0));
  for (int axis = 0; axis < 2; ++axis) {
    if (place[axis] >= 0 && place[axis] < size[axis]) continue;
    int image = floorDiv(place[axis], size[axis]);
    int rest = place[axis] - image * size[axis];
    bool mirrored = (image & 1) != 0;
    result.at[axis] = mirrored ? size[axis] - 1 - rest : rest;
    if (mirrored) result.facing[axis] = -1.0;
  }
  return result;
}

vec2 latticeGradient(ivec2 at, uint seed) {
  uint hash = detailHash(at, seed);
  return vec2(hash & 0xffffu, hash >> 16) / 32768.0 - 1.0;
}

/// Gradient noise (Perlin 1985), about -1 .. 1, and its derivatives per lattice step, at `t` of the way from a lattice
/// point to the next.
/// @param mask  of the lattice's coordinates, which wrap
vec3 gradientNoise(ivec2 at, vec2 t, int mask, uint seed) {
  vec2 s = t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
  vec2 ds = 30.0 * t * t * (t * (t - 2.0) + 1.0);
  vec2 a = latticeGradient(at & mask, seed);
  vec2 b = latticeGradient((at + ivec2(1, 0)) & mask, seed);
  vec2 c = latticeGradient((at + ivec2(0, 1)) & mask, seed);
  vec2 d = latticeGradient((at + 1) & mask, seed);
  float va = dot(a, t), vb = dot(b, t - vec2(1.0, 0.0)), vc = dot(c, t - vec2(0.0, 1.0)), vd = dot(d, t - 1.0);
  float k = va - vb - vc + vd;
  float value = va + s.x * (vb - va) + s.y * (vc - va) + s.x * s.y * k;
  vec2 slope = a + s.x * (b - a) + s.y * (c - a) + s.x * s.y * (a - b - c + d) + ds * (s.yx * k + vec2(vb, vc) - va);
  return 1.4 * vec3(value, slope);
}

/// Gradient noise on a lattice that is turned so that its y axis lies along a direction in small whole numbers, with
/// steps of 2^bits units by the direction's length. Derivatives per metre. Wraps without a seam.
vec3 turnedNoise(ivec2 at, ivec2 along, ivec2 bits, uint seed) {
  ivec2 turned = ivec2(at.x * along.y - at.y * along.x, at.x * along.x + at.y * along.y);
  ivec2 side = ivec2(1) << bits;
  vec3 noise = gradientNoise(turned >> bits, vec2(turned & (side - 1)) / vec2(side), 0x7fffffff >> max(bits.x, bits.y), seed);
  vec2 slope = noise.yz / vec2(side) * float(kUnitsPerMetre);
  return vec3(noise.x, slope.x * vec2(along.y, -along.x) + slope.y * vec2(along));
}

/// Noise with lattice steps of about 2^bits units; its seed turns the lattice, so that octaves do not line up.
vec3 placeNoise(ivec2 at, int bits, uint seed) {
  return turnedNoise(at, (seed & 1u) == 0u ? ivec2(1, 2) : ivec2(-2, 1), ivec2(bits + 1), seed);
}

/// How much of detail of a size can be seen: none where it is finer than a pixel.
float shownDetail(float footprint_m, float size_m) { return 1.0 - smoothstep(0.25, 0.9, footprint_m / size_m); }
float bitsSize(int bits) { return float(1 << bits) / float(kUnitsPerMetre); }
