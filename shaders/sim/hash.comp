// Stage hash: what the tick did to a tile: the box of changed cells, the sums of hashes and heights, the differences.
// Brings the pool up to date. In: tiles, height. Out: results, staging, tick.staged_cells. In and out: pool height.
// A group takes a tile. Twin: hash.cpp.
#version 450 core
#include "../rules/mix.h"
#include "tick.glsl"

layout(std430, binding = kBindTiles) readonly buffer Tiles { TileEntry tiles[]; };
layout(std430, binding = kBindHeight) readonly buffer Height { int height[]; };
layout(std430, binding = kBindPoolHeight) buffer PoolHeight { int pool_height[]; };
layout(std430, binding = kBindResults) writeonly buffer Results { TileResult results[]; };
layout(std430, binding = kBindStaging) writeonly buffer Staging { int staging[]; };

shared int box_x0, box_y0, box_x1, box_y1, first_staged;
shared uint sums[6];

void addUp(int tile) {
  uint lane_sums[6] = uint[6](0u, 0u, 0u, 0u, 0u, 0u);
  ivec4 box = ivec4(kTileSize, kTileSize, 0, 0);
  for (int cell = lane(); cell < kTileCells; cell += kGroup) {
    int x = cell % kTileSize;
    int y = cell / kTileSize;
    int value = height[tile * kTileCells + cell];
    uint key = cellKey(tiles[tile].x0 + x, tiles[tile].y0 + y, kHeightPlane);
    uint low = cellMixLow(key, value);
    uint high = cellMixHigh(key, value);
    uint positive = uint(value) + 0x40000000u;
    lane_sums[0] += low & 0xffffu;
    lane_sums[1] += low >> 16;
    lane_sums[2] += high & 0xffffu;
    lane_sums[3] += high >> 16;
    lane_sums[4] += positive & 0xffffu;
    lane_sums[5] += positive >> 16;
    if (value != pool_height[tiles[tile].slot * kTileCells + cell])
      box = ivec4(min(box.x, x), min(box.y, y), max(box.z, x + 1), max(box.w, y + 1));
  }
  for (int i = 0; i < 6; ++i) atomicAdd(sums[i], lane_sums[i]);
  if (box.z == 0) return;
  atomicMin(box_x0, box.x);
  atomicMin(box_y0, box.y);
  atomicMax(box_x1, box.z);
  atomicMax(box_y1, box.w);
}

void main() {
  int tile = groupIndex();
  if (tile >= tick.tile_count) return;
  if (lane() == 0) {
    box_x0 = box_y0 = kTileSize;
    box_x1 = box_y1 = 0;
  }
  if (lane() < 6) sums[lane()] = 0u;
  barrier();
  addUp(tile);
  barrier();
  int width = max(box_x1 - box_x0, 0);
  int cell_count = width * max(box_y1 - box_y0, 0);
  if (lane() == 0) {
    first_staged = cell_count == 0 ? 0 : atomicAdd(tick.staged_cells, cell_count);
    results[tile] = TileResult(box_x0, box_y0, box_x1, box_y1, uint[2](sums[0], sums[1]), uint[2](sums[2], sums[3]),
                               uint[2](sums[4], sums[5]), first_staged);
  }
  barrier();
  for (int i = lane(); i < cell_count; i += kGroup) {
    int cell = (box_y0 + i / width) * kTileSize + box_x0 + i % width;
    int after = height[tile * kTileCells + cell];
    staging[first_staged + i] = after - pool_height[tiles[tile].slot * kTileCells + cell];
    pool_height[tiles[tile].slot * kTileCells + cell] = after;
  }
}
