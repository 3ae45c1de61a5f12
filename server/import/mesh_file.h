#pragma once

#include <string>
#include <vector>

#include "shared/base/result.h"
#include "shared/world/pack.h"

namespace spoor {

/// Which mesh, and how to turn it into Spoor's frame: x forward, y left, z up, metres.
struct MeshRequest {
  std::string name;
  std::string file;
  double scale = 1;  // metres per unit of the file
  /// Which axis of the file is up. "z": the file has Spoor's axes (Chrono, CAD, STL). "y": z is forward and x left
  /// (glTF, most modellers). Empty: "y" for .gltf and .glb, whose format says so, else "z".
  std::string up;
};

/// Reads a mesh through assimp (OBJ, glTF, STL, PLY, ...), all of its nodes as one. Vertices that round to the same
/// point are joined; points, lines and triangles without area are dropped with a note. Edges are derived.
/// Errors: a file that assimp cannot read, no triangle left, a mesh that is larger than the raster stage can take in a
/// world of cells of `cell_q` (shaders/rules/raster.h).
Result<Mesh> readMesh(const MeshRequest& request, std::int32_t cell_q, std::vector<std::string>& notes);

/// The box around a mesh, 0.1 mm.
struct MeshBox {
  std::array<std::int32_t, 3> low{};
  std::array<std::int32_t, 3> high{};
};
MeshBox boxOf(const Mesh& mesh);

}  // namespace spoor
