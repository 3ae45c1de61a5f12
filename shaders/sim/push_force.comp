// Stage relax, drift: spreads each body's push over the cells that it presses on. In: blocks, bodies, domains, height,
// underside, pushes. In and out: push planes, which are 0 before. A lane takes 32 cells of a column.
// Twin: drift.cpp, runPush.
#version 450 core
#include "push.glsl"

layout(std430, binding = kBindPushX) buffer PushX { int push_x[]; };
layout(std430, binding = kBindPushY) buffer PushY { int push_y[]; };
layout(location = 2) uniform int most;  // pushLimit

shared int along_x, along_y;

void main() {
  if (groupIndex() >= group_count) return;
  Block block = blocks[groupIndex()];
  if (lane() == 0) {
    Push push = pushes[block.owner];
    int strength = pushStrength(wide(push.force_low, push.force_high), push.contacts, most);
    along_x = pushAlong(strength, push.direction_x);
    along_y = pushAlong(strength, push.direction_y);
  }
  barrier();
  PushColumn own = pushColumn(block);
  for (int y = own.y; y < own.end_y; ++y) {
    int at = contactAt(own, y);
    if (at < 0) continue;
    atomicAdd(push_x[at], along_x);
    atomicAdd(push_y[at], along_y);
  }
}
