// Stage relax, drift: from what bodies push with to how far that moves the soil. In: blocks (owner: tile; x: slab),
// materials. In and out: push planes. A group takes a slab. Twin: drift.cpp, runPush.
#version 450 core
#include "../rules/drift.h"
#include "materials.glsl"
#include "tick.glsl"

layout(std430, binding = kBindBlocks) readonly buffer Blocks { Block blocks[]; };
layout(std430, binding = kBindPushX) buffer PushX { int push_x[]; };
layout(std430, binding = kBindPushY) buffer PushY { int push_y[]; };

void main() {
  if (groupIndex() >= group_count) return;
  Block block = blocks[groupIndex()];
  for (int i = lane(); i < kSlabCells; i += kGroup) {
    int at = block.owner * kTileCells + block.x * kSlabCells + i;
    ivec2 strength = ivec2(push_x[at], push_y[at]);
    if (strength == ivec2(0)) continue;
    int friction_inverse = materials[materialOf(at)].friction_inverse;
    push_x[at] = pushedSoil(strength.x, friction_inverse);
    push_y[at] = pushedSoil(strength.y, friction_inverse);
  }
}
