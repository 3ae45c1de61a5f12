// Stage relax: what both of its plain passes share. A lane takes the pairs that begin in four columns of a slab's rows.
#ifndef SPOOR_SIM_EXCHANGE_GLSL
#define SPOOR_SIM_EXCHANGE_GLSL
#include "../rules/exchange.h"
#include "tick.glsl"

layout(std430, binding = kBindTiles) readonly buffer Tiles { TileEntry tiles[]; };
layout(std430, binding = kBindTileStates) buffer TileStates { TileState tile_states[]; };
layout(std430, binding = kBindHeight) buffer Height { ivec4 height[]; };
layout(std430, binding = kBindBedrock) readonly buffer Bedrock { ivec4 bedrock[]; };
layout(std430, binding = kBindUnderside) readonly buffer Underside { ivec4 underside[]; };
layout(location = 2) uniform int step;
layout(location = 3) uniform int parity;        // of the pairs' first cells
layout(location = 4) uniform int skip_settled;  // 0: visit every pair

const int kRowQuads = kTileSize / 4;
const int kTileQuads = kTileCells / 4;
const int kTileLanes = kSlabs * kRowQuads;

/// Is there nothing in a slab that this step could move, as far as the slab itself goes? Not active: nothing.
bool settled(int tile, int slab) {
  return tile < 0 || skip_settled != 0 && tile_states[tile].changed_at[slab] < step - (kMatchingCount - 1);
}

bool covered(int tile) { return tile >= 0 && tile_states[tile].covered != 0; }

/// Is there a height from which the height limit could stop soil from coming?
bool nearLimit() { return tick.highest + tick.obstacle_threshold >= kNoUnderside; }

ivec4 roomsBeneath(ivec4 cells, ivec4 under) {
  return ivec4(
      roomBeneath(cells.x, under.x, tick.obstacle_threshold), roomBeneath(cells.y, under.y, tick.obstacle_threshold),
      roomBeneath(cells.z, under.z, tick.obstacle_threshold), roomBeneath(cells.w, under.w, tick.obstacle_threshold));
}

#endif
