// Bodies, fragment stage: paint under sun and sky. Out: colour; alpha 1.
#version 450 core
#include "frame.h"
#include "light.glsl"
#include "body_shadow.glsl"
#include "body.glsl"

in vec3 rel;
in vec3 normal;
layout(location = 0) out vec4 colour_out;

void main() {
  vec3 n = normalize(gl_FrontFacing ? normal : -normal);
  if (frame.world.w == kShadeNormals) {
    colour_out = vec4(n * 0.5 + 0.5, 1.0);
    return;
  }
  vec3 to_eye = frame.eye.w > 0.0 ? vec3(0.0, 0.0, 1.0) : normalize(frame.eye.xyz - rel);
  float facing = max(dot(n, frame.sun.xyz), 0.0);
  float sun = facing > 0.0 ? bodyShadow(rel, n, 0.02) : 0.0;
  float shine = pow(max(dot(n, normalize(to_eye + frame.sun.xyz)), 0.0), 48.0) * body_colour.w;
  float rim = pow(1.0 - max(dot(n, to_eye), 0.0), 5.0) * body_colour.w * 0.35;
  vec3 colour = body_colour.rgb * (kSunLight * facing * sun + skyLight(n, vec3(0.7)) * 0.9);
  colour += kSunLight * shine * sun + skyColour(reflect(-to_eye, n)) * rim;
  colour_out = vec4(toScreen(withFog(colour, rel)), 1.0);
}
