// Grain finer than a cell: integer-lattice noise that stays in place however far from the origin the camera is.

uint detailHash(ivec2 at, uint seed) {
  uint v = uint(at.x) * 0x9e3779b1u ^ (uint(at.y) * 0x85ebca77u + seed);
  v ^= v >> 16;
  v *= 0x7feb352du;
  v ^= v >> 15;
  v *= 0x846ca68bu;
  return v ^ (v >> 16);
}

float detailValue(ivec2 at, uint seed) { return float(detailHash(at, seed) >> 8) / 8388608.0 - 1.0; }

/// Value noise in -1 .. 1 and its derivatives per lattice step, at `origin` * per_cell + rel_cells * per_cell.
vec3 detailNoise(ivec2 origin, vec2 rel_cells, int per_cell, uint seed) {
  vec2 place = rel_cells * float(per_cell);
  vec2 low = floor(place);
  vec2 t = place - low;
  ivec2 at = origin * per_cell + ivec2(low);
  vec2 s = t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
  vec2 ds = 30.0 * t * t * (t * (t - 2.0) + 1.0);
  float a = detailValue(at, seed);
  float b = detailValue(at + ivec2(1, 0), seed);
  float c = detailValue(at + ivec2(0, 1), seed);
  float d = detailValue(at + ivec2(1, 1), seed);
  float k = a - b - c + d;
  return vec3(a + (b - a) * s.x + (c - a) * s.y + k * s.x * s.y, ds * (vec2(b - a, c - a) + k * s.yx));
}

/// Slope and brightness of the grain; it fades out before it gets finer than a pixel.
vec3 grainAt(vec2 rel_cells, float footprint_cells) {
  vec3 sum = vec3(0.0);
  const int per_cell[3] = int[3](1, 3, 9);
  const float slope[3] = float[3](0.020, 0.030, 0.030);
  for (int i = 0; i < 3; ++i) {
    float shown = 1.0 - smoothstep(0.25, 0.9, footprint_cells * float(per_cell[i]));
    if (shown <= 0.0) break;
    vec3 n = detailNoise(frame.origin.xy, rel_cells, per_cell[i], uint(i) * 0x632be5abu);
    sum += shown * vec3(n.yz * slope[i], n.x * 0.012);
  }
  return sum * frame.look.x;
}
