// Stage hash: what the tick did to a tile: the box of changed cells, the sums of hashes and heights, the differences.
// Brings the pool up to date. In: tiles, height. Out: results, staging, tick.staged_cells. In and out: pool height.
// Where SPOOR_COMPACTS is 1, the same of compacted soil. A group takes a tile. Twin: hash.cpp.
#version 450 core
#include "../rules/mix.h"
#include "tick.glsl"

layout(std430, binding = kBindTiles) readonly buffer Tiles { TileEntry tiles[]; };
layout(std430, binding = kBindHeight) readonly buffer Height { int height[]; };
layout(std430, binding = kBindPoolHeight) buffer PoolHeight { int pool_height[]; };
layout(std430, binding = kBindResults) writeonly buffer Results { TileResult results[]; };
layout(std430, binding = kBindStaging) writeonly buffer Staging { int staging[]; };
#if SPOOR_COMPACTS
layout(std430, binding = kBindCompacted) readonly buffer Compacted { int compacted[]; };
layout(std430, binding = kBindPoolCompacted) buffer PoolCompacted { int pool_compacted[]; };
#endif

const int kSums = 8;
shared int box_x0, box_y0, box_x1, box_y1, first_staged, compacts;
shared uint sums[kSums];

#if SPOOR_COMPACTS
/// Adds a cell's compacted soil; has it changed? Where there is none it does not count.
bool addCompacted(int tile, int cell, int x, int y, inout uint lane_sums[kSums]) {
  int value = compacted[tile * kTileCells + cell];
  if (value != 0) {
    uint key = cellKey(tiles[tile].x0 + x, tiles[tile].y0 + y, kCompactedPlane);
    uint low = cellMixLow(key, value);
    uint high = cellMixHigh(key, value);
    lane_sums[0] += low & 0xffffu;
    lane_sums[1] += low >> 16;
    lane_sums[2] += high & 0xffffu;
    lane_sums[3] += high >> 16;
    lane_sums[6] += uint(value) & 0xffffu;
    lane_sums[7] += uint(value) >> 16;
  }
  if (value == pool_compacted[tiles[tile].slot * kTileCells + cell]) return false;
  compacts = 1;
  return true;
}
#endif

void addUp(int tile) {
  uint lane_sums[kSums] = uint[kSums](0u, 0u, 0u, 0u, 0u, 0u, 0u, 0u);
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
    bool changed = value != pool_height[tiles[tile].slot * kTileCells + cell];
#if SPOOR_COMPACTS
    changed = addCompacted(tile, cell, x, y, lane_sums) || changed;
#endif
    if (changed) box = ivec4(min(box.x, x), min(box.y, y), max(box.z, x + 1), max(box.w, y + 1));
  }
  for (int i = 0; i < kSums; ++i) atomicAdd(sums[i], lane_sums[i]);
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
    box_x1 = box_y1 = compacts = 0;
  }
  if (lane() < kSums) sums[lane()] = 0u;
  barrier();
  addUp(tile);
  barrier();
  int width = max(box_x1 - box_x0, 0);
  int cell_count = width * max(box_y1 - box_y0, 0);
  if (lane() == 0) {
    first_staged = cell_count == 0 ? 0 : atomicAdd(tick.staged_cells, cell_count * (1 + compacts));
    results[tile] = TileResult(box_x0, box_y0, box_x1, box_y1, uint[2](sums[0], sums[1]), uint[2](sums[2], sums[3]),
                               uint[2](sums[4], sums[5]), uint[2](sums[6], sums[7]), compacts, first_staged);
  }
  barrier();
  for (int i = lane(); i < cell_count; i += kGroup) {
    int cell = (box_y0 + i / width) * kTileSize + box_x0 + i % width;
    int after = height[tile * kTileCells + cell];
    staging[first_staged + i] = after - pool_height[tiles[tile].slot * kTileCells + cell];
    pool_height[tiles[tile].slot * kTileCells + cell] = after;
#if SPOOR_COMPACTS
    if (compacts == 0) continue;
    after = compacted[tile * kTileCells + cell];
    staging[first_staged + cell_count + i] = after - pool_compacted[tiles[tile].slot * kTileCells + cell];
    pool_compacted[tiles[tile].slot * kTileCells + cell] = after;
#endif
  }
}
