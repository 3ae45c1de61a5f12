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

/// Value noise and its derivatives per metre; lattice steps of 2^bits units.
vec3 placeNoise(ivec2 at, int bits, uint seed) {
  float side = float(1 << bits);
  vec3 noise = latticeNoise(at >> bits, vec2(at & ((1 << bits) - 1)) / side, seed);
  return vec3(noise.x, noise.yz * (float(kUnitsPerMetre) / side));
}

/// How much of detail of a size can be seen: none where it is finer than a pixel.
float shownDetail(float footprint_m, float size_m) { return 1.0 - smoothstep(0.25, 0.9, footprint_m / size_m); }
float bitsSize(int bits) { return float(1 << bits) / float(kUnitsPerMetre); }
