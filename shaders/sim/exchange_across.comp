// Stage relax: one matching of pairs (x, y) - (x + SPOOR_SHIFT, y + 1) of all active tiles; a shift of 0 is vertical, 1
// and -1 are the diagonals. In: tiles, bedrock, underside. In and out: height, tile states.
// Twin: relax.cpp, exchangeAcross.
#version 450 core
#include "exchange.glsl"
#include "tick.glsl"

const int kUp = 7;
const int kSide = 4 + SPOOR_SHIFT;
const int kUpSide = 7 + SPOOR_SHIFT;

int threshold;

bool allSettled(int tile, int slab) {
  if (!settled(tile, slab)) return false;
  if (SPOOR_SHIFT != 0 && !settled(tiles[tile].neighbour[kSide], slab)) return false;
  if (parity == 0) return true;
  bool top = slab == kSlabs - 1;
  if (!settled(top ? tiles[tile].neighbour[kUp] : tile, top ? 0 : slab + 1)) return false;
  return SPOOR_SHIFT == 0 || settled(tiles[tile].neighbour[top ? kUpSide : kSide], top ? 0 : slab + 1);
}

/// Four cells of the upper row as the lower row's partners: shifted, one of them from the quad beside.
ivec4 partners(ivec4 above, int beside) {
  if (SPOOR_SHIFT == 0) return above;
  return SPOOR_SHIFT > 0 ? ivec4(above.yzw, beside) : ivec4(beside, above.xyz);
}
int nearest(ivec4 beside) { return SPOOR_SHIFT > 0 ? beside.x : beside.w; }

/// The four cells at `at` with their partners in the quad above and the one beside that (-1: not active).
bool exchangeQuad(int at, int above_at, int beside_at, bool beneath, bvec3 under_body) {
  ivec4 a = height[at];
  ivec4 soil_a = a - bedrock[at];
  bool has_above = above_at >= 0;
  bool has_beside = SPOOR_SHIFT != 0 && beside_at >= 0;
  ivec4 above = has_above ? height[above_at] : ivec4(0);
  ivec4 above_bedrock = has_above ? bedrock[above_at] : ivec4(0);
  ivec4 b = partners(above, has_beside ? nearest(height[beside_at]) : 0);
  ivec4 soil_b = b - partners(above_bedrock, has_beside ? nearest(bedrock[beside_at]) : 0);
  ivec4 room_a = ivec4(kHeightLimit);
  ivec4 room_b = room_a;
  if (beneath) {
    room_a = roomsBeneath(a, under_body.x ? underside[at] : ivec4(kNoUnderside));
    room_b = roomsBeneath(b, partners(under_body.y ? underside[above_at] : ivec4(kNoUnderside),
                                      under_body.z ? nearest(underside[beside_at]) : kNoUnderside));
  }
  ivec4 flow = ivec4(pairFlow(a.x, b.x, threshold, soil_a.x, soil_b.x, room_a.x, room_b.x),
                     pairFlow(a.y, b.y, threshold, soil_a.y, soil_b.y, room_a.y, room_b.y),
                     pairFlow(a.z, b.z, threshold, soil_a.z, soil_b.z, room_a.z, room_b.z),
                     pairFlow(a.w, b.w, threshold, soil_a.w, soil_b.w, room_a.w, room_b.w));
  if (SPOOR_SHIFT > 0) {
    if (!has_above) flow.xyz = ivec3(0);
    if (!has_beside) flow.w = 0;
  } else if (SPOOR_SHIFT < 0) {
    if (!has_above) flow.yzw = ivec3(0);
    if (!has_beside) flow.x = 0;
  }
  if (flow == ivec4(0)) return false;
  height[at] = a - flow;
  b += flow;
  if (SPOOR_SHIFT == 0) {
    height[above_at] = b;
  } else if (SPOOR_SHIFT > 0) {
    if (has_above) {
      height[above_at].y = b.x;
      height[above_at].z = b.y;
      height[above_at].w = b.z;
    }
    if (has_beside) height[beside_at].x = b.w;
  } else {
    if (has_above) {
      height[above_at].x = b.y;
      height[above_at].y = b.z;
      height[above_at].z = b.w;
    }
    if (has_beside) height[beside_at].w = b.x;
  }
  return true;
}

void main() {
  int id = groupIndex() * kGroup + lane();
  int tile = id / kTileLanes;
  if (tile >= tick.tile_count) return;
  int slab = id % kTileLanes / kRowQuads;
  if (allSettled(tile, slab)) return;
  int column = id % kRowQuads;
  if (column == 0) atomicAdd(tick.slabs_visited, 1);

  threshold = SPOOR_SHIFT == 0 ? tick.slope_threshold : tick.diagonal_threshold;
  int beside_column = column + SPOOR_SHIFT;
  bool leaves = beside_column < 0 || beside_column >= kRowQuads;
  int moved_slab = -1;
  for (int row = slab * kSlabRows + parity; row < (slab + 1) * kSlabRows + parity; row += 2) {
    bool top = row == kTileSize - 1;
    int above_tile = top ? tiles[tile].neighbour[kUp] : tile;
    int beside_tile = leaves ? tiles[tile].neighbour[top ? kUpSide : kSide] : above_tile;
    if (above_tile < 0 && (SPOOR_SHIFT == 0 || beside_tile < 0)) continue;
    bvec3 under_body = bvec3(covered(tile), covered(above_tile), SPOOR_SHIFT != 0 && covered(beside_tile));
    int above_row = top ? 0 : (row + 1) * kRowQuads;
    bool moved = exchangeQuad(tile * kTileQuads + row * kRowQuads + column,
                              above_tile < 0 ? -1 : above_tile * kTileQuads + above_row + column,
                              beside_tile < 0 ? -1 : beside_tile * kTileQuads + above_row + (beside_column & 15),
                              any(under_body) || nearLimit(), under_body);
    if (!moved) continue;
    tile_states[tile].changed_at[row / kSlabRows] = step;
    int above_slab = top ? 0 : (row + 1) / kSlabRows;
    if (above_tile >= 0) tile_states[above_tile].changed_at[above_slab] = step;
    if (SPOOR_SHIFT != 0 && beside_tile >= 0) tile_states[beside_tile].changed_at[above_slab] = step;
  }
}
