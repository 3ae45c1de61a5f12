// Stage relax: one horizontal matching of all active tiles.
// In: tiles, bedrock, underside. In and out: height, tile states. Twin: relax.cpp, exchangeAlong.
#version 450 core
#include "exchange.glsl"
#include "tick.glsl"

int threshold;

/// Four cells; pairs are (x, y) and (z, w). Do any move?
bool exchangeEven(int at, bool beneath, bool under_body) {
  ivec4 cells = height[at];
  ivec4 soil = cells - bedrock[at];
  ivec4 room = beneath ? roomsBeneath(cells, under_body ? underside[at] : ivec4(kNoUnderside)) : ivec4(kHeightLimit);
  int first = pairFlow(cells.x, cells.y, threshold, soil.x, soil.y, room.x, room.y);
  int second = pairFlow(cells.z, cells.w, threshold, soil.z, soil.w, room.z, room.w);
  if ((first | second) == 0) return false;
  height[at] = cells + ivec4(-first, first, -second, second);
  return true;
}

/// Pairs are (y, z) and (w, x of the next four); no next: -1.
bool exchangeOdd(int at, int next, bool beneath, bool under_body, bool next_under_body) {
  ivec4 cells = height[at];
  ivec4 soil = cells - bedrock[at];
  ivec4 room = beneath ? roomsBeneath(cells, under_body ? underside[at] : ivec4(kNoUnderside)) : ivec4(kHeightLimit);
  int inner = pairFlow(cells.y, cells.z, threshold, soil.y, soil.z, room.y, room.z);
  if (inner != 0) {
    height[at].y = cells.y - inner;
    height[at].z = cells.z + inner;
  }
  if (next < 0) return inner != 0;
  int beyond = height[next].x;
  int beyond_under = next_under_body ? underside[next].x : kNoUnderside;
  int beyond_room = beneath ? roomBeneath(beyond, beyond_under, tick.obstacle_threshold) : kHeightLimit;
  int outer = pairFlow(cells.w, beyond, threshold, soil.w, beyond - bedrock[next].x, room.w, beyond_room);
  if (outer != 0) {
    height[at].w = cells.w - outer;
    height[next].x = beyond + outer;
  }
  return (inner | outer) != 0;
}

void main() {
  int id = groupIndex() * kGroup + lane();
  int tile = id / kTileLanes;
  if (tile >= tick.tile_count) return;
  int slab = id % kTileLanes / kRowQuads;
  int right = parity == 0 ? -1 : tiles[tile].neighbour[5];
  if (settled(tile, slab) && settled(right, slab)) return;
  int column = id % kRowQuads;
  if (column == 0) atomicAdd(tick.slabs_visited, 1);

  threshold = tick.slope_threshold;
  bool last = column == kRowQuads - 1;
  int next_tile = last ? right : tile;
  bool under_body = covered(tile);
  bool next_under_body = parity != 0 && covered(next_tile);
  bool beneath = under_body || next_under_body || nearLimit();
  int first = tile * kTileQuads + slab * kSlabRows * kRowQuads + column;
  int next = next_tile < 0 ? -1 : last ? first + (next_tile - tile) * kTileQuads - column : first + 1;
  bool moved = false;
  for (int quad = 0; quad < kSlabRows * kRowQuads; quad += kRowQuads) {
    bool row_moved = parity == 0
                         ? exchangeEven(first + quad, beneath, under_body)
                         : exchangeOdd(first + quad, next < 0 ? -1 : next + quad, beneath, under_body, next_under_body);
    moved = moved || row_moved;
  }
  if (!moved) return;
  tile_states[tile].changed_at[slab] = step;
  if (parity != 0 && next_tile >= 0) tile_states[next_tile].changed_at[slab] = step;
}
