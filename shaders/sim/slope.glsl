// Stage relax by the rules of rules/slope.h: what a lane, which takes a column of a slab, sees of the cells around it.
// SPOOR_BENEATH is 1 where bodies may stand over active tiles.
#ifndef SPOOR_SIM_SLOPE_GLSL
#define SPOOR_SIM_SLOPE_GLSL
#include "../rules/slope.h"
#include "tick.glsl"

layout(std430, binding = kBindTiles) readonly buffer Tiles { TileEntry tiles[]; };
layout(std430, binding = kBindTileStates) readonly buffer TileStates { TileState tile_states[]; };
layout(std430, binding = kBindHeight) readonly buffer Height { int height[]; };
layout(std430, binding = kBindBedrock) readonly buffer Bedrock { int bedrock[]; };
layout(std430, binding = kBindUnderside) readonly buffer Underside { int underside[]; };
layout(location = 2) uniform int tile_count;
layout(location = 3) uniform int slope_threshold;
layout(location = 4) uniform int diagonal_threshold;
layout(location = 5) uniform int roughness;
layout(location = 6) uniform int obstacle_threshold;

/// Three cells of a row, x - 1, x and x + 1. Those that are not active hold no soil and take none.
struct Row {
  ivec3 at;  // in the tiles' planes; -1: not active
  ivec3 height;
  ivec3 soil;
  ivec3 room;
};

int tile, first_y;  // of the lane
ivec3 columns;      // x - 1, x and x + 1, each in its tile
ivec3 tiles_below, tiles_beside, tiles_above;

/// False where the lane has nothing to do.
bool beginColumn() {
  int id = groupIndex() * kGroup + lane();
  tile = id / (kTileSize * kSlabs);
  if (tile >= tile_count) return false;
  int x = id % kTileSize;
  first_y = id / kTileSize % kSlabs * kSlabRows;
  columns = ivec3(x + kTileSize - 1, x, x + 1) % kTileSize;
  ivec3 across = ivec3(x == 0 ? 0 : 1, 1, x == kTileSize - 1 ? 2 : 1);
  for (int i = 0; i < 3; ++i) {
    tiles_below[i] = tiles[tile].neighbour[across[i]];
    tiles_beside[i] = tiles[tile].neighbour[3 + across[i]];
    tiles_above[i] = tiles[tile].neighbour[6 + across[i]];
  }
  return true;
}

/// Row y of the lane's tile, or one beyond it.
Row rowAt(int y) {
  ivec3 in_tiles = tiles_beside;
  if (y < 0) in_tiles = tiles_below;
  if (y >= kTileSize) in_tiles = tiles_above;
  int local_y = y & (kTileSize - 1);
  Row row;
  for (int i = 0; i < 3; ++i) {
    int in_tile = max(in_tiles[i], 0);
    int at = in_tile * kTileCells + local_y * kTileSize + columns[i];
    int cell = height[at];
    int under = kNoUnderside;
    if (SPOOR_BENEATH != 0 && tile_states[in_tile].ceiling[local_y / kSlabRows] < kNoUnderside) under = underside[at];
    bool is_active = in_tiles[i] >= 0;
    row.at[i] = is_active ? at : -1;
    row.height[i] = is_active ? cell : 0;
    row.soil[i] = is_active ? cell - bedrock[at] : 0;
    row.room[i] = is_active ? roomBeneath(cell, under, obstacle_threshold) : 0;
  }
  return row;
}

bool givesTo(int own_height, int height, int room) { return slopeGives(own_height - height, slope_threshold, room); }

/// Those of three neighbours that a cell gives to: how many (x), and the sum of their drops (y).
ivec2 receiversIn(int own_height, Row row, bool with_middle) {
  ivec2 found = ivec2(0);
  for (int i = 0; i < 3; ++i)
    if ((i != 1 || with_middle) && givesTo(own_height, row.height[i], row.room[i]))
      found += ivec2(1, min(own_height - row.height[i], kDifferenceMost));
  return found;
}

/// What the middle cell of `row` gives each neighbour that it gives to.
int amountOf(Row below, Row row, Row above) {
  ivec2 receivers = receiversIn(row.height.y, below, true) + receiversIn(row.height.y, row, false) +
                    receiversIn(row.height.y, above, true);
  return slopeAmount(receivers.y, receivers.x, roughness, row.soil.y);
}

#endif
