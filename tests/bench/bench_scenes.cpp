#include "tests/bench/bench_scenes.h"

#include <algorithm>
#include <iterator>

#include "shared/base/assert.h"
#include "shared/base/fixed.h"

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
  pack.parameters.obstacle_threshold_q = 10;
  pack.parameters.materials[0].slope_threshold_q = 350;
  pack.parameters.materials[0].diagonal_threshold_q = 494;
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

// Rooms of makeAreasScene: 2 tiles wide and together 64 tiles long, whatever their number, and far apart.
constexpr std::int32_t kRoomWidth = 2 * rules::kTileSize;
constexpr std::int32_t kRoomsLength = 64 * rules::kTileSize;
constexpr std::int32_t kRoomDistance = 4 * rules::kTileSize;  // to the next one, and to the world's edge

/// Eight plates of 28 768 cells each, in a row in each room without a gap. A room leaves at least 24 cells on every
/// side for the soil that they displace, and at most a tile, so that their search domain meets every tile of it; the
/// border that the soil goes to is the same within 6 %.
struct PlateSize {
  int area_count;
  std::int32_t length, width;
};
constexpr int kPlateCount = 8;
constexpr PlateSize kPlateSizes[] = {{1, 496, 58}, {2, 496, 58}, {4, 464, 62}, {8, 464, 62}};

ScenePack areasScene(const std::string& name, const PlateSize& plate) {
  ScenePack pack = emptyScene(name, 8192);
  pack.noise.highest_q = pack.noise.lowest_q;
  Mesh mesh;
  // Over the outermost cells' centres by a little.
  const std::int32_t reach_x = (plate.length - 1) * kCell_q / 2 + 100;
  const std::int32_t reach_y = (plate.width - 1) * kCell_q / 2 + 100;
  addBox(mesh, {-reach_x, -reach_y, 0}, {reach_x, reach_y, 4000});
  addMesh(pack, std::move(mesh));
  const int in_row = kPlateCount / plate.area_count;
  const std::int32_t margin_x = (kRoomsLength / plate.area_count - in_row * plate.length) / 2;
  const std::int32_t margin_y = (kRoomWidth - plate.width) / 2;
  for (int i = 0; i < kPlateCount; ++i) {
    const std::int32_t first_x = kRoomDistance + margin_x + i % in_row * plate.length;
    const std::int32_t first_y = kRoomDistance + margin_y + i / in_row * (kRoomWidth + kRoomDistance);
    pack.paths.push_back(
        {{{(2 * first_x + plate.length - 1) * kCell_q / 2, (2 * first_y + plate.width - 1) * kCell_q / 2}}, 0, 0, 0});
    pack.bodies.push_back(bodyOf(0, {0, 0, 0}, 0));
    pack.bodies.back().path_index = i;
  }
  return pack;
}

constexpr double kCarLength_m = 24;
constexpr std::int32_t kCarDistance_q = 300000;

Parameters thesisParameters() {
  Parameters parameters;
  parameters.nearest = NearestSearch::jump_flooding;
  parameters.materials[0].roughness_q16 = kOneQ16 / 2;
  parameters.obstacle_threshold_q = 1000;
  parameters.capacity_rounds = 1;
  return parameters;
}

/// The car's mesh: footprints of 1 x 0.6 m at the corners of a rectangle of 5 x 2 m, and the roof 8 m above.
Mesh thesisCar(std::int32_t cell_q) {
  // A little less than the area: the search domain adds a cell on every side.
  const auto reach = std::int32_t(kCarLength_m * rules::kUnitsPerMetre / 2) - cell_q - 100;
  Mesh mesh;
  addBox(mesh, {-reach, -reach, 80000}, {reach, reach, 84000});
  for (const int x : {-1, 1})
    for (const int y : {-1, 1})
      addBox(mesh, {x * 25000 - 5000, y * 10000 - 3000, 0}, {x * 25000 + 5000, y * 10000 + 3000, 80000});
  return mesh;
}

/// Heaps a cone of soil on a state's ground.
void addCone(const BenchScene& scene, const BaseTerrain& base, WorldState& state) {
  const std::int32_t radius = scene.cone_radius_cells, middle = scene.pack.width_cells / 2;
  const std::int64_t slope_q = 2 * scene.pack.parameters.materials[0].slope_threshold_q;
  heapSoil(base, {middle - radius, middle - radius, middle + radius + 1, middle + radius + 1}, state,
           [&](std::int64_t x, std::int64_t y) {
             const std::int64_t distance =
                 isqrt(std::uint64_t((x - middle) * (x - middle) + (y - middle) * (y - middle)));
             return std::int32_t(slope_q * std::max<std::int64_t>(radius - distance, 0));
           });
}

}  // namespace

std::vector<std::string> benchSceneNames() {
  return {"car491", "slab491", "pile", "small_pile", "car", "car_wide", "areas1", "areas2", "areas4", "areas8"};
}

void heapSoil(const BaseTerrain& base, const CellBox& box, WorldState& state,
              const std::function<std::int32_t(std::int32_t, std::int32_t)>& added) {
  for (std::int32_t tile_y = box.y0 / rules::kTileSize; tile_y <= (box.y1 - 1) / rules::kTileSize; ++tile_y)
    for (std::int32_t tile_x = box.x0 / rules::kTileSize; tile_x <= (box.x1 - 1) / rules::kTileSize; ++tile_x) {
      auto tile = makeTile({tile_x, tile_y}, {&base}, 0);
      for (int i = 0; i < rules::kTileCells; ++i) {
        const std::int32_t x = tile_x * rules::kTileSize + i % rules::kTileSize;
        const std::int32_t y = tile_y * rules::kTileSize + i / rules::kTileSize;
        if (x >= base.pack().width_cells || y >= base.pack().height_cells) continue;
        const std::int32_t added_q = added(x, y);
        tile->height()[std::size_t(i)] += added_q;
        tile->ground += added_q;
      }
      tile->hash = tileHash(*tile);
      state.ledger.initial += tile->initial;
      state.ledger.ground += tile->ground;
      state.ledger.events += tile->ground - tile->initial;
      Tile& live = state.tiles.insert(std::move(tile));
      state.tiles.setWake(live, kWakeMaskLimit - 1);
      state.tiles_hash += tileStateHash(live);
    }
}

BenchScene makeBenchScene(const std::string& name) {
  if (name.starts_with("areas")) return makeAreasScene(name.back() - '0');
  BenchScene scene;
  scene.pack = name == "car491"     ? domainScene(name, false)
               : name == "slab491"  ? domainScene(name, true)
               : name == "car"      ? carScene(name, 2048)
               : name == "car_wide" ? carScene(name, 65536)
                                    : emptyScene(name, 1024);
  if (name == "pile" || name == "small_pile") {
    scene.pack.noise.highest_q = scene.pack.noise.lowest_q;
    scene.cone_radius_cells = name == "pile" ? 256 : 64;
  }
  SPOOR_ASSERT(validatePack(scene.pack));
  scene.id = packId(encodePack(scene.pack));
  return scene;
}

BenchScene makeAreasScene(int area_count) {
  const auto plate = std::ranges::find(kPlateSizes, area_count, &PlateSize::area_count);
  SPOOR_ASSERT(plate != std::end(kPlateSizes));
  BenchScene scene;
  scene.pack = areasScene("areas" + std::to_string(area_count), *plate);
  scene.sinking_q_per_tick = 3;
  SPOOR_ASSERT(validatePack(scene.pack));
  scene.id = packId(encodePack(scene.pack));
  return scene;
}

Parameters thesisIterative() {
  Parameters parameters = thesisParameters();
  parameters.displacement = Displacement::iterative;
  parameters.slopes = SlopeRule::interleaved;
  return parameters;
}

Parameters thesisSsbo() {
  Parameters parameters = thesisParameters();
  parameters.slopes = SlopeRule::scatter;
  return parameters;
}

Parameters thesisSsboMultiple() {
  Parameters parameters = thesisSsbo();
  parameters.displacement = Displacement::spread;
  return parameters;
}

BenchScene makeThesisScene(const std::string& name, int heightmap_size, int terrain_size_m, int car_count,
                           const Parameters& parameters) {
  BenchScene scene;
  ScenePack& pack = scene.pack = emptyScene(name, heightmap_size);
  pack.cell_q = (terrain_size_m * rules::kUnitsPerMetre + heightmap_size / 2) / heightmap_size;
  pack.parameters = parameters;
  // The thesis gives no threshold for its measurements: 35 degrees, as a slope over one cell.
  pack.parameters.materials[0].slope_threshold_q = pack.cell_q * 7 / 10;
  pack.parameters.materials[0].diagonal_threshold_q = pack.cell_q * 99 / 100;
  pack.noise.lattice_step_q32 = (std::int64_t(1) << 32) * pack.cell_q / 160000;  // dunes of 16 m
  addMesh(pack, thesisCar(pack.cell_q));
  const std::int32_t side_q = heightmap_size * pack.cell_q;
  for (int car = 0; car < car_count; ++car) {
    const std::int32_t y_q = side_q / 2 + (2 * car - car_count + 1) * kCarDistance_q / 2;
    pack.paths.push_back({{{side_q / 4, y_q}, {side_q * 3 / 4, y_q}}, pack.cell_q, 0, 0});
    pack.bodies.push_back(bodyOf(0, {0, 0, 0}, 1500));
    pack.bodies.back().path_index = car;
  }
  SPOOR_ASSERT(validatePack(pack));
  scene.id = packId(encodePack(pack));
  return scene;
}

WorldState startOf(const BenchScene& scene, const BaseTerrain& base) {
  WorldState state = initialState(scene.id, base);
  if (scene.cone_radius_cells > 0) addCone(scene, base, state);
  return state;
}

std::vector<Pose> posesOf(const BenchScene& scene, const Script& script, std::int32_t tick) {
  std::vector<Pose> poses = script.poses(tick);
  for (Pose& pose : poses) pose.z_q -= scene.sinking_q_per_tick * tick;
  return poses;
}

}  // namespace spoor
