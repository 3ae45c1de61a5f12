#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "shared/world/pack.h"

namespace spoor {

/// A corner of a drawn triangle.
struct SurfacePoint {
  glm::vec3 point_m{0.0f};
  glm::vec3 normal{0.0f};
};

/// A mesh as separate triangles, three points each. Where faces meet at less than `crease_deg`, their normals are
/// averaged by area; beyond it the edge stays sharp.
std::vector<SurfacePoint> surfaceOf(const Mesh& mesh, double crease_deg);

}  // namespace spoor
