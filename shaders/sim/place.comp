// Stage depth: brings the meshes' vertices into their bodies' poses.
// In: bodies, vertices, blocks (owner: body; x: first vertex). Out: points. A lane takes a vertex. Twin: placeBody.
#version 450 core
#include "../rules/place.h"
#include "tick.glsl"

layout(std430, binding = kBindBlocks) readonly buffer Blocks { Block blocks[]; };
layout(std430, binding = kBindBodies) readonly buffer Bodies { BodyEntry bodies[]; };
layout(std430, binding = kBindVertices) readonly buffer Vertices { int vertices[]; };
layout(std430, binding = kBindPoints) writeonly buffer Points { int points[]; };

void main() {
  if (groupIndex() >= group_count) return;
  Block block = blocks[groupIndex()];
  int vertex = block.x + lane();
  if (vertex >= bodies[block.owner].vertex_count) return;
  Placement placement = Placement(bodies[block.owner].matrix, bodies[block.owner].within_x,
                                  bodies[block.owner].within_y, bodies[block.owner].cell);
  int from = 3 * (bodies[block.owner].first_vertex + vertex);
  RasterPoint point = placedPoint(placement, vertices[from], vertices[from + 1], vertices[from + 2]);
  int to = 3 * (bodies[block.owner].first_point + vertex);
  points[to] = point.x;
  points[to + 1] = point.y;
  points[to + 2] = point.z;
}
