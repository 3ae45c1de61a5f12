#include "server/import/mesh_file.h"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <map>

#include "server/import/units.h"
#include "shaders/rules/raster.h"

namespace spoor {
namespace {

using Point = std::array<std::int32_t, 3>;

/// Counts before memory: larger files are no bodies to drive with.
constexpr std::uintmax_t kMeshFileLimitBytes = std::uintmax_t(256) << 20;
constexpr std::size_t kTriangleLimit = std::size_t(1) << 20;
constexpr double kMeshLimitM = 1e4;  // keeps every coordinate and difference within 32 bits

struct Dropped {
  std::size_t points_and_lines = 0;
  std::size_t without_area = 0;
};

bool yIsUp(const MeshRequest& request) {
  if (!request.up.empty()) return request.up == "y";
  std::string extension = std::filesystem::path(request.file).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return extension == ".gltf" || extension == ".glb";
}

/// Twice the area is the length of this; 0 only where the corners lie on a line. Exact up to kMeshLimitM.
bool hasArea(const Point& a, const Point& b, const Point& c) {
  const auto difference = [](const Point& from, const Point& to, int axis) {
    return std::int64_t(to[axis]) - from[axis];
  };
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3;
    const int v = (axis + 2) % 3;
    if (difference(a, b, u) * difference(a, c, v) != difference(a, b, v) * difference(a, c, u)) return true;
  }
  return false;
}

/// Joins the meshes of a scene into one, in order of meshes, faces and corners.
class MeshBuilder {
 public:
  MeshBuilder(const MeshRequest& request, Mesh& mesh) : request_(request), y_up_(yIsUp(request)), mesh_(mesh) {}

  Status add(const aiMesh& part) {
    std::vector<std::uint32_t> index_of(part.mNumVertices);
    for (unsigned i = 0; i < part.mNumVertices; ++i) {
      const aiVector3D& v = part.mVertices[i];
      const std::array<double, 3> turned =
          y_up_ ? std::array<double, 3>{v.z, v.x, v.y} : std::array<double, 3>{v.x, v.y, v.z};
      Point point{};
      for (int axis = 0; axis < 3; ++axis) {
        const double metres = turned[axis] * request_.scale;
        if (!(std::abs(metres) <= kMeshLimitM)) {
          return Error{fmt::format("{}: vertex {} lies {} m off, beyond +-{} m", request_.file, i, plainNumber(metres),
                                   kMeshLimitM)};
        }
        point[axis] = toUnits(metres);
      }
      index_of[i] = indexOf(point);
    }
    for (unsigned i = 0; i < part.mNumFaces; ++i) addFace(part.mFaces[i], index_of);
    return {};
  }

  const Dropped& dropped() const { return dropped_; }

 private:
  std::uint32_t indexOf(const Point& point) {
    const auto [entry, added] = known_.try_emplace(point, std::uint32_t(mesh_.vertices.size()));
    if (added) mesh_.vertices.push_back(point);
    return entry->second;
  }

  void addFace(const aiFace& face, const std::vector<std::uint32_t>& index_of) {
    if (face.mNumIndices != 3) {
      ++dropped_.points_and_lines;
      return;
    }
    const std::array<std::uint32_t, 3> corners{index_of[face.mIndices[0]], index_of[face.mIndices[1]],
                                               index_of[face.mIndices[2]]};
    if (hasArea(mesh_.vertices[corners[0]], mesh_.vertices[corners[1]], mesh_.vertices[corners[2]])) {
      mesh_.triangles.push_back(corners);
    } else {
      ++dropped_.without_area;
    }
  }

  const MeshRequest& request_;
  const bool y_up_;
  Mesh& mesh_;
  std::map<Point, std::uint32_t> known_;
  Dropped dropped_;
};

/// Removes vertices that no triangle uses, so that they do not count for the mesh's lowest point.
void removeUnused(Mesh& mesh) {
  constexpr std::uint32_t kUnused = ~std::uint32_t(0);
  std::vector<std::uint32_t> renamed(mesh.vertices.size(), kUnused);
  std::vector<Point> kept;
  for (auto& triangle : mesh.triangles) {
    for (auto& corner : triangle) {
      if (renamed[corner] == kUnused) {
        renamed[corner] = std::uint32_t(kept.size());
        kept.push_back(mesh.vertices[corner]);
      }
      corner = renamed[corner];
    }
  }
  mesh.vertices = std::move(kept);
}

/// The limits of the depth stage: a body may be turned any way about its origin (validatePack has the same rule).
Status checkSize(const Mesh& mesh, const std::string& file, std::int32_t cell_q) {
  double reach_q = 0;
  for (const Point& point : mesh.vertices) reach_q = std::max(reach_q, std::hypot(point[0], point[1], point[2]));
  const double limit_q =
      std::min(double(rules::kRasterSpanCells / 2 - 2) * cell_q, double(rules::kRasterHeightSpan / 2 - 2));
  if (reach_q <= limit_q) return {};
  return Error{
      fmt::format("{}: reaches {:.2f} m from its origin, more than {:.2f} m; a smaller scale or larger cells help",
                  file, reach_q / rules::kUnitsPerMetre, limit_q / rules::kUnitsPerMetre)};
}

Result<Mesh> convert(const aiScene& scene, const MeshRequest& request, std::vector<std::string>& notes) {
  std::size_t face_count = 0;
  for (unsigned i = 0; i < scene.mNumMeshes; ++i) face_count += scene.mMeshes[i]->mNumFaces;
  if (face_count > kTriangleLimit) {
    return Error{fmt::format("{}: {} triangles, more than {}", request.file, face_count, kTriangleLimit)};
  }
  Mesh mesh;
  mesh.name = request.name;
  MeshBuilder builder(request, mesh);
  for (unsigned i = 0; i < scene.mNumMeshes; ++i) {
    if (const Status status = builder.add(*scene.mMeshes[i]); !status) return Error{status.error()};
  }
  const Dropped& dropped = builder.dropped();
  if (mesh.triangles.empty()) {
    return Error{fmt::format("{}: a mesh without triangles ({} points and lines, {} triangles without area)",
                             request.file, dropped.points_and_lines, dropped.without_area)};
  }
  if (dropped.points_and_lines > 0) {
    notes.push_back(fmt::format("{}: {} points and lines dropped", request.file, dropped.points_and_lines));
  }
  if (dropped.without_area > 0) {
    notes.push_back(fmt::format("{}: {} triangles without area dropped", request.file, dropped.without_area));
  }
  return mesh;
}

}  // namespace

Result<Mesh> readMesh(const MeshRequest& request, std::int32_t cell_q, std::vector<std::string>& notes) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(request.file, error)) return Error{request.file + ": no such file"};
  if (std::filesystem::file_size(request.file, error) > kMeshFileLimitBytes) {
    return Error{fmt::format("{}: larger than {} MiB", request.file, kMeshFileLimitBytes >> 20)};
  }
  Assimp::Importer importer;
  // Only positions matter; PreTransformVertices applies the nodes.
  importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS,
                              aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS | aiComponent_COLORS |
                                  aiComponent_TEXCOORDS | aiComponent_BONEWEIGHTS | aiComponent_ANIMATIONS |
                                  aiComponent_TEXTURES | aiComponent_LIGHTS | aiComponent_CAMERAS);
  const aiScene* scene = importer.ReadFile(
      request.file, aiProcess_RemoveComponent | aiProcess_Triangulate | aiProcess_JoinIdenticalVertices |
                        aiProcess_PreTransformVertices | aiProcess_ValidateDataStructure);
  if (!scene) {
    std::string why = importer.GetErrorString();
    std::replace(why.begin(), why.end(), '\n', ' ');
    return Error{request.file + ": not a mesh that can be read: " + why};
  }
  Result<Mesh> mesh = convert(*scene, request, notes);
  if (!mesh) return mesh;
  removeUnused(*mesh);
  if (const Status status = checkSize(*mesh, request.file, cell_q); !status) return Error{status.error()};
  deriveEdges(*mesh);
  return mesh;
}

MeshBox boxOf(const Mesh& mesh) {
  MeshBox box;
  if (mesh.vertices.empty()) return box;
  box.low = box.high = mesh.vertices.front();
  for (const Point& point : mesh.vertices) {
    for (int axis = 0; axis < 3; ++axis) {
      box.low[axis] = std::min(box.low[axis], point[axis]);
      box.high[axis] = std::max(box.high[axis], point[axis]);
    }
  }
  return box;
}

}  // namespace spoor
