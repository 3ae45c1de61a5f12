// Sun, sky, fog and tone mapping: the same for ground, bodies and sky. Colours are linear until toScreen.
#include "frame.h"

const vec3 kSunLight = vec3(1.0, 0.86, 0.68) * 4.2;
const vec3 kZenith = vec3(0.24, 0.52, 1.10);
const vec3 kHorizon = vec3(1.10, 1.24, 1.42);

vec3 skyColour(vec3 direction) {
  float up = max(direction.z, 0.0);
  vec3 sky = mix(kHorizon, kZenith, 1.0 - exp(-3.2 * up));
  float towards_sun = max(dot(direction, frame.sun.xyz), 0.0);
  sky += vec3(1.0, 0.72, 0.42) * (0.28 * pow(towards_sun, 6.0) + 0.5 * pow(towards_sun, 90.0)) * exp(-2.0 * up);
  return sky;
}

vec3 skyWithSun(vec3 direction) {
  return skyColour(direction) + smoothstep(0.99990, 0.99996, dot(direction, frame.sun.xyz)) * kSunLight * 4.0;
}

/// Light from the sky and from lit ground that reaches a surface facing `normal`.
vec3 skyLight(vec3 normal, vec3 ground_albedo) {
  float up = 0.5 + 0.5 * normal.z;
  vec3 from_ground = ground_albedo * (kSunLight * frame.sun.z + kZenith) * 0.25;
  return mix(from_ground, vec3(0.44, 0.60, 0.96) * 0.92, up);
}

vec3 withFog(vec3 colour, vec3 rel) {
  if (frame.eye.w > 0.0) return colour;
  vec3 ray = rel - frame.eye.xyz;
  float away_m = length(ray);
  vec3 flat_ray = normalize(vec3(ray.xy, max(ray.z, 0.02 * away_m)) + vec3(0.0, 0.0, 1.0e-6));
  float clear = exp(-pow(away_m * frame.scale.w, 1.3));
  return mix(skyColour(flat_ray), colour, clear);
}

/// Tone curve (Narkowicz 2015, a fit of the ACES film curve) and the sRGB transfer.
vec3 toScreen(vec3 colour) {
  vec3 c = colour * 0.38;
  c = clamp(c * (2.51 * c + 0.03) / (c * (2.43 * c + 0.59) + 0.14), 0.0, 1.0);
  return mix(c * 12.92, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c));
}
