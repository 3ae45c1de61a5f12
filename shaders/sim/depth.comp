// Stage depth: lowers the undersides beneath small primitives, and puts large ones on a list.
// In: bodies, points, indices, blocks (owner: body; x: first primitive). Out: underside, large, lists.
// A lane takes a primitive. Twin: depth.cpp.
#version 450 core
#include "../rules/raster.h"
#include "domains.glsl"
#include "primitives.glsl"
#include "tick.glsl"

layout(std430, binding = kBindBlocks) readonly buffer Blocks { Block blocks[]; };
layout(std430, binding = kBindLarge) writeonly buffer Large { ivec2 large[]; };

const int kRowsOfSmall = 8;  // more rows than this keep a lane's neighbours waiting

void main() {
  if (groupIndex() >= group_count) return;
  Block block = blocks[groupIndex()];
  int primitive = block.x + lane();
  if (primitive >= bodies[block.owner].triangle_count + bodies[block.owner].edge_count) return;
  Primitive p = primitiveAt(block.owner, primitive);
  if (p.end - p.first <= kRowsOfSmall) {
    drawRows(p, p.first, p.end, 1);
    return;
  }
  int entry = atomicAdd(lists[list].large.used, 1);
  int rows = (entry + kDispatchColumns / kLargeParts) / (kDispatchColumns / kLargeParts);
  atomicMax(lists[list].large.y, min(rows, kDispatchRowsMost));  // beyond that a group takes several
  large[entry] = ivec2(block.owner, primitive);
}
