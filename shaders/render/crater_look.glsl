// What explosions leave on the ground to be seen: burnt earth in and about the cavity, soil laid bare there and thrown
// out in rays. The craters of a place come from the spatial hash. All of it ends before R3.
#define CRATER_BINDING kCraterBinding
#include "../sim/crater_table.glsl"

const int kCraterLooks = 4096;  // entries of a bucket that a pixel looks at, the newest

struct CraterLook {
  vec3 albedo;  // times the share that it covers
  float cover;  // share of the ground that it hides
  float bare;   // share of the ground that is loose soil
  vec2 slope;   // of what is finer than the heights
};

/// An octave of the radial noise's kind, between its own and the grain: 2^fold times 24 spokes. -1 .. 1.
float fineOctave(uint seed, int fold, uint turn, float radius) {
  uint around = mulHigh(turn << uint(fold), 24u << kNoiseBits);
  uint out_q27 = uint(clamp(radius, 0.0, 1.9999) * float(16u << kNoiseBits));
  return float(noiseOctave(seed, 24, around, out_q27)) / float(kNoiseOne);
}

/// Slope of the octaves above those that the heights hold, dz/dx and dz/dy.
vec2 fineSlope(CraterShape shape, vec2 away_m, uint turn, float footprint_m) {
  float crest_m = float(shape.crest) / float(kUnitsPerMetre);
  float away = max(length(away_m), 1.0e-3);
  vec2 ahead = away_m / away;
  float radius = away / crest_m;
  float in_m = clamp((away - crest_m) * float(kUnitsPerMetre) / float(max(shape.outer - shape.crest, 1)), 0.0, 1.0);
  float share = radius < 1.0 ? radius : sqrt(1.0 - in_m * in_m);
  share = share * share * (3.0 - 2.0 * share);
  float high_m = float(shape.amplitude) / (256.0 * float(kUnitsPerMetre)) * share;
  vec2 slope = vec2(0.0);  // outwards, and around
  for (int fold = 1; fold <= 2; ++fold) {
    float arc_m = 6.2831853 * away / float(24 << fold);
    float shown = shownDetail(footprint_m, min(arc_m, crest_m / 16.0));
    if (shown <= 0.0) break;
    uint seed = shape.seed + uint(fold) * 0x51ed270bu;
    const float part = 0.125;  // of a lattice step
    float here = fineOctave(seed, fold, turn, radius);
    float further = fineOctave(seed, fold, turn, radius + part / 16.0);
    float around = fineOctave(seed, fold, turn + (uint(part * 4294967296.0 / 24.0) >> uint(fold)), radius);
    slope += shown * high_m / float(2 << fold) *
             vec2((further - here) / (part * crest_m / 16.0), (around - here) / (part * arc_m));
  }
  return (slope.x * ahead + slope.y * vec2(-ahead.y, ahead.x)) * 0.7 * smoothstep(0.10, 0.55, radius);
}

/// How rough borders are about the clods of a place: -1 .. 1, and how much of it can be seen.
vec2 crumbsAt(ivec2 at, float footprint_m) {
  const int bits[4] = int[4](14, 12, 11, 9);
  const float strength[4] = float[4](0.30, 0.30, 0.25, 0.15);
  vec2 sum = vec2(0.0);
  for (int i = 0; i < 4; ++i) {
    float shown = strength[i] * shownDetail(footprint_m, bitsSize(bits[i]));
    if (shown <= 0.0) break;
    sum += shown * vec2(placeNoise(at, bits[i], 0x2545f491u + uint(i)).x, 1.0);
  }
  return sum;
}

/// One crater at a place: x bare soil, y burnt, z soot on what lies there; 0 .. 1.
vec3 craterMarks(CraterShape shape, float away, uint turn, vec2 crumbs, float footprint_m) {
  float reach = away / float(shape.outer);
  float radius = min(away / float(shape.crest), 1.9999);
  float noise = float(craterNoise(shape.seed, turn, uint(radius * 1073741824.0))) / float(kNoiseOne);
  uint around = mulHigh(turn, 24u << kNoiseBits);
  uint out_q27 = uint(radius * float(kNoiseOne));
  float ray =
      0.5 + 0.9 * float(noiseOctave(shape.seed + 0x1b873593u, 24, around, out_q27 + (1u << 26))) / float(kNoiseOne);
  float lobe = 0.5 + 1.1 * float(noiseOctave(shape.seed + 0x68e31da4u, 7, mulHigh(turn, 7u << kNoiseBits), 1u << 26)) /
                         float(kNoiseOne);

  // From the crest on rays of soil, the longest of them to where the crater ends.
  float rim = min(0.92 * float(shape.crest) / float(shape.outer), 0.80);
  float beyond = (reach - rim) / (1.0 - rim);
  float thrown = clamp(0.45 + 0.75 * ray + 0.40 * lobe, 0.45, 1.80);
  float dense = 1.25 - 1.1 * max(beyond, 0.0) / thrown + 0.30 * noise;
  float soft = mix(0.40, 0.10, crumbs.y);
  float bare = smoothstep(0.25 - soft, 0.25 + soft, dense + 0.60 * crumbs.x);

  float burnt = 1.0 - smoothstep(0.50, 1.06, radius + 0.40 * noise + 0.20 * crumbs.x - 0.25 * (lobe - 0.5));
  float soot = (1.0 - smoothstep(0.45, 1.0, beyond / thrown + 0.35 * crumbs.x)) * smoothstep(0.40, 0.95, ray) * 0.70;
  float end = 1.0 - smoothstep(0.955, 1.0, reach + 0.03 * crumbs.x);
  float seen = 1.0 - smoothstep(0.5, 2.0, footprint_m * float(kUnitsPerMetre) / float(shape.outer));
  return vec3(bare, 0.96 * burnt, soot) * end * seen;
}

/// All craters at a place of the map. The newest lies over the one before it; two that show fully are as many as count,
/// those that only fade in count for as much as they show, so that no border is hard.
/// @param footprint_m  the pixel's, the shorter and the longer side
/// @param bare_soil    what lies under the ground's cover
CraterLook craterLookAt(ivec2 at, vec2 footprint_m, vec3 bare_soil) {
  CraterLook look = CraterLook(vec3(0.0), 0.0, 0.0, vec2(0.0));
  CraterRange range = cratersAt(at.x, at.y);
  float counted = 0.0;
  vec2 crumbs = vec2(0.0);
  vec3 soil = vec3(0.0);
  float middle_m = 0.6 * sqrt(footprint_m.x * footprint_m.y);
  bool first = true;
  int last = max(range.first, range.end - kCraterLooks);
  for (int i = range.end - 1; i >= last && counted < 2.0 && look.cover < 0.998; --i) {
    if (crater_entries[i].tag != range.tag) continue;
    int record = crater_entries[i].record;
    ivec2 from = at - ivec2(crater_shapes[record].x, crater_shapes[record].y);
    float away = length(vec2(from));
    float outer = float(crater_shapes[record].outer);
    if (away >= outer || middle_m * float(kUnitsPerMetre) >= 2.0 * outer) continue;  // or too small to be seen
    if (first) {
      first = false;
      crumbs = crumbsAt(at, footprint_m.y);
      soil = clodsAt(at, footprint_m.y, 0x7f4a7c15u);
    }
    CraterShape shape = crater_shapes[record];
    uint turn = turnOf(from.x, from.y);
    vec3 marks = craterMarks(shape, away, turn, crumbs, middle_m);
    float cover = 1.0 - (1.0 - marks.x) * (1.0 - marks.y) * (1.0 - marks.z);
    float open = (1.0 - look.cover) * min(2.0 - counted, 1.0);
    look.slope += open * fineSlope(shape, vec2(from) / float(kUnitsPerMetre), turn, middle_m);
    if (cover <= 0.0) continue;
    float pale = placeNoise(at, 13, 0x3c6ef372u).x * shownDetail(footprint_m.y, bitsSize(13));
    vec3 dirt = bare_soil * max(1.0 + 1.0 * soil.x + 0.25 * pale + 0.30 * crumbs.x, 0.2);
    vec3 char_black = vec3(0.036, 0.031, 0.028) * (1.0 + 1.2 * soil.x);
    float black = 1.0 - (1.0 - marks.y) * (1.0 - marks.z);
    look.albedo += open * (black * char_black + (1.0 - black) * marks.x * dirt);
    look.bare += open * marks.x;
    look.cover += open * cover;
    counted += cover;
  }
  look.slope += look.bare * soil.yz;
  return look;
}
