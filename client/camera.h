#pragma once

#include <cstdint>
#include <glm/glm.hpp>

namespace spoor {

/// Where a picture is taken from. World axes: x east, y north, z up; metres from the south-west corner.
struct Camera {
  glm::dvec3 eye_m{0.0};
  glm::dvec3 forward{0.0, 1.0, 0.0};   // unit length
  glm::dvec3 up{0.0, 0.0, 1.0};        // not parallel to forward
  double field_of_view_deg = 55.0;     // vertical; perspective only
  double orthographic_height_m = 0.0;  // > 0: orthographic, and what the picture's height shows
  glm::dvec2 focus_m{0.0};             // the ground is finest around here
};

/// A camera at `eye_m` that looks at `target_m`. The focus is the target.
Camera cameraLookingAt(const glm::dvec3& eye_m, const glm::dvec3& target_m);

/// A camera as the graphics card gets it: everything relative to an origin cell near the eye, so that worlds of any
/// size keep their precision. Differences to the origin are taken in integers or doubles.
struct CameraFrame {
  glm::ivec2 origin_cell{0};
  std::int32_t origin_height_q = 0;                            // 0.1 mm
  glm::dvec3 origin_m{0.0};                                    // centre of the origin cell at the origin height
  glm::vec3 eye_rel{0.0f};                                     // [m]
  glm::mat4 clip_from_rel{1.0f};                               // depth 1 near, 0 far
  glm::vec3 ray_forward{0.0f}, ray_right{0.0f}, ray_up{0.0f};  // see Frame in shaders/render/frame.h
  float depth_range_m = 1.0f;
  float pixels_per_radian = 1.0f;  // orthographic: pixels per metre
  bool orthographic = false;
};

CameraFrame frameOf(const Camera& camera, double cell_m, int width_px, int height_px);

}  // namespace spoor
