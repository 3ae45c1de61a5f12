// Stage craters: what fell on live tiles since their last beat, before new craters. In: snow tiles, snow layers. In and
// out: pool height. A lane takes kSnowLaneCells cells of a tile. Twin: addSnow.
#version 450 core
#include "../rules/snowfall.h"
#include "tick.glsl"

layout(std430, binding = kBindSnowTiles) readonly buffer SnowTiles { SnowTile snow_tiles[]; };
layout(std430, binding = kBindSnowLayers) readonly buffer SnowLayers { SnowLayer snow_layers[]; };
layout(std430, binding = kBindPoolHeight) buffer PoolHeight { int pool_height[]; };

const int kGroupsPerTile = kTileCells / (kGroup * kSnowLaneCells);

/// What a snowfall leaves on a cell.
int fallenOn(int x, int y, SnowLayer layer) {
  if (x < layer.x0 || y < layer.y0 || x >= layer.x1 || y >= layer.y1) return 0;
  return snowOn(layer.seed, x, y, SnowDepth(layer.layers, layer.share)) -
         snowOn(layer.seed, x, y, SnowDepth(layer.layers_before, layer.share_before));
}

void main() {
  if (groupIndex() >= group_count) return;
  SnowTile tile = snow_tiles[groupIndex() / kGroupsPerTile];
  int first = groupIndex() % kGroupsPerTile * kGroup * kSnowLaneCells + lane();
  for (int i = 0; i < kSnowLaneCells; ++i) {
    int cell = first + i * kGroup;
    int fallen = 0;
    for (int layer = tile.first_layer; layer < tile.end_layer; ++layer)
      fallen += fallenOn(tile.x0 + cell % kTileSize, tile.y0 + cell / kTileSize, snow_layers[layer]);
    if (fallen == 0) continue;
    int at = tile.slot * kTileCells + cell;
    pool_height[at] = snowGround(pool_height[at], fallen);
  }
}
