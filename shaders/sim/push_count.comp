// Stage relax, drift: on how many cells each body that pushes presses. In: blocks, bodies, domains, height, underside.
// Out: pushes. A lane takes 32 cells of a column. Twin: drift.cpp, runPush.
#version 450 core
#include "push.glsl"

shared int contacts;

void main() {
  if (groupIndex() >= group_count) return;
  if (lane() == 0) contacts = 0;
  barrier();
  Block block = blocks[groupIndex()];
  PushColumn own = pushColumn(block);
  int found = 0;
  for (int y = own.y; y < own.end_y; ++y) found += contactAt(own, y) >= 0 ? 1 : 0;
  if (found > 0) atomicAdd(contacts, found);
  barrier();
  if (lane() == 0 && contacts > 0) atomicAdd(pushes[block.owner].contacts, contacts);
}
