#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "server/import/dem.h"
#include "server/import/importer.h"
#include "server/import/mesh_file.h"
#include "server/import/pack_maker.h"
#include "server/import/path_maker.h"
#include "server/import/units.h"
#include "server/named_parameters.h"
#include "shaders/rules/limits.h"

namespace spoor {
namespace {

constexpr double kPathLengthM = 60;
constexpr double kPathShare = 0.6;  // of the world's width, where it is small
constexpr double kSpeedMS = 5;
constexpr double kSinkageM = 0.1;
constexpr double kSoilDepthM = 1;
constexpr double kGapM = 0.5;  // between bodies side by side

/// An S from west to east about the middle of the world: one period of a sine, a tenth as high as it is long.
Path middlePath(const ScenePack& pack) {
  constexpr int kCorners = 16;
  const double cell_m = double(pack.cell_q) / rules::kUnitsPerMetre;
  const PointM middle{pack.width_cells * cell_m / 2, pack.height_cells * cell_m / 2};
  const double length_m = std::min(kPathLengthM, kPathShare * 2 * std::min(middle[0], middle[1]));
  std::vector<PointM> corners;
  for (int i = 0; i <= kCorners; ++i) {
    const double along = double(i) / kCorners - 0.5;
    corners.push_back(
        {middle[0] + along * length_m, middle[1] + std::sin(2 * std::numbers::pi * along) * length_m / 10});
  }
  Path path;
  path.speed_q_per_tick = std::int32_t(std::llround(kSpeedMS * rules::kUnitsPerMetre / pack.ticks_per_second));
  for (const PointM& point : smoothPath(corners, false))
    path.waypoints.push_back({toUnits(point[0]), toUnits(point[1])});
  return path;
}

/// A body for each mesh, side by side and centred on the path, the first on the right.
void addBodies(ScenePack& pack) {
  std::int64_t width_q = -toUnits(kGapM);
  for (const Mesh& mesh : pack.meshes) width_q += boxOf(mesh).high[1] - boxOf(mesh).low[1] + toUnits(kGapM);
  std::int64_t edge_q = -width_q / 2;
  for (std::size_t i = 0; i < pack.meshes.size(); ++i) {
    const MeshBox box = boxOf(pack.meshes[i]);
    Body body;
    body.name = pack.meshes[i].name;
    body.mesh_index = std::int32_t(i);
    body.offset_q[1] = std::int32_t(edge_q - box.low[1]);
    body.sinkage_q = toUnits(kSinkageM);
    body.follows_slope = 1;
    pack.bodies.push_back(std::move(body));
    edge_q += box.high[1] - box.low[1] + toUnits(kGapM);
  }
}

Status checkRequest(const TerrainRequest& request) {
  if (!(request.cell_m >= 1e-4 && request.cell_m <= 100)) {
    return Error{"cell size " + plainNumber(request.cell_m) + " m is not within 0.0001 .. 100 m"};
  }
  if (!request.up.empty() && request.up != "y" && request.up != "z")
    return Error{"up axis '" + request.up + "' is none of: y, z"};
  if (request.ticks < 1 || request.ticks > 1'000'000'000) {
    return Error{fmt::format("{} ticks are not within 1 .. 1000000000", request.ticks)};
  }
  return {};
}

}  // namespace

Result<ImportedScene> importTerrain(const TerrainRequest& request) {
  if (const Status status = checkRequest(request); !status) return Error{status.error()};
  ImportedScene scene;
  ScenePack& pack = scene.pack;
  pack.name = std::filesystem::path(request.terrain).stem().string();
  pack.seed = 1;
  pack.default_ticks = std::int32_t(request.ticks);
  pack.cell_q = toUnits(request.cell_m);
  pack.soil_depth_q = toUnits(kSoilDepthM);
  pack.parameters = NamedSettings().parameters;
  setReposeAngle(pack, kDefaultReposeDeg, scene.notes);

  DemRequest dem_request;
  dem_request.file = request.terrain;
  Result<Dem> dem = readDem(dem_request, scene.notes);
  if (!dem) return Error{dem.error()};
  if (const Status status = setWorldSize(pack, dem->widthM(), dem->heightM()); !status) {
    return Error{request.terrain + ": " + status.error()};
  }
  if (const Status status = setGround(pack, std::move(*dem), request.terrain, scene.notes); !status)
    return Error{status.error()};
  for (const std::string& file : request.bodies) {
    Result<Mesh> mesh =
        readMesh({std::filesystem::path(file).stem().string(), file, 1, request.up}, pack.cell_q, scene.notes);
    if (!mesh) return Error{mesh.error()};
    pack.meshes.push_back(std::move(*mesh));
  }
  pack.paths.push_back(middlePath(pack));
  addBodies(pack);
  if (const Status status = checkPack(pack); !status) return Error{request.terrain + ": " + status.error()};
  return scene;
}

}  // namespace spoor
