// Pebbles and gravel: rounded or broken stones that lie on the ground, as a function of the map's place. The
// tessellation evaluation lifts vertices by it, the fragment stage shades and colours by it.
// Needs detail.glsl, map_place.glsl.

struct Stones {
  float height;  // of the ground there, 0: between stones, to 1
  vec2 slope;    // of it, per lattice step
  uint stone;    // which stone: a hash; 0: none
};

/// The stone of one lattice cell at `from` its corner, where it stands out over what is there already.
void addStone(inout Stones stones, vec2 from, uint hash, bool broken, float tall) {
  vec2 middle = 0.5 + 0.36 * (vec2(hash & 255u, (hash >> 8) & 255u) / 127.5 - 1.0);
  float turn = float((hash >> 16) & 63u) / 64.0 * 6.2831853;
  float large = 0.40 + 0.24 * float((hash >> 22) & 31u) / 31.0;
  float round_ = 0.66 + 0.32 * float(hash >> 27) / 31.0;
  vec2 along = vec2(cos(turn), sin(turn));
  vec2 away = from - middle;
  vec2 own = vec2(dot(away, along) / large, dot(away, vec2(-along.y, along.x)) / (large * round_));
  float r2;
  vec2 rise;  // gradient of r2 in the stone's own axes
  if (broken) {
    // The largest of three planes' distances, softened: facets.
    vec2 a = abs(own);
    float edge = max(max(a.x, a.y), 0.74 * (a.x + a.y));
    r2 = edge * edge;
    vec2 facet = edge == a.x ? vec2(1.0, 0.0) : (edge == a.y ? vec2(0.0, 1.0) : vec2(0.74));
    rise = 2.0 * edge * facet * sign(own);
  } else {
    r2 = dot(own, own);
    rise = 2.0 * own;
  }
  if (r2 >= 1.0) return;
  float peak = tall * (0.55 + 0.45 * float((hash >> 12) & 15u) / 15.0);
  // Flat on top, round at the sides; what is broken slants evenly.
  float profile = broken ? min(1.6 * (1.0 - sqrt(r2)), 1.0 - 0.12 * sqrt(r2)) : 1.0 - r2 * r2 * (1.5 - 0.5 * r2);
  float height = peak * profile;
  if (height <= stones.height) return;
  float fall = broken ? (1.6 * (1.0 - sqrt(r2)) < 1.0 - 0.12 * sqrt(r2) ? -0.8 : -0.06) / max(sqrt(r2), 0.05)
                      : -r2 * (3.0 - 1.5 * r2);
  vec2 down = peak * fall * rise / vec2(large, large * round_);
  stones = Stones(height, down.x * along + down.y * vec2(-along.y, along.x), hash | 1u);
}

void addStones(inout Stones stones, ivec2 at, int side, uint seed, bool broken, float tall) {
  ivec2 cell = ivec2(floorDiv(at.x, side), floorDiv(at.y, side));
  vec2 part = (vec2(at - cell * side) + 0.5) / float(side);
  for (int y = -1; y <= 1; ++y)
    for (int x = -1; x <= 1; ++x)
      addStone(stones, part - vec2(x, y), detailHash(cell + ivec2(x, y), seed), broken, tall);
}

/// @param side  of a stone, 0.1 mm: those of the large ones; small ones lie between them
Stones stonesAt(ivec2 at, int side, bool broken) {
  Stones highest = Stones(0.0, vec2(0.0), 0u);
  int layers = side > 1 ? 2 : 1;
  for (int layer = 0; layer < layers; ++layer) {
    Stones stones = Stones(0.0, vec2(0.0), 0u);
    ivec2 moved = layer == 0 ? at : at + ivec2(side / 5, side / 7);
    addStones(stones, moved, side >> layer, 0x51ab3f07u + uint(layer) * 0xdebe4e0cu, broken, layer == 0 ? 1.0 : 0.55);
    stones.slope *= float(1 + layer);
    if (stones.height > highest.height) highest = stones;
  }
  return highest;
}
