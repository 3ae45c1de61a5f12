#include "tests/scenes.h"

#include <algorithm>

#include "shared/base/assert.h"

namespace spoor::test {
namespace {

constexpr int kCell = 1000;

ScenePack emptyPack(int width, int height) {
  ScenePack pack;
  pack.name = "test";
  pack.width_cells = width;
  pack.height_cells = height;
  pack.cell_q = kCell;
  pack.parameters.materials[0].slope_threshold_q = 700;
  pack.parameters.materials[0].diagonal_threshold_q = 990;
  return pack;
}

/// Both triangles of a four-cornered face.
void addFace(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  mesh.triangles.push_back({a, b, c});
  mesh.triangles.push_back({a, c, d});
}

/// A prism over a polygon in the x-z plane, `width` wide along y.
Mesh prism(std::string name, const std::vector<std::array<int, 2>>& outline, int width) {
  Mesh mesh;
  mesh.name = std::move(name);
  const auto count = std::uint32_t(outline.size());
  for (const int side : {-width / 2, width - width / 2})
    for (const auto& [x, z] : outline) mesh.vertices.push_back({x, side, z});
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t next = (i + 1) % count;
    addFace(mesh, i, next, next + count, i + count);
  }
  deriveEdges(mesh);
  return mesh;
}

}  // namespace

ScenePack flatPack(int width, int height) {
  ScenePack pack = emptyPack(width, height);
  pack.soil_depth_q = 100000;
  pack.noise = {1, 1 << 20, 1, -100000, -100000};
  return pack;
}

ScenePack groundPack(int width, int height, const std::vector<std::int32_t>& heights, int soil_depth) {
  ScenePack pack = emptyPack(width, height);
  pack.soil_depth_q = soil_depth;
  pack.base_kind = BaseKind::samples;
  pack.samples = {width, height, std::int64_t(1) << 32, std::int64_t(1) << 32, heights};
  for (std::int32_t& sample : pack.samples.height_q) sample -= soil_depth;
  return pack;
}

ScenePack noisePack(int width, int height, std::uint64_t seed, int lowest, int highest, int soil_depth) {
  ScenePack pack = emptyPack(width, height);
  pack.soil_depth_q = soil_depth;
  pack.noise = {seed, std::int64_t(1) << 28, 3, lowest - soil_depth, highest - soil_depth};  // 16 cells a lattice step
  return pack;
}

Mesh boxMesh(int length, int width, int height) {
  const int x = length / 2;
  return prism("box", {{-x, 0}, {length - x, 0}, {length - x, height}, {-x, height}}, width);
}

Mesh wedgeMesh(int length, int width, int height) {
  return prism("wedge", {{0, 0}, {length - length / 2, height}, {-length / 2, height}}, width);
}

Mesh tetrahedronMesh(int size) {
  Mesh mesh;
  mesh.name = "tetrahedron";
  mesh.vertices = {{0, 0, 0}, {size, 0, size}, {-size / 2, size, size}, {-size / 2, -size, size}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
  deriveEdges(mesh);
  return mesh;
}

Mesh archMesh(int length, int width, int height) {
  const int x = length / 2, leg = length / 4;
  return prism("arch",
               {{-x, 0},
                {leg - x, 0},
                {leg - x, height / 2},
                {x - leg, height / 2},
                {x - leg, 0},
                {x, 0},
                {x, height},
                {-x, height}},
               width);
}

Mesh bladeMesh(int length, int height) {
  Mesh mesh;
  mesh.name = "blade";
  mesh.vertices = {{0, -length / 2, 0}, {0, length / 2, 0}, {0, length / 2, height}, {0, -length / 2, height}};
  addFace(mesh, 0, 1, 2, 3);
  deriveEdges(mesh);
  return mesh;
}

int addBody(ScenePack& pack, Mesh mesh, int x_q, int y_q, int sinkage_q) {
  Body body;
  body.name = mesh.name;
  body.mesh_index = std::int32_t(pack.meshes.size());
  body.path_index = std::int32_t(pack.paths.size());
  body.sinkage_q = sinkage_q;
  pack.meshes.push_back(std::move(mesh));
  pack.paths.push_back({{{x_q, y_q}}, 0, 0, 0});
  pack.bodies.push_back(std::move(body));
  return int(pack.bodies.size()) - 1;
}

Pose moved(Pose pose, int dx_q, int dy_q, int dz_q, int turn) {
  pose.x_q += dx_q;
  pose.y_q += dy_q;
  pose.z_q += dz_q;
  pose.yaw = Turn(pose.yaw + turn);
  return pose;
}

World::World(ScenePack made) : pack(std::move(made)) {
  const Status status = validatePack(pack);
  if (!status) ADD_FAILURE() << status.error();
  id = packId(encodePack(pack));
}

Simulation World::simulate(const NativeOptions& options) const {
  return Simulation(base, id, makeNativeBackend(options));
}

Simulation World::simulateOn(const BackendCase& backend_case) const {
  return Simulation(base, id, borrowBackend(backend_case));
}

::testing::AssertionResult sameState(const WorldState& state, const Oracle& oracle) {
  using ::testing::AssertionFailure;
  if (state.tiles.size() != oracle.liveCount())
    return AssertionFailure() << state.tiles.size() << " live tiles, the oracle has " << oracle.liveCount();
  for (const Tile* tile : state.tiles.sorted()) {
    const TileCoordinate at = tile->at;
    if (!oracle.isLive(at)) return AssertionFailure() << "tile (" << at.x << ", " << at.y << ") is live";
    for (int i = 0; i < rules::kTileCells; ++i) {
      const int x = at.x * rules::kTileSize + i % rules::kTileSize, y = at.y * rules::kTileSize + i / rules::kTileSize;
      const std::int32_t expected = oracle.world().height[oracle.world().at(x, y)];
      if (tile->height()[std::size_t(i)] != expected)
        return AssertionFailure() << "cell (" << x << ", " << y << ") is " << tile->height()[std::size_t(i)] << ", not "
                                  << expected;
      const std::int32_t compacted = tile->compacted() != nullptr ? (*tile->compacted())[std::size_t(i)] : 0;
      const std::int32_t expected_compacted = oracle.world().compacted[oracle.world().at(x, y)];
      if (compacted != expected_compacted)
        return AssertionFailure() << "cell (" << x << ", " << y << ") has " << compacted << " of compacted soil, not "
                                  << expected_compacted;
      const std::int32_t material = tile->material() != nullptr ? (*tile->material())[std::size_t(i)] : 0;
      const std::int32_t expected_material = oracle.world().material[oracle.world().at(x, y)];
      if (material != expected_material)
        return AssertionFailure() << "cell (" << x << ", " << y << ") is of material " << material << ", not "
                                  << expected_material;
    }
    if (tile->wake_mask != oracle.wakeMask(at))
      return AssertionFailure() << "tile (" << at.x << ", " << at.y << ") has wake mask " << tile->wake_mask << ", not "
                                << oracle.wakeMask(at);
  }
  if (state.craters.size() != oracle.craters().size())
    return AssertionFailure() << state.craters.size() << " craters, not " << oracle.craters().size();
  if (state.ledger != oracle.ledger()) {
    const auto inWords = [](const Ledger& ledger) {
      return std::to_string(ledger.ground) + " and compacted " + std::to_string(ledger.compacted) + " of " +
             std::to_string(ledger.initial) + ", craters' " + std::to_string(ledger.craters) + " and events' " +
             std::to_string(ledger.events);
    };
    return AssertionFailure() << "ledger: ground " << inWords(state.ledger) << ", not " << inWords(oracle.ledger());
  }
  if (stateHash(state) != oracle.stateHash()) return AssertionFailure() << "state hash differs";
  return ::testing::AssertionSuccess();
}

std::int64_t steepestExcess(const ScenePack& pack, const TileStore& tiles) {
  std::int64_t steepest = 0;
  for (const Tile* tile : tiles.sorted())
    for (int i = 0; i < rules::kTileCells; ++i) {
      const int x = tile->at.x * rules::kTileSize + i % rules::kTileSize,
                y = tile->at.y * rules::kTileSize + i / rules::kTileSize;
      if (x >= pack.width_cells || y >= pack.height_cells) continue;
      for (const auto& [dx, dy] : std::initializer_list<std::array<int, 2>>{{1, 0}, {0, 1}, {1, 1}, {-1, 1}}) {
        const int other_x = x + dx, other_y = y + dy;
        if (other_x < 0 || other_x >= pack.width_cells || other_y >= pack.height_cells) continue;
        const Tile* other = tiles.find({other_x / rules::kTileSize, other_y / rules::kTileSize});
        if (other == nullptr) continue;
        const std::int64_t difference =
            std::int64_t(tile->height()[std::size_t(i)]) -
            other->height()[std::size_t(other_y % rules::kTileSize * rules::kTileSize + other_x % rules::kTileSize)];
        const int threshold = dx != 0 && dy != 0 ? pack.parameters.materials[0].diagonal_threshold_q
                                                 : pack.parameters.materials[0].slope_threshold_q;
        steepest = std::max(steepest, std::abs(difference) - threshold);
      }
    }
  return steepest;
}

TilePlanes planesWith(const Tile& tile, const PlaneCells& height) {
  TilePlanes planes = planesOf(tile);
  planes[int(Plane::height)] = &height;
  return planes;
}

std::int32_t heightOf(const WorldState& state, int x, int y) {
  const Tile* tile = state.tiles.find({x / rules::kTileSize, y / rules::kTileSize});
  SPOOR_ASSERT(tile != nullptr);
  return tile->height()[std::size_t(y % rules::kTileSize * rules::kTileSize + x % rules::kTileSize)];
}

}  // namespace spoor::test
