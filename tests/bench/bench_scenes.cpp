#include "tests/bench/bench_scenes.h"

#include "shared/base/assert.h"

namespace spoor {
namespace {

constexpr std::int32_t kCell_q = 500;  // 5 cm

void addBox(Mesh& mesh, std::array<std::int32_t, 3> low, std::array<std::int32_t, 3> high) {
  const auto first = std::uint32_t(mesh.vertices.size());
  for (int corner = 0; corner < 8; ++corner)
    mesh.vertices.push_back(
        {corner & 1 ? high[0] : low[0], corner & 2 ? high[1] : low[1], corner & 4 ? high[2] : low[2]});
  constexpr std::uint32_t kQuads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                          {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& quad : kQuads) {
    mesh.triangles.push_back({first + quad[0], first + quad[1], first + quad[2]});
    mesh.triangles.push_back({first + quad[0], first + quad[2], first + quad[3]});
  }
}

ScenePack emptyScene(const std::string& name, std::int32_t cells) {
  ScenePack pack;
  pack.name = name;
  pack.width_cells = pack.height_cells = cells;
  pack.cell_q = kCell_q;
  pack.soil_depth_q = 10000;
  pack.obstacle_threshold_q = 10;
  pack.slope_threshold_q = 350;
  pack.diagonal_threshold_q = 494;
  pack.noise = {1, std::int64_t(1) << 24, 2, 0, 20000};
  return pack;
}

void addMesh(ScenePack& pack, Mesh mesh) {
  deriveEdges(mesh);
  pack.meshes.push_back(std::move(mesh));
}

/// A straight path through the middle at one cell per tick, so that each tick is one sub-step.
void addPath(ScenePack& pack) {
  const std::int32_t middle_q = pack.width_cells / 2 * kCell_q + 100;
  pack.paths.push_back({{{middle_q - 100 * kCell_q, middle_q}, {middle_q + 100 * kCell_q, middle_q}}, kCell_q, 0, 0});
}

Body bodyOf(int mesh_index, std::array<std::int32_t, 3> offset_q, std::int32_t sinkage_q) {
  Body body;
  body.mesh_index = mesh_index;
  body.offset_q = offset_q;
  body.sinkage_q = sinkage_q;
  return body;
}

/// A body whose box is 489 x 489 cells wherever it stands on its path: half a cell short of 489 on either side.
ScenePack domainScene(const std::string& name, bool whole_underside) {
  ScenePack pack = emptyScene(name, 2048);
  addPath(pack);
  constexpr std::int32_t reach = 488 * kCell_q / 2;
  constexpr std::int32_t height = 4000;
  Mesh mesh;
  addBox(mesh, {-reach, -reach, whole_underside ? 0 : 20 * height}, {reach, reach, 21 * height});
  if (!whole_underside)
    for (const int x : {-1, 1})
      for (const int y : {-1, 1})
        addBox(mesh, {x * reach / 2 - 20 * kCell_q, y * reach / 2 - 10 * kCell_q, 0},
               {x * reach / 2 + 20 * kCell_q, y * reach / 2 + 10 * kCell_q, 20 * height});
  addMesh(pack, std::move(mesh));
  pack.bodies.push_back(bodyOf(0, {0, 0, 0}, 1500));
  return pack;
}

ScenePack carScene(const std::string& name, std::int32_t cells) {
  ScenePack pack = emptyScene(name, cells);
  pack.noise.highest_q = pack.noise.lowest_q;  // level, so that the same car meets the same ground in both worlds
  addPath(pack);
  Mesh chassis, wheel;
  addBox(chassis, {-12000, -6000, 0}, {12000, 6000, 5000});
  addBox(wheel, {-2000, -1200, 0}, {2000, 1200, 6000});
  addMesh(pack, std::move(chassis));
  addMesh(pack, std::move(wheel));
  pack.bodies.push_back(bodyOf(0, {0, 0, 4000}, 0));
  for (const int x : {-1, 1})
    for (const int y : {-1, 1}) pack.bodies.push_back(bodyOf(1, {x * 9000, y * 6000, 0}, 1200));
  return pack;
}

}  // namespace

std::vector<std::string> benchSceneNames() { return {"car491", "slab491", "pile", "car", "car_wide"}; }

ScenePack makeBenchScene(const std::string& name) {
  ScenePack pack = name == "car491"     ? domainScene(name, false)
                   : name == "slab491"  ? domainScene(name, true)
                   : name == "car"      ? carScene(name, 2048)
                   : name == "car_wide" ? carScene(name, 65536)
                                        : emptyScene(name, 512);
  SPOOR_ASSERT(validatePack(pack));
  return pack;
}

}  // namespace spoor
