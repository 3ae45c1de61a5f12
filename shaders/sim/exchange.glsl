// Stage relax: what both of its plain passes share. A lane takes the pairs that begin in four columns of a tile.
// Software renderers run both sides of every branch and leave loops only: lanes go from one unsettled slab to the next,
// rather than past the settled ones. SPOOR_PARITY is that of the pairs' first cells; SPOOR_SHIFT what lies between
// a pair's columns; SPOOR_BENEATH is 1 where bodies may stand over active tiles.
#ifndef SPOOR_SIM_EXCHANGE_GLSL
#define SPOOR_SIM_EXCHANGE_GLSL
#include "../rules/exchange.h"
#include "materials.glsl"
#include "tick.glsl"

layout(std430, binding = kBindTiles) readonly buffer Tiles { TileEntry tiles[]; };
layout(std430, binding = kBindTileStates) buffer TileStates { TileState tile_states[]; };
layout(std430, binding = kBindHeight) buffer Height { ivec4 height[]; };
layout(std430, binding = kBindBedrock) readonly buffer Bedrock { ivec4 bedrock[]; };
layout(std430, binding = kBindUnderside) readonly buffer Underside { ivec4 underside[]; };
layout(location = 2) uniform int relax_step;
layout(location = 3) uniform int skip_settled;  // 0: visit every pair
layout(location = 4) uniform int tile_count;
layout(location = 5) uniform int obstacle_threshold;

const int kRowQuads = kTileSize / 4;
const int kTileQuads = kTileCells / 4;

/// A slab whose cells a lane's pairs may have; -1: not active.
struct Slab {
  int tile;
  int slab;
  int ceiling;
};

Slab slabAt(int tile, int slab) {
  return Slab(tile, slab, SPOOR_BENEATH == 0 || tile < 0 ? kNoUnderside : tile_states[tile].ceiling[slab]);
}

/// Is there nothing in it that this step could move, as far as the slab itself goes?
bool settled(Slab slab) {
  return slab.tile < 0 ||
         skip_settled != 0 && tile_states[slab.tile].changed_at[slab.slab] < relax_step - (kMatchingCount - 1);
}

void markChanged(Slab slab) { tile_states[slab.tile].changed_at[slab.slab] = relax_step; }

/// The lowest underside from which soil can be stopped, now that no cell rises above the highest of all.
bool limits(int ceiling) { return SPOOR_BENEATH != 0 && ceiling <= tick.highest + obstacle_threshold; }

ivec4 undersides(Slab slab, int at) { return slab.ceiling < kNoUnderside ? underside[at] : ivec4(kNoUnderside); }

ivec4 roomsBeneath(ivec4 cells, ivec4 under) {
  return ivec4(roomBeneath(cells.x, under.x, obstacle_threshold), roomBeneath(cells.y, under.y, obstacle_threshold),
               roomBeneath(cells.z, under.z, obstacle_threshold), roomBeneath(cells.w, under.w, obstacle_threshold));
}

int thresholdOf(int number) {
  return SPOOR_SHIFT == 0 ? materials[number].slope_threshold : materials[number].diagonal_threshold;
}

/// The largest height differences that rest where these four cells are the higher ones.
ivec4 thresholdsOf(int quad) {
  ivec4 own = materialsOf(quad);
  return ivec4(thresholdOf(own.x), thresholdOf(own.y), thresholdOf(own.z), thresholdOf(own.w));
}

#endif
