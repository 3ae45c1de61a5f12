// Columns, vertex stage: a cell as a bar from the feet to its height; the top and four sides, no bottom.
// In: an instance a cell of one row of the area, its height [0.1 mm]. Out: place on the face, colour, normal.
#version 450 core
#include "frame.h"
#include "height_colour.h"
#include "../rules/limits.h"

layout(std140, binding = kColumnAreaBinding) uniform ColumnAreaBlock { ColumnArea columns; };
layout(location = 0) in int height_in;
layout(location = 0) uniform int row;
out vec3 on_face;  // along the face, up the face, height of the face over its width
flat out vec3 colour;
flat out vec3 normal;

const int kCorner[6] = int[6](0, 1, 2, 0, 2, 3);

float aboveOrigin(int height_q) { return float(height_q - frame.origin.z) / float(kUnitsPerMetre); }

void main() {
  int face = gl_VertexID / 6;  // 0: top; then east, north, west, south
  int corner = kCorner[gl_VertexID % 6];
  vec2 place = vec2(corner == 1 || corner == 2, corner >= 2);
  float cell_m = frame.scale.x;
  vec2 middle = vec2(columns.area.xy + ivec2(gl_InstanceID, row)) * cell_m;
  float foot = aboveOrigin(columns.heights.w), head = aboveOrigin(height_in);
  vec2 ahead = face == 0 ? vec2(1.0, 0.0) : vec2((face & 1) == 1 ? 2 - face : 0, (face & 1) == 0 ? 3 - face : 0);
  vec3 rel;
  if (face == 0) {
    rel = vec3(middle + (place - 0.5) * cell_m, head);
  } else {
    vec2 along = vec2(-ahead.y, ahead.x);
    rel = vec3(middle + (0.5 * ahead + (place.x - 0.5) * along) * cell_m, mix(foot, head, place.y));
  }
  float tall = face == 0 ? 1.0 : max(head - foot, 0.0) / cell_m;
  on_face = vec3(place * vec2(1.0, tall), tall);
  normal = face == 0 ? vec3(0.0, 0.0, 1.0) : vec3(ahead, 0.0);
  bool low = height_in < columns.heights.y;
  int range = low ? columns.heights.y - columns.heights.x : columns.heights.z - columns.heights.y;
  colour = heightColour(0.5 + 0.5 * float(height_in - columns.heights.y) / float(max(range, 1)));
  gl_Position = frame.clip_from_rel * vec4(rel, 1.0);
}
