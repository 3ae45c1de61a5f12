// Stage depth: takes away the undersides of tiles that bodies reach in this sub-step or reached in the one before, and
// closes the world's border. In: blocks (owner: tile; x: is it covered now?; y: quarter). Out: underside, tile states.
// A group takes a quarter of a tile. Twin: WorkArea::clearUnderside.
#version 450 core
#include "tick.glsl"

layout(std430, binding = kBindTiles) readonly buffer Tiles { TileEntry tiles[]; };
layout(std430, binding = kBindTileStates) writeonly buffer TileStates { TileState tile_states[]; };
layout(std430, binding = kBindUnderside) writeonly buffer Underside { int underside[]; };
layout(std430, binding = kBindBlocks) readonly buffer Blocks { Block blocks[]; };
layout(location = 2) uniform int step;  // of the relaxation, that comes next

const int kQuarter = kTileCells / 4;

void main() {
  if (groupIndex() >= group_count) return;
  Block block = blocks[groupIndex()];
  int tile = block.owner;
  bool border = tiles[tile].inside_columns < kTileSize || tiles[tile].inside_rows < kTileSize;
  for (int i = lane(); i < kQuarter; i += kGroup) {
    int cell = block.y * kQuarter + i;
    bool inside = cell % kTileSize < tiles[tile].inside_columns && cell / kTileSize < tiles[tile].inside_rows;
    underside[tile * kTileCells + cell] = inside ? kNoUnderside : -kHeightLimit;
  }
  if (block.y != 0) return;
  if (lane() == 0) tile_states[tile].covered = block.x != 0 || border ? 1 : 0;
  // Where a body was or is, room beneath it may have changed.
  if (lane() < kSlabs) tile_states[tile].changed_at[lane()] = step;
}
