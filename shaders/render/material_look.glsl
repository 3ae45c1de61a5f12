// What a place looks like by its material: stones, and the choice among all textures.
// Needs stones.glsl, ground_cover.glsl; SPOOR_TEXTURES: a bit for each texture that a material has.

/// How much a stone catches the sun that lies that way: shadows of stones on stones.
float stonesSun(ivec2 at, int side, bool broken, float height, float high_m) {
  float away_m = 0.42 * float(side) / float(kUnitsPerMetre);
  vec2 ahead = normalize(frame.sun.xy) * 0.42 * float(side);
  float over = stonesAt(at + ivec2(ahead), side, broken).height - height - away_m * frame.sun.w / max(high_m, 1.0e-4);
  return 1.0 - 0.8 * smoothstep(-0.05, 0.25, over);
}

/// Stones of the material's colour, each a little another, with its soil between them.
GroundCover stonesLook(MaterialLook look, MapPlace place, vec2 footprint_m) {
  ivec2 at = place.at;
  int side = look.texture_kind.y;
  float side_m = float(side) / float(kUnitsPerMetre);
  bool broken = look.texture_kind.x == kTextureGravel;
  // Each is round: blurring by the longer side of the footprint would hide them too near.
  float middle_m = sqrt(footprint_m.x * footprint_m.y);
  float patches = 0.0;
  for (int bits = 11; bits <= 15; ++bits)
    patches +=
        (bits == 11 ? 0.22 : 0.10) * placeNoise(at, bits, 60u + uint(bits)).x * shownDetail(middle_m, bitsSize(bits));
  GroundCover cover = coverOf(look.albedo.rgb * (1.0 + patches), vec2(0.0));
  float shown = side == 0 ? 0.0 : shownDetail(middle_m, 0.6 * side_m);
  // From afar the shadows between them darken what is seen.
  const float kSeenFromAfar = 0.80;
  cover.sun = side == 0 ? 1.0 : kSeenFromAfar;
  cover.sky = cover.sun;
  if (shown <= 0.0) return cover;
  Stones stones = stonesAt(at, side, broken);
  uint hash = stones.stone * 0x9e3779b1u;
  float bright = float((hash >> 24) & 255u) / 255.0, warm = float((hash >> 16) & 255u) / 127.5 - 1.0;
  bright = broken ? mix(0.70, 1.35, bright) : mix(0.60, 1.50, bright * bright * 0.6 + 0.4 * bright);
  float veins = placeNoise(at + ivec2(int(hash & 4095u)), 7, 72u).x * shownDetail(footprint_m.y, bitsSize(7));
  vec3 stone = cover.albedo * bright * (1.0 + 0.08 * warm * vec3(1.0, 0.1, -1.1)) * (1.0 + 0.14 * veins);
  vec3 between = mix(look.soil.rgb, look.albedo.rgb, 0.2) * 0.7;
  vec3 albedo = stones.stone == 0u ? between : stone;
  cover.albedo = mix(cover.albedo, albedo, shown);
  cover.slope = stones.slope * (look.tint.w / side_m) * shown;
  cover.lift = stones.height * shown;
  cover.sky = mix(cover.sky, 1.0 - 0.65 * (1.0 - smoothstep(0.0, 0.75, stones.height)), shown);
  vec2 mirrored = place.facing;  // the sun does not turn with the ground beyond the border: no shadows there
  if (look.tint.w > 0.0 && all(greaterThan(mirrored, vec2(0.0))))
    cover.sun = mix(cover.sun, stonesSun(at, side, broken, stones.height, look.tint.w), shown);
  return cover;
}

/// Is a texture among those of the looks? Known when the shader is compiled: some drivers compute all branches.
#define HAS_TEXTURE(kind) ((SPOOR_TEXTURES & (1 << (kind))) != 0)

/// One material's look at a place.
/// @param plain  what it is without its texture: its colour and grain
GroundCover materialAt(MaterialLook look, vec3 plain, MapPlace place, vec2 footprint_m) {
  int kind = look.texture_kind.x;
  GroundCover cover = coverOf(plain, vec2(0.0));
  if (HAS_TEXTURE(kTextureSand) && kind == kTextureSand) cover = sandAt(look.albedo.rgb, place.at, footprint_m.y);
  if (HAS_TEXTURE(kTextureMud) && kind == kTextureMud)
    cover = mudAt(look.albedo.rgb, look.albedo.w, place.at, footprint_m.y);
  if ((HAS_TEXTURE(kTexturePebbles) && kind == kTexturePebbles) ||
      (HAS_TEXTURE(kTextureGravel) && kind == kTextureGravel))
    cover = stonesLook(look, place, footprint_m);
  if (HAS_TEXTURE(kTextureDust) && kind == kTextureDust) cover = dustAt(look.albedo.rgb, place.at, footprint_m.y);
  if (HAS_TEXTURE(kTextureDirt) && kind == kTextureDirt) {
    cover = dirtAt(place.at, footprint_m.y);
    cover.albedo *= look.tint.rgb;
  }
  if (HAS_TEXTURE(kTextureGrass) && kind == kTextureGrass) {
    cover = grassAt(place.at, footprint_m.y);
    cover.albedo *= look.tint.rgb;
  }
  return cover;
}
