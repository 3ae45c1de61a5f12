// Parameters, materials, craters, snowfalls and whole worlds of a seed.
#include <algorithm>
#include <random>
#include <sstream>

#include "tests/scenes.h"

namespace spoor::test {

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
  Parameters drifting = p;  // as whoever changes the rule needs it, too
  drifting.slopes = SlopeRule::drift;
  while (sweepsOf(drifting) > 40) drifting.drift_step_q16 /= 2;
  p.drift_step_q16 = drifting.drift_step_q16;
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

}  // namespace spoor::test
