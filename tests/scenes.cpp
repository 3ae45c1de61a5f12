#include "tests/scenes.h"

#include <algorithm>
#include <random>
#include <sstream>

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

Parameters randomParameters(std::uint32_t seed, int material_count) {
  std::mt19937 engine(seed * 2654435761u + 99);
  const auto oneOf = [&engine](std::initializer_list<int> values) {
    return *(values.begin() + engine() % std::uint32_t(values.size()));
  };
  Parameters p;
  p.displacement = Displacement(oneOf({0, 0, 1, 1, 2, 2, 3}));
  p.nearest = NearestSearch(oneOf({0, 0, 0, 1, 2, 3, 4, 5}));
  p.metric = Metric(oneOf({0, 0, 1, 2}));
  p.slopes = SlopeRule(oneOf({0, 0, 1, 2, 3, 4, 4}));
  p.active_areas = std::uint8_t(oneOf({0, 1, 1, 1, 1, 1, 1}));
  p.displace_iterations = oneOf({0, 1, 10, 40});
  p.sweeps_per_tick = oneOf({0, 1, 3, 10});
  p.materials.resize(std::size_t(material_count));
  for (MaterialRules& own : p.materials) {
    own.compression_q16 = oneOf({0, 0, 0, kOneQ16 * 3 / 10, kOneQ16});
    own.compaction_limit_q16 = oneOf({0, 1, kOneQ16 / 5, kOneQ16});
    own.roughness_q16 = oneOf({0, kOneQ16 / 2, kOneQ16, kOneQ16});
    own.slope_threshold_q = oneOf({0, 1, 7, 350, 700, 2000, kNeverSteep});
    own.diagonal_threshold_q = oneOf({0, 1, 9, 495, 990, 2828, kNeverSteep});
    own.diffusion_q16 = oneOf({0, kOneQ16 / 5, kOneQ16, kOneQ16, kDiffusionLimit});
    own.friction_inverse_q32 = oneOf({0, 1 << 16, 1 << 22, 1 << 26, INT32_MAX});
    own.repose_q16 = oneOf({0, 700, kOneQ16 / 3, kReposeLimit});
  }
  p.drift_weights = DriftWeights(oneOf({0, 1, 2, 2}));
  p.drift_step_q16 = oneOf({1, kOneQ16 / 20, kOneQ16 / 4, kOneQ16, 10 * kOneQ16});
  while (sweepsOf(p) > 40) p.drift_step_q16 /= 2;
  p.obstacle_threshold_q = oneOf({0, 1, 50, 1500});
  p.penetration_divider_q = oneOf({1, 50, 1000});
  p.spread_cells = oneOf({1, 3, 16, kSpreadCellsLimit});
  p.capacity_rounds = oneOf({1, 2, 3, 4});
  p.active_margin_cells = oneOf({0, 0, 1, 70});
  p.frustum_height_q = oneOf({0, 0, 0, 0, 1, 900, 6000});
  return p;
}

std::string describe(const Parameters& p) {
  constexpr const char* displacements[] = {"direct", "iterative", "spread", "no displacement"};
  constexpr const char* searches[] = {"exact", "JFA", "JFA+1", "JFA+2", "1+JFA", "JFA^2"};
  constexpr const char* metrics[] = {"Euclidean", "Manhattan", "Chebyshev"};
  constexpr const char* slopes[] = {"exchange", "flux", "interleaved", "scatter", "drift"};
  constexpr const char* weights[] = {"unweighted", "by displacement", "by slope"};
  std::ostringstream text;
  text << displacements[int(p.displacement)] << " (" << p.displace_iterations << " iterations, " << p.spread_cells
       << " cells, one per " << p.penetration_divider_q << ", " << p.capacity_rounds << " rounds), "
       << searches[int(p.nearest)] << ", " << metrics[int(p.metric)] << ", " << slopes[int(p.slopes)];
  if (p.slopes == SlopeRule::drift) text << ' ' << weights[int(p.drift_weights)] << " in steps of " << p.drift_step_q16;
  text << " (" << p.sweeps_per_tick << " sweeps), obstacles from " << p.obstacle_threshold_q << ", frustum "
       << p.frustum_height_q << ", margin " << p.active_margin_cells
       << (p.active_areas == 0 ? ", the whole world active" : "");
  for (const MaterialRules& own : p.materials)
    text << "; thresholds " << own.slope_threshold_q << " / " << own.diagonal_threshold_q << ", roughness "
         << own.roughness_q16 << ", compression " << own.compression_q16 << " up to " << own.compaction_limit_q16
         << ", D " << own.diffusion_q16 << ", 1/zeta " << own.friction_inverse_q32 << ", repose " << own.repose_q16;
  return text.str();
}

void addMaterials(ScenePack& pack, int count, std::uint32_t seed) {
  std::mt19937 engine(seed * 747796405u + 3);
  const auto pick = [&engine](int low, int high) { return low + int(engine() % std::uint32_t(high - low + 1)); };
  for (int i = 1; i < count; ++i) pack.materials.push_back({"material " + std::to_string(i), {}, {}, 0, 0});
  MaterialMap& map = pack.material_map;
  if (pick(0, 2) > 0) {
    map.kind = MaterialMapKind::image;
    map.image.column_count = pick(1, 40);
    map.image.row_count = pick(1, 40);
    // From an image of which one sample covers the world to one that ends in its middle.
    const auto step = [&](int samples, int cells) {
      return std::min((std::int64_t(samples) << 32) * pick(1, 4) / (2 * cells), std::int64_t(1) << 38);
    };
    map.image.step_x_q32 = step(map.image.column_count, pack.width_cells);
    map.image.step_y_q32 = step(map.image.row_count, pack.height_cells);
    for (int i = 0; i < map.image.column_count * map.image.row_count; ++i)
      map.image.material.push_back(std::uint8_t(pick(0, count - 1)));
    return;
  }
  map.kind = MaterialMapKind::rules;
  for (int i = pick(1, 5); i > 0; --i) {
    MaterialRule rule{pick(0, count - 1), pick(-9000, 5000), 0, pick(0, 1) * pick(0, 60), 0};
    rule.highest_q = rule.lowest_q + pick(0, 9000);
    rule.steepest_q = rule.gentlest_q + pick(0, 1) * pick(0, 900);
    map.rules.push_back(rule);
  }
}

Crater randomCrater(const ScenePack& pack, std::uint32_t seed, int reach_q) {
  std::mt19937 engine(seed * 2246822519u + 7);
  const auto pick = [&engine](std::int64_t low, std::int64_t high) {
    return std::int32_t(low + std::int64_t(engine() % std::uint32_t(high - low + 1)));
  };
  const auto oneOf = [&](std::initializer_list<std::int32_t> values) {
    return *(values.begin() + pick(0, int(values.size()) - 1));
  };
  Crater crater;
  const std::int32_t outer = std::max(1, pick(1, reach_q) >> oneOf({0, 0, 1, 2, 3, 12}));
  crater.crest_radius_q = std::max(1, oneOf({outer, outer * 2 / 3, (outer + 1) / 2}));
  crater.inner_radius_q = std::clamp(2 * crater.crest_radius_q - outer, 0, crater.crest_radius_q);
  crater.depth_q = oneOf({0, 1, outer / 5, outer / 2, pick(0, 20000), rules::kCraterHeightLimit});
  crater.rim_height_q = oneOf({0, 1, outer / 12, pick(0, 9000), crater.depth_q / 3});
  crater.noise_seed = std::uint16_t(pick(0, 65535));
  crater.noise_q16 = std::uint16_t(oneOf({0, 0, 9000, 30000, 65535}));
  const std::int32_t margin = std::int32_t(crater.outerRadius());
  crater.x_q = pick(-margin, std::int64_t(pack.width_cells) * pack.cell_q + margin - 1);
  crater.y_q = pick(-margin, std::int64_t(pack.height_cells) * pack.cell_q + margin - 1);
  return crater;
}

namespace {

/// Draws the craters of a random world; none in every third.
void addCraters(RandomWorld& world, std::uint32_t seed) {
  world.craters.resize(world.ticks.size());
  if (seed % 3 == 2) return;
  std::mt19937 engine(seed + 0x5eed);
  const auto below = [&engine](int n) { return int(engine() % std::uint32_t(n)); };
  const auto oneIn = [&below](int n) { return below(n) == 0; };
  ScenePack& pack = world.pack;
  const int reach_q = pack.cell_q * (oneIn(3) ? 60 : 12);
  pack.crater_limits.radius_q = reach_q;
  pack.crater_limits.hash_cell_q = std::max((reach_q + 15) / 16, below(9) * pack.cell_q);
  for (std::size_t tick = 0; tick < world.ticks.size(); ++tick) {
    const int count = oneIn(3) ? 1 + below(oneIn(4) ? 9 : 2) : 0;
    for (int i = 0; i < count; ++i) {
      Crater crater = randomCrater(pack, std::uint32_t(engine()), reach_q);
      const Pose& pose = world.ticks[tick][engine() % world.ticks[tick].size()];
      const Crater moved{.x_q = pose.x_q,
                         .y_q = pose.y_q,
                         .inner_radius_q = crater.inner_radius_q,
                         .crest_radius_q = crater.crest_radius_q};
      if (oneIn(3) && validateCrater(pack, moved)) {  // under a body
        crater.x_q = pose.x_q;
        crater.y_q = pose.y_q;
      }
      world.craters[tick].insert(world.craters[tick].end(), oneIn(5) ? 2 : 1, crater);
    }
  }
}

/// Draws the snowfalls of a random world; none in every fourth.
void addSnowfalls(RandomWorld& world, std::uint32_t seed) {
  world.snowfalls.resize(world.ticks.size());
  if (seed % 4 == 3) return;
  std::mt19937 engine(seed + 0x5a0f);
  const auto pick = [&engine](int low, int high) { return low + int(engine() % std::uint32_t(high - low + 1)); };
  const ScenePack& pack = world.pack;
  for (int left = pick(1, 3); left > 0; --left) {
    Snowfall snowfall;
    const int x = pick(0, pack.width_cells - 1), y = pick(0, pack.height_cells - 1);
    snowfall.area = {0, 0, pack.width_cells, pack.height_cells};
    if (pick(0, 1) == 0) snowfall.area = {x, y, pick(x + 1, pack.width_cells), pick(y + 1, pack.height_cells)};
    constexpr std::int64_t kUnit = std::int64_t(1) << 32;
    const std::int64_t rates[] = {1, kUnit / 7, kUnit / 2, 3 * kUnit + 5, 20 * kUnit, 150 * kUnit};
    snowfall.rate_q32 = rates[pick(0, 5)];
    snowfall.seed = std::uint32_t(engine());
    const bool of_pack = pick(0, 1) == 0;
    const int tick = pick(1, int(world.ticks.size()));
    snowfall.first_tick = of_pack ? pick(1, 9) : tick + pick(0, 3);
    snowfall.last_tick = snowfall.first_tick + pick(0, 1) * pick(0, 40);
    (of_pack ? world.pack.snowfalls : world.snowfalls[std::size_t(tick - 1)]).push_back(snowfall);
  }
}

}  // namespace

RandomWorld randomWorld(std::uint32_t seed, int tick_count) {
  std::mt19937 engine(seed);
  const auto pick = [&engine](int low, int high) { return low + int(engine() % std::uint32_t(high - low + 1)); };
  const auto oneOf = [&](std::initializer_list<int> values) {
    return *(values.begin() + pick(0, int(values.size()) - 1));
  };
  const int width = oneOf({1, 5, 23, 64, 65, 77, 91, 130}), height = oneOf({1, 7, 31, 63, 66, 89, 131});
  const int relief = oneOf({0, 300, 4000, 30000});
  RandomWorld world;
  ScenePack& pack = world.pack;
  pack = noisePack(width, height, engine(), pick(-5000, 5000), 5000 + relief, oneOf({0, 40, 500, 3000, 100000}));
  pack.cell_q = oneOf({1000, 777, 500});
  const int material_count = pick(0, 1) * pick(1, 3) + 1;
  pack.parameters = randomParameters(std::uint32_t(engine()), material_count);
  world.changed = randomParameters(std::uint32_t(engine()), material_count);
  if (material_count > 1) addMaterials(pack, material_count, std::uint32_t(engine()));
  // A frustum that ends somewhere in the soil or in a body, not beneath all of them.
  for (Parameters* parameters : {&pack.parameters, &world.changed})
    if (parameters->frustum_height_q > 1) parameters->frustum_height_q += pack.soil_depth_q - 900;
  const int body_count = pick(1, 3);
  for (int i = 0; i < body_count; ++i) {
    const int size = (pick(0, 5) == 0 ? pick(20, 90) : pick(1, 20)) * pack.cell_q / 2;
    const Mesh meshes[] = {boxMesh(size, size / 2 + 1, size), wedgeMesh(size, size * 2, size / 2 + 1),
                           tetrahedronMesh(size), archMesh(size * 2, size, size), bladeMesh(size * 2, size)};
    addBody(pack, meshes[pick(0, 4)], pick(-3, width + 3) * pack.cell_q, pick(-3, height + 3) * pack.cell_q,
            pick(-200, 2500));
    Body& body = pack.bodies.back();
    body.force_n = oneOf({0, 1, 3000, 200000, kForceLimit});
    if (pick(0, 3) == 0) body.first_scale_q16 = body.last_scale_q16 = pick(kFullScale / 3, kFullScale);
  }
  std::vector<Pose> poses = initialState({}, BaseTerrain(pack)).poses;
  std::vector<int> speed, growth;
  for (int i = 0; i < body_count; ++i) {
    speed.push_back(oneOf({0, 1, pack.cell_q / 3, pack.cell_q, pack.cell_q * 5 / 2}));
    growth.push_back(oneOf({0, 0, 0, 900, 12000}));
  }
  for (int tick = 0; tick < tick_count; ++tick) {
    for (int i = 0; i < body_count; ++i) {
      Pose& pose = poses[std::size_t(i)];
      if (pick(0, 3) == 0 || tick + 5 > tick_count) continue;  // now and then one stands, at the end all do
      const int far = speed[std::size_t(i)];
      pose = moved(pose, pick(-far / 2, far), pick(-far / 2, far), pick(-200, 150), pick(-1500, 1500));
      pose.pitch = Turn(pose.pitch + pick(-300, 300));
      pose.roll = Turn(pose.roll + pick(-300, 300));
      pose.spin = Turn(pose.spin + pick(0, 900));
      const int grown = growth[std::size_t(i)];
      pose.scale_q16 = std::clamp(pose.scale_q16 + pick(-grown, grown), 1, kFullScale);
    }
    world.ticks.push_back(poses);
  }
  if (pick(0, 2) == 0) world.change = std::size_t(pick(0, tick_count - 1));
  addCraters(world, seed);
  addSnowfalls(world, seed);
  std::size_t crater_count = 0, snowfall_count = pack.snowfalls.size();
  for (const auto& snowfalls : world.snowfalls) snowfall_count += snowfalls.size();
  for (const auto& craters : world.craters) crater_count += craters.size();
  std::ostringstream text;
  text << "seed " << seed << ": " << width << " x " << height << " cells of " << pack.cell_q << ", soil "
       << pack.soil_depth_q << ", " << describe(pack.parameters);
  if (world.change != SIZE_MAX) text << "; in tick " << world.change + 1 << " now " << describe(world.changed);
  text << "; " << crater_count << " craters, " << snowfall_count << " snowfalls; bodies:";
  for (const Body& body : pack.bodies) text << ' ' << body.name;
  world.description = text.str();
  return world;
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
