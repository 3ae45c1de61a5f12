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
  int group_total = int(gl_NumWorkGroups.x * gl_NumWorkGroups.y);
  for (int group = groupIndex(); group / kLargeParts < lists[list].large.used; group += group_total) {
    Primitive p = primitiveAt(large[group / kLargeParts].x, large[group / kLargeParts].y);
    drawRows(p, p.first + group % kLargeParts * kGroup + lane(), p.end, kLargeParts * kGroup);
  }
}
