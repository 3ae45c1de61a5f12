#include "client/figure_scene.h"

#include <algorithm>
#include <span>
#include <utility>

#include "shared/world/script.h"

namespace spoor {

namespace {

constexpr std::int32_t kCell_q = 5000;
constexpr std::int32_t kSide_cells = 56;
constexpr std::int32_t kBoxSide_q = 22 * kCell_q;
constexpr std::int32_t kSoilDepth_q = 50000;
constexpr std::int32_t kPressTicks = 1;  // at once: the deeper, the more cells spread displacement uses
constexpr std::int32_t kPressDepth_q = 4000;
constexpr std::int32_t kMoveTicks = kPressedBoxTicks - kPressTicks;
constexpr std::int32_t kMove_q = kCell_q;  // along both axes

Mesh boxMesh() {
  const std::int32_t half = kBoxSide_q / 2, height = kBoxSide_q;
  Mesh mesh;
  mesh.name = "box";
  for (const std::int32_t z : {0, height})
    for (const std::int32_t y : {-half, half})
      for (const std::int32_t x : {-half, half}) mesh.vertices.push_back({x, y, z});
  const std::array<std::uint32_t, 4> faces[] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                                {1, 3, 7, 5}, {3, 2, 6, 7}, {2, 0, 4, 6}};
  for (const auto& [a, b, c, d] : faces) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  }
  deriveEdges(mesh);
  return mesh;
}

PackId idOf(const ScenePack& pack) { return packId(encodePack(pack)); }

}  // namespace

FigureScene::FigureScene(ScenePack pack, std::unique_ptr<Backend> backend)
    : pack_(std::make_unique<ScenePack>(std::move(pack))),
      base_(*pack_),
      script_(base_),
      reach_q_(bodyReaches(*pack_)),
      simulation_(base_, idOf(*pack_), std::move(backend)) {}

Status FigureScene::runTo(std::int32_t tick, const PosesAt& poses_at) {
  while (state().tick < tick) {
    const std::vector<Pose> poses = poses_at(state().tick + 1);
    const std::span<const Crater> craters = script_.craters(state().tick + 1);
    if (state().tick + 1 == tick) {
      auto plan = planTick(*pack_, reach_q_, state(), poses, state().parameters, craters);
      if (!plan) return Error{"tick " + std::to_string(tick) + ": " + plan.error()};
      active_ = std::move(plan->active);
    }
    if (const auto done = simulation_.step(poses, {}, craters); !done)
      return Error{"tick " + std::to_string(state().tick + 1) + ": " + done.error()};
  }
  return {};
}

Status FigureScene::runTo(std::int32_t tick) {
  return runTo(tick, [this](std::int32_t at) { return script_.poses(at); });
}

ScenePack pressedBoxPack(Displacement displacement, Metric metric) {
  ScenePack pack;
  pack.name = "pressed box";
  pack.width_cells = kSide_cells;
  pack.height_cells = kSide_cells;
  pack.cell_q = kCell_q;
  pack.soil_depth_q = kSoilDepth_q;
  pack.noise = {1, 1 << 20, 1, -kSoilDepth_q, -kSoilDepth_q};  // the ground lies at 0
  pack.parameters.displacement = displacement;
  pack.parameters.metric = metric;
  // As in the thesis. Where several free cells are nearest, as along a side at 45 degrees, jump flooding takes any; the
  // exact search takes the nearest by Euclid, which makes the metrics all but the same.
  pack.parameters.nearest = NearestSearch::jump_flooding;
  pack.parameters.sweeps_per_tick = 0;
  pack.meshes.push_back(boxMesh());
  // Two points say where the box faces; at no speed it stays at the first.
  const std::int32_t start_q = kSide_cells / 2 * kCell_q - kMove_q / 2;
  pack.paths.push_back({{{start_q, start_q}, {start_q + kCell_q, start_q + kCell_q}}, 0, 0, 0});
  Body body;
  body.name = "box";
  pack.bodies.push_back(body);
  return pack;
}

FigureScene::PosesAt pressedBoxPoses(const ScenePack& pack) {
  const BaseTerrain base(pack);
  const std::vector<Pose> start = Script(base).poses(0);
  return [start](std::int32_t tick) {
    std::vector<Pose> poses = start;
    poses[0].z_q -= kPressDepth_q * std::min(tick, kPressTicks) / kPressTicks;
    const std::int32_t moved_q = kMove_q * std::max(tick - kPressTicks, 0) / kMoveTicks;
    poses[0].x_q += moved_q;
    poses[0].y_q += moved_q;
    return poses;
  };
}

ScenePack craterLooksPack() {
  constexpr std::int32_t m = 10000;
  ScenePack pack;
  pack.name = "crater looks";
  pack.width_cells = 1536;
  pack.height_cells = 1024;
  pack.cell_q = 1000;
  pack.soil_depth_q = 20 * m;
  // Swells of some 60 m, with finer ones in them.
  pack.noise = {21, (std::int64_t(1) << 32) / 600, 4, -pack.soil_depth_q - m, -pack.soil_depth_q + m};
  pack.default_ticks = 1;
  pack.crater_limits.radius_q = 40 * m;
  pack.crater_limits.hash_cell_q = 25 * m;
  constexpr std::uint16_t kNoise_q16 = 18000;
  const auto add = [&](double x_m, double y_m, double inner_m, double crest_m, double rim_m, double depth_m) {
    const auto lengthOf = [](double value_m) { return std::int32_t(value_m * m); };
    const auto id = std::uint32_t(pack.craters.size());
    pack.craters.push_back({lengthOf(x_m), lengthOf(y_m), lengthOf(inner_m), lengthOf(crest_m), lengthOf(rim_m),
                            lengthOf(depth_m), std::uint16_t(id * 977 + 5), kNoise_q16, 1, id});
  };
  add(30.0, 30.0, 2.6, 4.6, 0.7, 1.7);
  add(75.0, 27.0, 2.8, 5.0, 0.8, 1.9);
  add(81.5, 31.0, 2.4, 4.2, 0.7, 1.6);
  add(40.0, 75.0, 5.0, 9.0, 2.6, 5.0);
  add(95.0, 75.0, 4.0, 4.0, 0.0, 0.7);
  return pack;
}

}  // namespace spoor
