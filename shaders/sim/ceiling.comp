// Stage depth: takes away undersides that are too high to be seen, and finds the lowest of every slab that was covered
// anew. In: blocks (owner: tile; x: slab), bedrock. Out: tile states. In and out: underside. A group takes a slab.
// Twin: runDepth's last loop.
#version 450 core
#include "../rules/penetration.h"
#include "tick.glsl"

layout(std430, binding = kBindTileStates) writeonly buffer TileStates { TileState tile_states[]; };
layout(std430, binding = kBindBedrock) readonly buffer Bedrock { int bedrock[]; };
layout(std430, binding = kBindUnderside) buffer Underside { int underside[]; };
layout(std430, binding = kBindBlocks) readonly buffer Blocks { Block blocks[]; };
layout(location = 2) uniform int relax_step;  // of the relaxation, that comes next
layout(location = 3) uniform int frustum_height;

shared int lowest;

void main() {
  if (groupIndex() >= group_count) return;
  if (lane() == 0) lowest = kNoUnderside;
  barrier();
  Block block = blocks[groupIndex()];
  int lane_lowest = kNoUnderside;
  for (int i = lane(); i < kSlabCells; i += kGroup) {
    int at = block.owner * kTileCells + block.x * kSlabCells + i;
    int drawn = underside[at];
    int seen = drawn;
    if (frustum_height > 0) seen = seenUnderside(drawn, bedrock[at], frustum_height);
    if (seen != drawn) underside[at] = seen;
    lane_lowest = min(lane_lowest, seen);
  }
  if (lane_lowest < kNoUnderside) atomicMin(lowest, lane_lowest);
  barrier();
  if (lane() != 0) return;
  tile_states[block.owner].ceiling[block.x] = lowest;
  if (lowest < kNoUnderside) tile_states[block.owner].changed_at[block.x] = relax_step;
}
