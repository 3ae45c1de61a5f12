// Stage depth: the lowest underside of every slab that was covered anew.
// In: blocks (owner: tile; x: slab), underside. Out: tile states. A group takes a slab. Twin: runDepth's last loop.
#version 450 core
#include "tick.glsl"

layout(std430, binding = kBindTileStates) writeonly buffer TileStates { TileState tile_states[]; };
layout(std430, binding = kBindUnderside) readonly buffer Underside { int underside[]; };
layout(std430, binding = kBindBlocks) readonly buffer Blocks { Block blocks[]; };
layout(location = 2) uniform int relax_step;  // of the relaxation, that comes next

shared int lowest;

void main() {
  if (groupIndex() >= group_count) return;
  if (lane() == 0) lowest = kNoUnderside;
  barrier();
  Block block = blocks[groupIndex()];
  int lane_lowest = kNoUnderside;
  for (int i = lane(); i < kSlabCells; i += kGroup)
    lane_lowest = min(lane_lowest, underside[block.owner * kTileCells + block.x * kSlabCells + i]);
  if (lane_lowest < kNoUnderside) atomicMin(lowest, lane_lowest);
  barrier();
  if (lane() != 0) return;
  tile_states[block.owner].ceiling[block.x] = lowest;
  if (lowest < kNoUnderside) tile_states[block.owner].changed_at[block.x] = relax_step;
}
