// Stage relax: one horizontal matching of all active tiles.
// In: tiles, bedrock, underside, materials. In and out: height, tile states. Twin: relax.cpp, exchangeAlong.
#version 450 core
#include "exchange.glsl"

/// Four cells; pairs are (x, y) and (z, w). Do any move?
bool exchangeEven(int at, Slab slab, bool beneath) {
  ivec4 cells = height[at];
  ivec4 soil = cells - bedrock[at];
  ivec4 room = beneath ? roomsBeneath(cells, undersides(slab, at)) : ivec4(kHeightLimit);
  ivec4 rest = thresholdsOf(at);
  int first = pairFlow(cells.x, cells.y, rest.x, rest.y, soil.x, soil.y, room.x, room.y);
  int second = pairFlow(cells.z, cells.w, rest.z, rest.w, soil.z, soil.w, room.z, room.w);
  if ((first | second) == 0) return false;
  height[at] = cells + ivec4(-first, first, -second, second);
  return true;
}

/// Pairs are (y, z), and (w, x of the next four) where those are active.
bool exchangeOdd(int at, int next_at, Slab slab, Slab next, bool beneath) {
  ivec4 cells = height[at];
  ivec4 soil = cells - bedrock[at];
  ivec4 room = beneath ? roomsBeneath(cells, undersides(slab, at)) : ivec4(kHeightLimit);
  ivec4 rest = thresholdsOf(at);
  int inner = pairFlow(cells.y, cells.z, rest.y, rest.z, soil.y, soil.z, room.y, room.z);
  if (inner != 0) {
    height[at].y = cells.y - inner;
    height[at].z = cells.z + inner;
  }
  if (next.tile < 0) return inner != 0;
  int beyond = height[next_at].x;
  int beyond_room = beneath ? roomBeneath(beyond, undersides(next, next_at).x, obstacle_threshold) : kHeightLimit;
  int outer = pairFlow(cells.w, beyond, rest.w, thresholdOf(materialOf(4 * next_at)), soil.w,
                       beyond - bedrock[next_at].x, room.w, beyond_room);
  if (outer != 0) {
    height[at].w = cells.w - outer;
    height[next_at].x = beyond + outer;
  }
  return (inner | outer) != 0;
}

void main() {
  int id = groupIndex() * kGroup + lane();
  int tile = id / kRowQuads;
  if (tile >= tile_count) return;
  int column = id % kRowQuads;
  bool last = column == kRowQuads - 1;
  int right_tile = SPOOR_PARITY == 0 ? -1 : tiles[tile].neighbour[5];
  int to_next = last ? (right_tile - tile) * kTileQuads - column : 1;
  int index = -1;
  for (;;) {
    Slab slab, right;
    do {
      ++index;
      slab = slabAt(tile, min(index, kSlabs - 1));
      right = slabAt(right_tile, slab.slab);
    } while (index < kSlabs && settled(slab) && settled(right));
    if (index >= kSlabs) break;
    if (column == 0) atomicAdd(tick.slabs_visited, 1);
    Slab next = slab;
    if (last) next = right;
    bool beneath = limits(min(slab.ceiling, next.ceiling));
    int at = tile * kTileQuads + index * kSlabRows * kRowQuads + column;
    bool moved = false;
    for (int row = 0; row < kSlabRows; ++row) {
      bool row_moved =
          SPOOR_PARITY == 0 ? exchangeEven(at, slab, beneath) : exchangeOdd(at, at + to_next, slab, next, beneath);
      moved = moved || row_moved;
      at += kRowQuads;
    }
    if (!moved) continue;
    markChanged(slab);
    if (SPOOR_PARITY != 0 && next.tile >= 0) markChanged(next);
  }
}
