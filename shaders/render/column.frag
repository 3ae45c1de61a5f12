// Columns, fragment stage: flat colours, so that a top shows its height's colour as it is; sides darker, edges marked.
// Out: colour; alpha 1.
#version 450 core
#include "frame.h"

in vec3 on_face;
flat in vec3 colour;
flat in vec3 normal;
layout(location = 0) out vec4 colour_out;

const float kEdge = 0.05;  // width of an edge's line, in cells

void main() {
  float side = normal.z > 0.0 ? 1.0 : (normal.x != 0.0 ? 0.56 : 0.76);  // so that corners show
  vec2 inside = min(on_face.xy, vec2(1.0, on_face.z) - on_face.xy);
  // Feet have no edge; nor has anything whose lines would be finer than a pixel.
  float away = normal.z > 0.0 ? min(inside.x, inside.y) : min(inside.x, on_face.z - on_face.y);
  float pixel = max(max(fwidth(on_face.x), fwidth(on_face.y)), 1.0e-6);
  float line = (1.0 - smoothstep(kEdge, kEdge + pixel, away)) * (1.0 - smoothstep(0.12, 0.4, pixel));
  colour_out = vec4(colour * side * (1.0 - 0.45 * line), 1.0);
}
