// Bodies as the sun sees them: fills the shadow map's depth. In: mesh point [m].
#version 450 core
#include "frame.h"
#include "body.glsl"

layout(location = 0) in vec3 point_in;

void main() {
  vec4 place = frame.shadow_from_rel * rel_from_mesh * vec4(point_in, 1.0);
  gl_Position = vec4(place.xy * 2.0 - 1.0, place.z, 1.0);
}
