#pragma once

#include <span>
#include <vector>

#include "client/camera.h"
#include "shaders/host/gl_objects.h"
#include "shared/world/pack.h"

namespace spoor {

/// Draws a pack's bodies at given poses, into the picture and into the sun's shadow map.
class BodyRenderer {
 public:
  /// The pack must outlive this.
  explicit BodyRenderer(const ScenePack& pack);

  /// A matrix to the shadow map that covers the bodies within `reach_m` of the focus; everything lies outside it where
  /// there are none. `texel_m` becomes the side of a texel on the ground.
  glm::mat4 shadowMatrix(std::span<const Pose> poses, const CameraFrame& frame, const Camera& camera,
                         const glm::dvec3& sun, float& texel_m) const;

  /// Fills the shadow map. The frame block must be bound. Leaves framebuffer, viewport and depth test changed.
  void drawShadows(std::span<const Pose> poses, const CameraFrame& frame) const;

  /// Draws into the bound framebuffer.
  void draw(std::span<const Pose> poses, const CameraFrame& frame) const;

 private:
  struct Piece {
    GLint first = 0;
    GLsizei count = 0;
    double radius_m = 0.0;  // about the mesh's own origin
  };
  void drawAll(std::span<const Pose> poses, const CameraFrame& frame) const;

  const ScenePack* pack_;
  std::vector<Piece> pieces_;     // of each mesh
  std::vector<glm::vec4> paint_;  // of each body; w: gloss
  GlBuffer points_;
  GlVertexArray layout_;
  GlProgram program_, depth_program_;
  GlTexture shadow_map_;
  GlFramebuffer shadow_target_;
};

}  // namespace spoor
