#include "client/mesh_surface.h"

#include <cmath>
#include <map>

#include "shaders/rules/limits.h"

namespace spoor {

std::vector<SurfacePoint> surfaceOf(const Mesh& mesh, double crease_deg) {
  const float crease_cosine = float(std::cos(glm::radians(crease_deg)));
  const auto pointOf = [&](std::uint32_t vertex) {
    const auto& v = mesh.vertices[vertex];
    return glm::dvec3(v[0], v[1], v[2]) / double(rules::kUnitsPerMetre);
  };
  // Cross products: direction and twice the area. Faces that share a place count as neighbours, even where an importer
  // split the vertex.
  std::vector<glm::dvec3> faces;
  std::map<std::array<std::int32_t, 3>, std::vector<std::size_t>> faces_at;
  for (const auto& triangle : mesh.triangles) {
    const glm::dvec3 a = pointOf(triangle[0]);
    for (const std::uint32_t vertex : triangle) faces_at[mesh.vertices[vertex]].push_back(faces.size());
    faces.push_back(glm::cross(pointOf(triangle[1]) - a, pointOf(triangle[2]) - a));
  }
  const auto unit = [](const glm::dvec3& v) {
    return glm::length(v) > 0.0 ? glm::normalize(v) : glm::dvec3(0.0, 0.0, 1.0);
  };

  std::vector<SurfacePoint> points;
  points.reserve(mesh.triangles.size() * 3);
  for (std::size_t face = 0; face < faces.size(); ++face) {
    for (const std::uint32_t vertex : mesh.triangles[face]) {
      glm::dvec3 sum(0.0);
      for (const std::size_t other : faces_at[mesh.vertices[vertex]])
        if (glm::dot(unit(faces[face]), unit(faces[other])) >= crease_cosine) sum += faces[other];
      points.push_back({glm::vec3(pointOf(vertex)), glm::vec3(unit(sum))});
    }
  }
  return points;
}

}  // namespace spoor
