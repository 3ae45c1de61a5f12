// Terrain, tessellation evaluation: lifts each vertex to the surface.
#version 450 core
#include "surface.glsl"

layout(quads, equal_spacing, ccw) in;
in ivec4 patch_control[];
invariant gl_Position;

void main() {
  ivec4 piece = patch_control[0];
  ivec2 cell = piece.xy + ivec2(round(gl_TessCoord.xy * float(patchCells(piece.z))));
  vec3 rel = surfacePoint(piece.z, cell);
  gl_Position = frame.clip_from_rel * vec4(rel, 1.0);
}
