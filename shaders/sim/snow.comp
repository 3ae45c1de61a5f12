// Stage craters: what fell on live tiles since their last beat, before new craters. In: snow tiles, snow layers, pool
// bedrock. In and out: pool height. A lane takes kSnowLaneCells cells of a tile. Twin: addSnow.
#version 450 core
#include "../rules/snowfall.h"
#include "tick.glsl"

layout(std430, binding = kBindSnowTiles) readonly buffer SnowTiles { SnowTile snow_tiles[]; };
layout(std430, binding = kBindSnowLayers) readonly buffer SnowLayers { SnowLayer snow_layers[]; };
layout(std430, binding = kBindPoolHeight) buffer PoolHeight { int pool_height[]; };
layout(std430, binding = kBindPoolBedrock) readonly buffer PoolBedrock { int pool_bedrock[]; };

const int kGroupsPerTile = kTileCells / (kGroup * kSnowLaneCells);

/// What a snowfall has left on a cell by the last beat and by this one.
ivec2 fallenOn(int x, int y, SnowLayer layer) {
  if (x < layer.x0 || y < layer.y0 || x >= layer.x1 || y >= layer.y1) return ivec2(0);
  return ivec2(snowOn(layer.seed, x, y, SnowDepth(layer.layers_before, layer.share_before)),
               snowOn(layer.seed, x, y, SnowDepth(layer.layers, layer.share)));
}

void main() {
  if (groupIndex() >= group_count) return;
  SnowTile tile = snow_tiles[groupIndex() / kGroupsPerTile];
  int first = groupIndex() % kGroupsPerTile * kGroup * kSnowLaneCells + lane();
  for (int i = 0; i < kSnowLaneCells; ++i) {
    int cell = first + i * kGroup;
    ivec2 fallen = ivec2(0);
    for (int layer = tile.first_layer; layer < tile.end_layer; ++layer)
      fallen += fallenOn(tile.x0 + cell % kTileSize, tile.y0 + cell / kTileSize, snow_layers[layer]);
    if (fallen.x == fallen.y) continue;
    int at = tile.slot * kTileCells + cell;
    int level = min(pool_bedrock[at] + tile.soil_depth + fallen.x, kHeightLimit);
    pool_height[at] = snowGround(pool_height[at], level, fallen.y - fallen.x);
  }
}
