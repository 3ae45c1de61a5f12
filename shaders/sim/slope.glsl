// Stage relax by the rules of rules/slope.h and rules/drift.h: what a lane, which takes a column of a slab, sees of the
// cells around it. SPOOR_BENEATH is 1 where bodies may stand over active tiles.
#ifndef SPOOR_SIM_SLOPE_GLSL
#define SPOOR_SIM_SLOPE_GLSL
#include "../rules/slope.h"
#include "materials.glsl"
#include "tick.glsl"

layout(std430, binding = kBindTiles) readonly buffer Tiles { TileEntry tiles[]; };
layout(std430, binding = kBindTileStates) readonly buffer TileStates { TileState tile_states[]; };
layout(std430, binding = kBindHeight) readonly buffer Height { int height[]; };
layout(std430, binding = kBindBedrock) readonly buffer Bedrock { int bedrock[]; };
layout(std430, binding = kBindUnderside) readonly buffer Underside { int underside[]; };
layout(location = 2) uniform int tile_count;
layout(location = 3) uniform int obstacle_threshold;

/// Three cells of a row, x - 1, x and x + 1. Those that are not active hold no soil and take none.
struct Row {
  ivec3 at;  // in the tiles' planes; -1: not active
  ivec3 height;
  ivec3 soil;
  ivec3 room;
  ivec3 kind;  // material
};

/// Slabs that hold three cells of a row: their tiles, and whether bodies may stand over them.
struct Slabs {
  ivec3 tiles;  // -1: not active
  bvec3 beneath;
};

int tile, first_y;  // of the lane
ivec3 columns;      // x - 1, x and x + 1, each in its tile
Slabs slabs_below, slabs_beside, slabs_above;

/// @param y  in the lane's tile, or beyond it
Slabs slabsAt(ivec3 across, int y) {
  int first = (y < 0 ? 0 : y < kTileSize ? 1 : 2) * 3;
  int slab = (y & (kTileSize - 1)) / kSlabRows;
  Slabs slabs;
  for (int i = 0; i < 3; ++i) {
    slabs.tiles[i] = tiles[tile].neighbour[first + across[i]];
    slabs.beneath[i] = SPOOR_BENEATH != 0 && tile_states[max(slabs.tiles[i], 0)].ceiling[slab] < kNoUnderside;
  }
  return slabs;
}

/// False where the lane has nothing to do.
bool beginColumn() {
  int id = groupIndex() * kGroup + lane();
  tile = id / (kTileSize * kSlabs);
  if (tile >= tile_count) return false;
  int x = id % kTileSize;
  first_y = id / kTileSize % kSlabs * kSlabRows;
  columns = ivec3(x + kTileSize - 1, x, x + 1) % kTileSize;
  ivec3 across = ivec3(x == 0 ? 0 : 1, 1, x == kTileSize - 1 ? 2 : 1);
  slabs_below = slabsAt(across, first_y - 1);
  slabs_beside = slabsAt(across, first_y);
  slabs_above = slabsAt(across, first_y + kSlabRows);
  return true;
}

/// Row y of the lane's slab, or one beyond it.
Row rowAt(int y) {
  Slabs slabs = slabs_beside;
  if (y < first_y) slabs = slabs_below;
  if (y >= first_y + kSlabRows) slabs = slabs_above;
  int local_y = y & (kTileSize - 1);
  Row row;
  for (int i = 0; i < 3; ++i) {
    bool is_active = slabs.tiles[i] >= 0;
    int at = max(slabs.tiles[i], 0) * kTileCells + local_y * kTileSize + columns[i];
    int cell = height[at];
    int under = kNoUnderside;
    if (slabs.beneath[i]) under = underside[at];
    row.at[i] = is_active ? at : -1;
    row.height[i] = is_active ? cell : 0;
    row.soil[i] = is_active ? cell - bedrock[at] : 0;
    row.room[i] = is_active ? roomBeneath(cell, under, obstacle_threshold) : 0;
    row.kind[i] = materialOf(at);
  }
  return row;
}

/// Does cell i of `from` give to cell j of `to`?
bool givesTo(Row from, int i, Row to, int j) {
  return slopeGives(from.height[i] - to.height[j], materials[from.kind[i]].slope_threshold, to.room[j]);
}

/// Those of three neighbours that the middle cell of `row` gives to: how many (x), and the sum of their drops (y).
ivec2 receiversIn(Row row, Row neighbours, bool with_middle) {
  ivec2 found = ivec2(0);
  for (int i = 0; i < 3; ++i)
    if ((i != 1 || with_middle) && givesTo(row, 1, neighbours, i))
      found += ivec2(1, min(row.height.y - neighbours.height[i], kDifferenceMost));
  return found;
}

/// What the middle cell of `row` gives each neighbour that it gives to.
int amountOf(Row below, Row row, Row above) {
  ivec2 receivers = receiversIn(row, below, true) + receiversIn(row, row, false) + receiversIn(row, above, true);
  return slopeAmount(receivers.y, receivers.x, materials[row.kind.y].roughness, row.soil.y);
}

#endif
