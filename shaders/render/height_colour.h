// The colours of heights, for C++ and GLSL: blue below, pale in the middle, red above.
#ifndef SPOOR_RENDER_HEIGHT_COLOUR_H
#define SPOOR_RENDER_HEIGHT_COLOUR_H

#ifdef __cplusplus
#include <glm/glm.hpp>
#define RENDER_FUNCTION inline
namespace spoor::render {
using glm::clamp;
using glm::mix;
using glm::vec3;
#else
#define RENDER_FUNCTION
#endif

/// sRGB of a height that lies at `part` between the lowest (0) and the highest (1); beyond them theirs.
RENDER_FUNCTION vec3 heightColour(float part) {
  float at = clamp(part, 0.0f, 1.0f) * 4.0f;
  vec3 deep = vec3(0.13f, 0.17f, 0.52f), low = vec3(0.16f, 0.58f, 0.76f), middle = vec3(0.93f, 0.92f, 0.84f);
  vec3 high = vec3(0.96f, 0.62f, 0.16f), top = vec3(0.60f, 0.05f, 0.10f);
  if (at < 1.0f) return mix(deep, low, at);
  if (at < 2.0f) return mix(low, middle, at - 1.0f);
  if (at < 3.0f) return mix(middle, high, at - 2.0f);
  return mix(high, top, at - 3.0f);
}

#ifdef __cplusplus
}  // namespace spoor::render
#endif
#endif
