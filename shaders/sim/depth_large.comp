// Stage depth: lowers the undersides beneath large primitives.
// In: bodies, points, indices, large (body, primitive). Out: underside. kLargeParts groups take a primitive.
// A lane takes a row (of an edge along x: a column). Twin: depth.cpp.
#version 450 core
#include "../rules/raster.h"
#include "domains.glsl"
#include "primitives.glsl"
#include "tick.glsl"

layout(std430, binding = kBindLarge) readonly buffer Large { ivec2 large[]; };

void main() {
  int entry = groupIndex() / kLargeParts;
  if (entry >= tick.lists[sub_step].large.used) return;
  Primitive p = primitiveAt(large[entry].x, large[entry].y);
  drawRows(p, p.first + groupIndex() % kLargeParts * kGroup + lane(), p.end, kLargeParts * kGroup);
}
