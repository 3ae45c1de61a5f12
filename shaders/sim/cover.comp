// Stage depth: takes away the undersides of tiles that bodies reach in this sub-step or reached in the one before, and
// closes the world's border; keeps what they were. In: blocks (owner: tile; x: slab). Out: underside, underside before.
// In and out: tile states.
// A group takes a slab. Twin: WorkArea::clearUnderside.
#version 450 core
#include "tick.glsl"

layout(std430, binding = kBindTiles) readonly buffer Tiles { TileEntry tiles[]; };
layout(std430, binding = kBindTileStates) buffer TileStates { TileState tile_states[]; };
layout(std430, binding = kBindUnderside) buffer Underside { int underside[]; };
layout(std430, binding = kBindUndersideBefore) writeonly buffer UndersideBefore { int underside_before[]; };
layout(std430, binding = kBindBlocks) readonly buffer Blocks { Block blocks[]; };
layout(location = 2) uniform int relax_step;  // of the relaxation, that comes next

void main() {
  if (groupIndex() >= group_count) return;
  Block block = blocks[groupIndex()];
  int inside_columns = tiles[block.owner].inside_columns;
  int inside_rows = tiles[block.owner].inside_rows;
  bool covered = tile_states[block.owner].ceiling[block.x] < kNoUnderside;
  for (int i = lane(); i < kSlabCells; i += kGroup) {
    int cell = block.x * kSlabCells + i;
    bool inside = cell % kTileSize < inside_columns && cell / kTileSize < inside_rows;
    int at = block.owner * kTileCells + cell;
    underside_before[at] = covered ? underside[at] : kNoUnderside;
    underside[at] = inside ? kNoUnderside : -kHeightLimit;
  }
  // Where a body was, room beneath it may have changed.
  if (lane() == 0 && covered) tile_states[block.owner].changed_at[block.x] = relax_step;
}
