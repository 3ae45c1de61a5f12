#include "client/camera.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "shaders/rules/limits.h"
#include "shared/base/assert.h"

namespace spoor {

namespace {

constexpr float kNear_m = 0.1f;
constexpr double kOrthographicDepth_m = 8000.0;  // how far beyond the eye an orthographic view reaches
constexpr double kEyeLimit_m = 1.0e5;            // |z| of the eye, so that the origin's height fits its integer

/// Perspective without a far plane: 32-bit float depth that runs from 1 at the near plane to 0 at infinity.
glm::mat4 endlessPerspective(double field_of_view_rad, double aspect) {
  const float f = float(1.0 / std::tan(field_of_view_rad / 2.0));
  glm::mat4 m(0.0f);
  m[0][0] = f / float(aspect);
  m[1][1] = f;
  m[2][3] = -1.0f;
  m[3][2] = kNear_m;
  return m;
}

glm::mat4 orthographic(double height_m, double aspect) {
  const double depth_m = kOrthographicDepth_m;
  glm::mat4 m(1.0f);
  m[0][0] = float(2.0 / (height_m * aspect));
  m[1][1] = float(2.0 / height_m);
  m[2][2] = float(1.0 / depth_m);  // view z runs from 0 to -depth
  m[3][2] = 1.0f;
  return m;
}

}  // namespace

Camera cameraLookingAt(const glm::dvec3& eye_m, const glm::dvec3& target_m) {
  Camera camera;
  camera.eye_m = eye_m;
  camera.forward = glm::normalize(target_m - eye_m);
  if (std::abs(camera.forward.z) > 0.999) camera.up = {0.0, 1.0, 0.0};
  camera.focus_m = {target_m.x, target_m.y};
  return camera;
}

CameraFrame frameOf(const Camera& camera, double cell_m, int width_px, int height_px) {
  SPOOR_ASSERT(width_px > 0 && height_px > 0 && cell_m > 0.0);
  CameraFrame frame;
  frame.orthographic = camera.orthographic_height_m > 0.0;
  frame.origin_cell = glm::ivec2(std::floor(camera.eye_m.x / cell_m), std::floor(camera.eye_m.y / cell_m));
  const double height_m = std::clamp(camera.eye_m.z, -kEyeLimit_m, kEyeLimit_m);
  frame.origin_height_q = std::int32_t(std::llround(height_m * rules::kUnitsPerMetre));
  frame.origin_m = {(frame.origin_cell.x + 0.5) * cell_m, (frame.origin_cell.y + 0.5) * cell_m,
                    double(frame.origin_height_q) / rules::kUnitsPerMetre};
  const glm::dvec3 eye_rel = camera.eye_m - frame.origin_m;
  frame.eye_rel = glm::vec3(eye_rel);

  const double aspect = double(width_px) / height_px;
  const double view_rad = glm::radians(camera.field_of_view_deg);
  const glm::mat4 view(glm::lookAt(eye_rel, eye_rel + camera.forward, camera.up));
  frame.clip_from_rel =
      (frame.orthographic ? orthographic(camera.orthographic_height_m, aspect) : endlessPerspective(view_rad, aspect)) *
      view;
  const glm::dvec3 right = glm::normalize(glm::cross(camera.forward, camera.up));
  const double half_height = frame.orthographic ? camera.orthographic_height_m / 2.0 : std::tan(view_rad / 2.0);
  frame.ray_forward = glm::vec3(camera.forward);
  frame.ray_right = glm::vec3(right * half_height * aspect);
  frame.ray_up = glm::vec3(glm::cross(right, camera.forward) * half_height);
  frame.depth_range_m = frame.orthographic ? float(kOrthographicDepth_m) : kNear_m;
  frame.pixels_per_radian =
      frame.orthographic ? float(height_px / camera.orthographic_height_m) : float(height_px / (2.0 * half_height));
  return frame;
}

}  // namespace spoor
