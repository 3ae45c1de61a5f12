// Terrain, tessellation control: how finely each edge of a patch is cut.
// An edge's level depends on the edge alone, so both its patches agree; levels are powers of two, so every vertex lies
// on a cell's centre. Edges between two windows have fixed levels whose vertices coincide.
#version 450 core
#include "surface.glsl"

layout(vertices = 1) out;
in ivec4 patch_vertex[];
out ivec4 patch_control[];

float edgeLevel(int level, ivec2 from, ivec2 to, int highest, float triangle_px) {
  ivec2 middle = (from + to) >> 1;
  vec3 point = surfacePoint(level, middle);
  float length_m = float(abs(to.x - from.x) + abs(to.y - from.y)) * frame.scale.x;
  float away_m = frame.eye.w > 0.0 ? 1.0 : max(distance(point, frame.eye.xyz), 0.01);
  float wanted = length_m * frame.scale.y / (away_m * triangle_px);
  if (frame.stones.z > 0.0) wanted = frame.stones.z;
  return clamp(exp2(ceil(log2(max(wanted, 1.0)))), 1.0, float(highest));
}

void main() {
  ivec4 piece = patch_vertex[0];
  int level = piece.z;
  bool stones = (piece.w & kStonePatch) != 0;
  int side = stones ? kStonePatchSamples : patchCells(level);
  int highest = level != 0 ? kCoarsePatchSamples : (stones ? side * kStoneCuts : side);
  float triangle_px = stones ? frame.stones.y : frame.scale.z;
  ivec2 corners[5] = ivec2[5](piece.xy + ivec2(0, side), piece.xy, piece.xy + ivec2(side, 0),
                              piece.xy + ivec2(side, side), piece.xy + ivec2(0, side));
  float edges[4];
  for (int edge = 0; edge < 4; ++edge) {
    edges[edge] = edgeLevel(level, corners[edge], corners[edge + 1], highest, triangle_px);
    if ((piece.w & (kRimEdges << edge)) != 0) edges[edge] = float(highest >> kLevelShift);
    if ((piece.w & (kHoleEdges << edge)) != 0) edges[edge] = float(highest);
    if ((piece.w & (kCellEdges << edge)) != 0) edges[edge] = float(side);
    gl_TessLevelOuter[edge] = edges[edge];
  }
  gl_TessLevelInner[0] = max(edges[1], edges[3]);
  gl_TessLevelInner[1] = max(edges[0], edges[2]);
  patch_control[gl_InvocationID] = piece;
}
