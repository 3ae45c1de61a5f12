// Stage relax: one matching of pairs (x, y) - (x + SPOOR_SHIFT, y + 1) of all active tiles; a shift of 0 is vertical, 1
// and -1 are the diagonals. In: tiles, bedrock, underside, materials. In and out: height, tile states.
// Twin: relax.cpp, exchangeAcross.
#version 450 core
#include "exchange.glsl"

/// Four cells of the upper row as the lower row's partners: shifted, one of them from the quad beside.
ivec4 partners(ivec4 above, int beside) {
  if (SPOOR_SHIFT == 0) return above;
  return SPOOR_SHIFT > 0 ? ivec4(above.yzw, beside) : ivec4(beside, above.xyz);
}
int nearest(ivec4 beside) { return SPOOR_SHIFT > 0 ? beside.x : beside.w; }

/// Where the flows of four cells go, in the order of their partners.
void give(int above_at, int beside_at, bool has_above, bool has_beside, ivec4 b) {
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
}

/// The four cells at `at` with their partners in the quad above and the one beside that. Do any move?
bool exchangeQuad(int at, int above_at, int beside_at, Slab slab, Slab above_slab, Slab beside_slab, bool beneath) {
  bool has_above = above_slab.tile >= 0;
  bool has_beside = SPOOR_SHIFT != 0 && beside_slab.tile >= 0;
  ivec4 a = height[at];
  ivec4 soil_a = a - bedrock[at];
  ivec4 above = ivec4(0);
  ivec4 above_bedrock = ivec4(0);
  ivec4 above_rest = ivec4(0);
  if (has_above) {
    above = height[above_at];
    above_bedrock = bedrock[above_at];
    above_rest = thresholdsOf(above_at);
  }
  ivec4 b = partners(above, has_beside ? nearest(height[beside_at]) : 0);
  ivec4 soil_b = b - partners(above_bedrock, has_beside ? nearest(bedrock[beside_at]) : 0);
  ivec4 rest_a = thresholdsOf(at);
  ivec4 rest_b = rest_a;
  if (SPOOR_MIXED != 0) rest_b = partners(above_rest, has_beside ? nearest(thresholdsOf(beside_at)) : 0);
  ivec4 room_a = ivec4(kHeightLimit);
  ivec4 room_b = room_a;
  if (beneath) {
    room_a = roomsBeneath(a, undersides(slab, at));
    room_b = roomsBeneath(b, partners(undersides(above_slab, above_at),
                                      has_beside ? nearest(undersides(beside_slab, beside_at)) : kNoUnderside));
  }
  ivec4 flow = ivec4(pairFlow(a.x, b.x, rest_a.x, rest_b.x, soil_a.x, soil_b.x, room_a.x, room_b.x),
                     pairFlow(a.y, b.y, rest_a.y, rest_b.y, soil_a.y, soil_b.y, room_a.y, room_b.y),
                     pairFlow(a.z, b.z, rest_a.z, rest_b.z, soil_a.z, soil_b.z, room_a.z, room_b.z),
                     pairFlow(a.w, b.w, rest_a.w, rest_b.w, soil_a.w, soil_b.w, room_a.w, room_b.w));
  flow *= partners(ivec4(has_above ? 1 : 0), has_beside ? 1 : 0);
  if (flow == ivec4(0)) return false;
  height[at] = a - flow;
  give(above_at, beside_at, has_above, has_beside, b + flow);
  return true;
}

void main() {
  int id = groupIndex() * kGroup + lane();
  int tile = id / kRowQuads;
  if (tile >= tile_count) return;
  int column = id % kRowQuads;
  int beside_column = column + SPOOR_SHIFT;
  bool leaves = beside_column < 0 || beside_column >= kRowQuads;
  int beside_tile = leaves ? tiles[tile].neighbour[4 + SPOOR_SHIFT] : tile;
  int index = -1;
  for (;;) {
    // The slab itself and the one beside it; where pairs begin in odd rows, the last of them end in the slabs above.
    Slab slab, beside, above, above_beside;
    do {
      ++index;
      slab = slabAt(tile, min(index, kSlabs - 1));
      beside = slabAt(beside_tile, slab.slab);
      above = slab;
      above_beside = beside;
      if (SPOOR_PARITY != 0) {
        bool top = slab.slab == kSlabs - 1;
        above = slabAt(top ? tiles[tile].neighbour[7] : tile, top ? 0 : slab.slab + 1);
        above_beside = above;
        if (leaves) above_beside = slabAt(top ? tiles[tile].neighbour[7 + SPOOR_SHIFT] : beside_tile, above.slab);
      }
    } while (index < kSlabs && settled(slab) && settled(above) && settled(beside) && settled(above_beside));
    if (index >= kSlabs) break;
    if (column == 0) atomicAdd(tick.slabs_visited, 1);

    bool beneath = limits(min(min(slab.ceiling, beside.ceiling), min(above.ceiling, above_beside.ceiling)));
    bool moved = false;
    for (int row = index * kSlabRows + SPOOR_PARITY; row < (index + 1) * kSlabRows + SPOOR_PARITY; row += 2) {
      bool crosses = row % kSlabRows == kSlabRows - 1;
      Slab upper = slab;
      Slab upper_beside = beside;
      if (crosses) {
        upper = above;
        upper_beside = above_beside;
      }
      int upper_row = (row + 1) % kTileSize * kRowQuads;
      if (exchangeQuad(tile * kTileQuads + row * kRowQuads + column, upper.tile * kTileQuads + upper_row + column,
                       upper_beside.tile * kTileQuads + upper_row + (beside_column & (kRowQuads - 1)), slab, upper,
                       upper_beside, beneath)) {
        moved = true;
        if (upper.tile >= 0) markChanged(upper);
        if (SPOOR_SHIFT != 0 && upper_beside.tile >= 0) markChanged(upper_beside);
      }
    }
    if (moved) markChanged(slab);
  }
}
