// Stage relax: a whole sweep, all eight matchings, in one dispatch. A group takes 32 x 32 cells with a halo of 6: each
// matching that goes a cell along x or y, six of the eight, spoils one more ring of the halo.
// In: tiles, height, bedrock, underside, materials. Out: next height, tile states. Twin: relax.cpp.
#version 450 core
#include "../rules/exchange.h"
#include "materials.glsl"
#include "tick.glsl"

layout(std430, binding = kBindTiles) readonly buffer Tiles { TileEntry tiles[]; };
layout(std430, binding = kBindTileStates) buffer TileStates { TileState tile_states[]; };
layout(std430, binding = kBindHeight) readonly buffer Height { int height[]; };
layout(std430, binding = kBindBedrock) readonly buffer Bedrock { int bedrock[]; };
layout(std430, binding = kBindUnderside) readonly buffer Underside { int underside[]; };
layout(std430, binding = kBindNextHeight) writeonly buffer NextHeight { int next_height[]; };
layout(location = 2) uniform int relax_step;    // the sweep's first
layout(location = 3) uniform int skip_settled;  // 0: visit every pair

const int kBlock = kTileSize / kBlocksPerSide;
const int kHalo = 6;
const int kSide = kBlock + 2 * kHalo;
shared bool skip;
shared int cells[kSide * kSide];
shared int floors[kSide * kSide];
shared int ceilings[kSide * kSide];
#if SPOOR_MIXED
shared int kinds[kSide * kSide];  // materials

int kindOf(int i) { return kinds[i]; }
#else
int kindOf(int i) { return 0; }
#endif

/// Has anything near the block changed in this sweep's two predecessors? If not, both height planes hold the result.
bool settled(int tile, ivec2 block) {
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      if (dx == (block.x == 0 ? 1 : -1) || dy == (block.y == 0 ? 1 : -1)) continue;
      int near = tiles[tile].neighbour[(dy + 1) * 3 + dx + 1];
      if (near < 0) continue;
      int first = dy < 0 ? kSlabs - 1 : dy > 0 ? 0 : max(block.y * kBlock / kSlabRows - 1, 0);
      int last = dy < 0 ? kSlabs - 1 : dy > 0 ? 0 : min((block.y + 1) * kBlock / kSlabRows, kSlabs - 1);
      for (int slab = first; slab <= last; ++slab)
        if (tile_states[near].changed_at[slab] >= relax_step - (2 * kMatchingCount - 1)) return false;
    }
  return true;
}

/// Cells outside active tiles hold no soil and take none.
void load(int tile, ivec2 block) {
  for (int i = lane(); i < kSide * kSide; i += kGroup) {
    int x = block.x * kBlock - kHalo + i % kSide + kTileSize;  // in the 3 x 3 tiles around
    int y = block.y * kBlock - kHalo + i / kSide + kTileSize;
    int near = tiles[tile].neighbour[y / kTileSize * 3 + x / kTileSize];
    int at = max(near, 0) * kTileCells + y % kTileSize * kTileSize + x % kTileSize;
    cells[i] = near < 0 ? 0 : height[at];
    floors[i] = near < 0 ? 0 : bedrock[at];
#if SPOOR_MIXED
    kinds[i] = materialOf(at);
#endif
    bool filled = near >= 0 && tile_states[near].ceiling[y % kTileSize / kSlabRows] < kNoUnderside;
    ceilings[i] = near < 0 ? -kHeightLimit : filled ? underside[at] : kNoUnderside;
  }
}

int thresholdOf(int i, bool diagonal) {
  return diagonal ? materials[kindOf(i)].diagonal_threshold : materials[kindOf(i)].slope_threshold;
}

void exchange(int a, int b, bool diagonal) {
  int flow = pairFlow(cells[a], cells[b], thresholdOf(a, diagonal), thresholdOf(b, diagonal), cells[a] - floors[a],
                      cells[b] - floors[b], roomBeneath(cells[a], ceilings[a], tick.obstacle_threshold),
                      roomBeneath(cells[b], ceilings[b], tick.obstacle_threshold));
  cells[a] -= flow;
  cells[b] += flow;
}

/// The block begins at even coordinates, so parities here are those of the world.
void runMatching(int matching) {
  int parity = matching & 1;
  if (matching < kMatchVertical) {
    for (int i = lane(); i < kSide * kSide / 2; i += kGroup) {
      int x = i % (kSide / 2) * 2 + parity;
      int a = i / (kSide / 2) * kSide + x;
      if (x + 1 < kSide) exchange(a, a + 1, false);
    }
    return;
  }
  int shift = matching < kMatchDiagonal ? 0 : matching < kMatchAntidiagonal ? 1 : -1;
  for (int i = lane(); i < kSide * kSide / 2; i += kGroup) {
    int x = i % kSide;
    int y = i / kSide * 2 + parity;
    if (y + 1 < kSide && x + shift >= 0 && x + shift < kSide)
      exchange(y * kSide + x, (y + 1) * kSide + x + shift, shift != 0);
  }
}

void main() {
  int tile = groupIndex() / (kBlocksPerSide * kBlocksPerSide);
  if (tile >= tick.tile_count) return;
  ivec2 block = ivec2(groupIndex() % kBlocksPerSide, groupIndex() / kBlocksPerSide % kBlocksPerSide);
  // One verdict for all lanes: a neighbouring group may change what it is taken from meanwhile.
  if (lane() == 0) skip = skip_settled != 0 && settled(tile, block);
  barrier();
  if (skip) return;
  load(tile, block);
  barrier();
  for (int matching = 0; matching < kMatchingCount; ++matching) {
    runMatching(matching);
    barrier();
  }
  if (lane() == 0) atomicAdd(tick.slabs_visited, kMatchingCount * kBlock / kSlabRows / 2);
  for (int i = lane(); i < kBlock * kBlock; i += kGroup) {
    int x = i % kBlock;
    int y = i / kBlock;
    int at = tile * kTileCells + (block.y * kBlock + y) * kTileSize + block.x * kBlock + x;
    int after = cells[(y + kHalo) * kSide + x + kHalo];
    next_height[at] = after;
    if (after != height[at])
      tile_states[tile].changed_at[(block.y * kBlock + y) / kSlabRows] = relax_step + kMatchingCount - 1;
  }
}
