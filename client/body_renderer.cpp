#include "client/body_renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>

#include "client/mesh_surface.h"
#include "shaders/host/shader_loader.h"
#include "shaders/render/frame.h"
#include "shaders/rules/limits.h"

namespace spoor {

namespace {

constexpr double kCrease_deg = 40.0;
constexpr int kShadowSide_px = 2048;
constexpr double kShadowReach_m = 60.0;

glm::dvec3 positionOf(const Pose& pose) {
  return glm::dvec3(pose.x_q, pose.y_q, pose.z_q) / double(rules::kUnitsPerMetre);
}

glm::mat4 placeOf(const Pose& pose, const CameraFrame& frame) {
  const Rotation rotation = rotationOf(pose);
  const glm::vec3 position(positionOf(pose) - frame.origin_m);
  glm::mat4 m(1.0f);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      m[column][row] = float(double(rotation.m_q30[std::size_t(row * 3 + column)]) / (1 << 30));
  m[3] = glm::vec4(position, 1.0f);
  return m;
}

/// Rubber for what rolls or walks, and one paint for all other bodies on the same path.
glm::vec4 paintOf(const Body& body) {
  static constexpr std::array<glm::vec4, 6> kPaints{
      glm::vec4(0.62f, 0.06f, 0.05f, 0.7f), glm::vec4(0.05f, 0.20f, 0.48f, 0.7f), glm::vec4(0.75f, 0.42f, 0.03f, 0.7f),
      glm::vec4(0.06f, 0.32f, 0.16f, 0.7f), glm::vec4(0.45f, 0.45f, 0.48f, 0.7f), glm::vec4(0.30f, 0.08f, 0.36f, 0.7f)};
  if (body.roll_radius_q > 0) return {0.035f, 0.035f, 0.04f, 0.12f};
  if (body.stride_q > 0) return {0.16f, 0.10f, 0.06f, 0.2f};
  return kPaints[std::size_t(body.path_index) % kPaints.size()];
}

}  // namespace

BodyRenderer::BodyRenderer(const ScenePack& pack) : pack_(&pack) {
  std::vector<SurfacePoint> points;
  for (const Mesh& mesh : pack.meshes) {
    const auto surface = surfaceOf(mesh, kCrease_deg);
    Piece piece{GLint(points.size()), GLsizei(surface.size()), 0.0};
    for (const SurfacePoint& p : surface) piece.radius_m = std::max(piece.radius_m, double(glm::length(p.point_m)));
    pieces_.push_back(piece);
    points.insert(points.end(), surface.begin(), surface.end());
  }
  for (const Body& body : pack.bodies) paint_.push_back(paintOf(body));

  points_ = makeBuffer();
  if (!points.empty())
    glNamedBufferStorage(points_.name(), GLsizeiptr(points.size() * sizeof(SurfacePoint)), points.data(), 0);
  layout_ = makeVertexArray();
  glVertexArrayVertexBuffer(layout_.name(), 0, points_.name(), 0, sizeof(SurfacePoint));
  for (GLuint attribute = 0; attribute < 2; ++attribute) {
    glEnableVertexArrayAttrib(layout_.name(), attribute);
    glVertexArrayAttribFormat(layout_.name(), attribute, 3, GL_FLOAT, GL_FALSE, GLuint(attribute * sizeof(glm::vec3)));
    glVertexArrayAttribBinding(layout_.name(), attribute, 0);
  }
  program_ = makeProgram({"render/body.vert", "render/body.frag"});
  depth_program_ = makeProgram({"render/body_depth.vert", "render/body_depth.frag"});

  shadow_map_ = makeTexture(GL_TEXTURE_2D);
  glTextureStorage2D(shadow_map_.name(), 1, GL_DEPTH_COMPONENT32F, kShadowSide_px, kShadowSide_px);
  glTextureParameteri(shadow_map_.name(), GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTextureParameteri(shadow_map_.name(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTextureParameteri(shadow_map_.name(), GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTextureParameteri(shadow_map_.name(), GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  glTextureParameteri(shadow_map_.name(), GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  glTextureParameteri(shadow_map_.name(), GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
  shadow_target_ = makeFramebuffer();
  glNamedFramebufferTexture(shadow_target_.name(), GL_DEPTH_ATTACHMENT, shadow_map_.name(), 0);
  glNamedFramebufferDrawBuffer(shadow_target_.name(), GL_NONE);
}

glm::mat4 BodyRenderer::shadowMatrix(std::span<const Pose> poses, const CameraFrame& frame, const Camera& camera,
                                     const glm::dvec3& sun, float& texel_m) const {
  texel_m = 0.01f;
  glm::mat4 nowhere(0.0f);
  nowhere[3] = glm::vec4(2.0f, 2.0f, 2.0f, 1.0f);
  // The bodies' box across the sun's rays, and along them far enough for the ground behind.
  const glm::dmat4 from_sun = glm::lookAt(glm::dvec3(0.0), -sun, glm::dvec3(0.0, 0.0, 1.0));
  glm::dvec3 low(1e30), high(-1e30);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const glm::dvec3 at = positionOf(poses[i]);
    if (glm::distance(glm::dvec2(at), camera.focus_m) > kShadowReach_m) continue;
    const glm::dvec3 place(from_sun * glm::dvec4(at - frame.origin_m, 1.0));
    const double radius_m = pieces_[std::size_t(pack_->bodies[i].mesh_index)].radius_m + 0.1;
    low = glm::min(low, place - radius_m);
    high = glm::max(high, place + radius_m);
  }
  if (low.x > high.x) return nowhere;
  const double side_m = std::max(high.x - low.x, high.y - low.y);
  texel_m = float(side_m / kShadowSide_px);
  const double depth_m = high.z - low.z + 100.0;
  const glm::dvec3 scale(1.0 / side_m, 1.0 / side_m, -1.0 / depth_m);
  const glm::dmat4 to_unit = glm::translate(glm::scale(glm::dmat4(1.0), scale), glm::dvec3(-low.x, -low.y, -high.z));
  return glm::mat4(to_unit * from_sun);
}

void BodyRenderer::drawAll(std::span<const Pose> poses, const CameraFrame& frame) const {
  glBindVertexArray(layout_.name());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Piece& piece = pieces_[std::size_t(pack_->bodies[i].mesh_index)];
    glUniformMatrix4fv(0, 1, GL_FALSE, glm::value_ptr(placeOf(poses[i], frame)));
    glUniform4fv(1, 1, glm::value_ptr(paint_[i]));
    glDrawArrays(GL_TRIANGLES, piece.first, piece.count);
  }
}

void BodyRenderer::drawShadows(std::span<const Pose> poses, const CameraFrame& frame) const {
  glBindFramebuffer(GL_FRAMEBUFFER, shadow_target_.name());
  glViewport(0, 0, kShadowSide_px, kShadowSide_px);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  const float furthest = 1.0f;
  glClearNamedFramebufferfv(shadow_target_.name(), GL_DEPTH, 0, &furthest);
  glUseProgram(depth_program_.name());
  drawAll(poses, frame);
  glBindTextureUnit(render::kBodyShadowUnit, shadow_map_.name());
}

void BodyRenderer::draw(std::span<const Pose> poses, const CameraFrame& frame) const {
  glUseProgram(program_.name());
  drawAll(poses, frame);
}

}  // namespace spoor
