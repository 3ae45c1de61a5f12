// Stage craters: what new craters do to live tiles' cells, D(S) - D(S without them). In: crater tiles, craters, pool
// bedrock. Out: changes. In and out: pool height, crater tiles, sums. A lane takes kCraterLaneCells cells of a tile;
// records beyond kCraterEntriesAtOnce in a bucket have dispatches of their own. Twin: addCraters.
#version 450 core
#include "tick.glsl"

#define CRATER_BINDING kBindCraterTable
#include "crater_table.glsl"

layout(std430, binding = kBindCraterTiles) buffer CraterTiles { CraterTile crater_tiles[]; };
layout(std430, binding = kBindCraterChanges) writeonly buffer CraterChanges { int crater_changes[]; };
layout(std430, binding = kBindCraterSums) buffer CraterSums { CraterSum crater_sums[]; };
layout(std430, binding = kBindPoolHeight) buffer PoolHeight { int pool_height[]; };
layout(std430, binding = kBindPoolBedrock) readonly buffer PoolBedrock { int pool_bedrock[]; };
layout(location = 2) uniform int first_new;    // record
layout(location = 3) uniform int first_entry;  // of each bucket
layout(location = 4) uniform int is_last;      // 1: sums are complete after this dispatch

const int kGroupsPerTile = kTileCells / (kGroup * kCraterLaneCells);
shared uint gained[2];

/// The next entry, from i on, of a record that may reach (x, y). A loop of its own: llvmpipe runs what a condition
/// shuts out.
int nextEntry(int i, int end, int x, int y, uint tag) {
  for (; i < end; ++i) {
    if (crater_entries[i].tag != tag) continue;
    int record = crater_entries[i].record;
    if (max(abs(x - crater_shapes[record].x), abs(y - crater_shapes[record].y)) <= crater_shapes[record].outer) break;
  }
  return i;
}

/// @param index  of the cell among those of all tiles' boxes
/// @return       D(S) - D(S without new ones), where these sums are complete
int changeAt(int x, int y, int index) {
  CraterSum before = craterSumOfNone(), after = before;
  if (first_entry > 0) {
    before = crater_sums[2 * index];
    after = crater_sums[2 * index + 1];
  }
  CraterRange range = cratersAt(x, y);
  int first = range.first + first_entry, end = min(range.end, first + kCraterEntriesAtOnce);
  for (int i = nextEntry(first, end, x, y, range.tag); i < end; i = nextEntry(i + 1, end, x, y, range.tag)) {
    int record = crater_entries[i].record;
    CraterShape shape = crater_shapes[record];
    after = withCrater(after, craterDisplacement(shape, x - shape.x, y - shape.y), shape.rim);
    if (record < first_new) before = after;
  }
  if (is_last == 1) return craterTotal(after) - craterTotal(before);
  crater_sums[2 * index] = before;
  crater_sums[2 * index + 1] = after;
  return 0;
}

/// @return  what the cell gained, + 2^31; 0 where it is not in the box
uint changeCell(CraterTile tile, int cell_side, int cell) {
  ivec2 at = ivec2(cell % kTileSize, cell / kTileSize);
  if (at.x < tile.x0 || at.y < tile.y0 || at.x >= tile.x1 || at.y >= tile.y1) return 0u;  // the box is in the world
  int index = tile.first_change + (at.y - tile.y0) * (tile.x1 - tile.x0) + at.x - tile.x0;
  int change = changeAt((tile.tile_x0 + at.x) * cell_side + cell_side / 2,
                        (tile.tile_y0 + at.y) * cell_side + cell_side / 2, index);
  if (is_last == 0) return 0u;
  int height = pool_height[tile.slot * kTileCells + cell];
  int difference = change == 0 ? 0 : craterGround(height, pool_bedrock[tile.slot * kTileCells + cell], change) - height;
  crater_changes[index] = difference;
  if (difference != 0) pool_height[tile.slot * kTileCells + cell] = height + difference;
  return uint(difference) + 0x80000000u;
}

void main() {
  if (groupIndex() >= group_count) return;
  if (lane() < 2) gained[lane()] = 0u;
  barrier();
  int owner = groupIndex() / kGroupsPerTile;
  int first = groupIndex() % kGroupsPerTile * kGroup * kCraterLaneCells + lane();
  CraterTile tile = crater_tiles[owner];
  int cell_side = crater_head.cell;
  uvec2 lane_gained = uvec2(0u);
  for (int i = 0; i < kCraterLaneCells; ++i) {
    uint cell_gained = changeCell(tile, cell_side, first + i * kGroup);
    lane_gained += uvec2(cell_gained & 0xffffu, cell_gained >> 16);
  }
  atomicAdd(gained[0], lane_gained.x);
  atomicAdd(gained[1], lane_gained.y);
  barrier();
  if (lane() < 2) atomicAdd(crater_tiles[owner].gained[lane()], gained[lane()]);
}
