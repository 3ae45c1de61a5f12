// Tiles that are marked: tinted, with a line round what they cover together and fainter ones between them.
layout(binding = kHighlightUnit) uniform sampler2D highlight_mask;  // a texel a tile, round the origin cell's; a torus

const vec3 kHighlight = vec3(1.0, 0.36, 0.05);

bool marked(ivec2 tile) {
  ivec2 away = tile - (frame.origin.xy >> 6);
  if (any(greaterThanEqual(abs(away), ivec2(kHighlightTiles / 2)))) return false;
  return texelFetch(highlight_mask, tile & (kHighlightTiles - 1), 0).r > 0.0;
}

/// A place's colour on the screen with its mark. `footprint_cells`: how much of the ground a pixel covers.
vec3 withHighlight(vec3 colour, vec2 rel_cells, float footprint_cells) {
  if (frame.look.w <= 0.0) return colour;
  ivec2 cell = frame.origin.xy + ivec2(floor(rel_cells + 0.5));
  ivec2 tile = cell >> 6;
  if (!marked(tile)) return colour;
  vec2 low = vec2(cell & 63) + fract(rel_cells + 0.5);
  float width = max(1.0, 2.0 * footprint_cells);
  bool line = (low.x < width && !marked(tile - ivec2(1, 0))) || (low.y < width && !marked(tile - ivec2(0, 1))) ||
              (64.0 - low.x < width && !marked(tile + ivec2(1, 0))) ||
              (64.0 - low.y < width && !marked(tile + ivec2(0, 1)));
  bool seam = min(low.x, low.y) < 0.5 * width || max(low.x, low.y) > 64.0 - 0.5 * width;
  return mix(colour, kHighlight, (line ? 0.9 : (seam ? 0.6 : 0.38)) * frame.look.w);
}
