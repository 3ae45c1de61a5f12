// Bodies, vertex stage. In: mesh point [m] and normal. Out: place from the frame's origin, normal.
#version 450 core
#include "frame.h"
#include "body.glsl"

layout(location = 0) in vec3 point_in;
layout(location = 1) in vec3 normal_in;
out vec3 rel;
out vec3 normal;

void main() {
  rel = (rel_from_mesh * vec4(point_in, 1.0)).xyz;
  normal = mat3(rel_from_mesh) * normal_in;
  gl_Position = frame.clip_from_rel * vec4(rel, 1.0);
}
