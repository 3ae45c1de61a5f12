// Stage active: lays out the active tiles' cells side by side, as they are before the tick.
// In: tiles, pool. Out: height, bedrock, tile states, tick.highest; where SPOOR_COMPACTS is 1, compacted,
// and where SPOOR_MIXED is 1, materials.
// A group takes kGroup * 16 cells of a tile. Twin: WorkArea::gather.
#version 450 core
#include "tick.glsl"

layout(std430, binding = kBindTiles) readonly buffer Tiles { TileEntry tiles[]; };
layout(std430, binding = kBindTileStates) writeonly buffer TileStates { TileState tile_states[]; };
layout(std430, binding = kBindHeight) writeonly buffer Height { ivec4 height[]; };
layout(std430, binding = kBindBedrock) writeonly buffer Bedrock { ivec4 bedrock[]; };
layout(std430, binding = kBindPoolHeight) readonly buffer PoolHeight { ivec4 pool_height[]; };
layout(std430, binding = kBindPoolBedrock) readonly buffer PoolBedrock { ivec4 pool_bedrock[]; };
#if SPOOR_COMPACTS
layout(std430, binding = kBindCompacted) writeonly buffer Compacted { ivec4 compacted[]; };
layout(std430, binding = kBindPoolCompacted) readonly buffer PoolCompacted { ivec4 pool_compacted[]; };
#endif
#if SPOOR_MIXED
layout(std430, binding = kBindMaterial) writeonly buffer Material { uint material[]; };
layout(std430, binding = kBindPoolMaterial) readonly buffer PoolMaterial { uint pool_material[]; };
#endif

const int kQuads = kTileCells / 4;
const int kGroupsPerTile = kQuads / (kGroup * kGatherQuads);
shared int group_highest;

void main() {
  int tile = groupIndex() / kGroupsPerTile;
  if (tile >= tick.tile_count) return;
  if (lane() == 0) group_highest = -kHeightLimit;
  barrier();
  int first = groupIndex() % kGroupsPerTile * kGroup * kGatherQuads + lane();
  int lane_highest = -kHeightLimit;
  for (int i = 0; i < kGatherQuads; ++i) {
    int quad = first + i * kGroup;
    ivec4 cells = pool_height[tiles[tile].slot * kQuads + quad];
    height[tile * kQuads + quad] = cells;
    bedrock[tile * kQuads + quad] = pool_bedrock[tiles[tile].slot * kQuads + quad];
#if SPOOR_COMPACTS
    compacted[tile * kQuads + quad] = pool_compacted[tiles[tile].slot * kQuads + quad];
#endif
#if SPOOR_MIXED
    material[tile * kQuads + quad] = pool_material[tiles[tile].slot * kQuads + quad];
#endif
    lane_highest = max(lane_highest, max(max(cells.x, cells.y), max(cells.z, cells.w)));
  }
  atomicMax(group_highest, lane_highest);
  barrier();
  if (lane() == 0) atomicMax(tick.highest, group_highest);
  if (groupIndex() % kGroupsPerTile == 0 && lane() < kSlabs) {
    tile_states[tile].ceiling[lane()] = kNoUnderside;
    tile_states[tile].changed_at[lane()] = 0;
  }
}
