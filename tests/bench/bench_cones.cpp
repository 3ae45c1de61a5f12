// spoor-bench cones: how a cone of each material comes to rest under each slope rule.
#include <cmath>
#include <cstdio>
#include <numbers>
#include <stdexcept>

#include "tests/bench/bench_measures.h"
#include "tests/bench/bench_pile.h"

namespace spoor {
namespace {

/// Angles of repose: the paper's three, and those that scenes/README.md gives for its presets.
struct ConeMaterial {
  const char* name;
  double repose_rad;
  double diffusion;
};
constexpr double kDegree = std::numbers::pi / 180;
constexpr ConeMaterial kMaterials[] = {{"mud", 0.4 * std::numbers::pi, 0.25},
                                       {"pebbles", std::numbers::pi / 3, 0.9},
                                       {"sand", std::numbers::pi / 4, 1},
                                       {"snow", 50 * kDegree, 0.5},
                                       {"dust", 40 * kDegree, 1},
                                       {"gravel", 38 * kDegree, 0.9}};

struct ConeRule {
  const char* name;
  SlopeRule rule;
  DriftWeights weights;
  double roughness;
};
constexpr ConeRule kRules[] = {{"exchange", SlopeRule::exchange, DriftWeights::slope, 1},
                               {"flux", SlopeRule::flux, DriftWeights::slope, 1},
                               {"interleaved, roughness 0.5", SlopeRule::interleaved, DriftWeights::slope, 0.5},
                               {"scatter, roughness 0.5", SlopeRule::scatter, DriftWeights::slope, 0.5},
                               {"drift by slope", SlopeRule::drift, DriftWeights::slope, 1},
                               {"drift by displacement", SlopeRule::drift, DriftWeights::displacement, 1}};

constexpr std::int64_t kMarks[] = {100, 1000, 10000, 40000};
constexpr int kSweepsPerTick = 20;

/// A cone twice as steep as it rests, on level ground of 5 cm cells.
BenchScene coneOf(const ConeMaterial& material, const ConeRule& rule) {
  BenchScene scene = makeBenchScene("small_pile");
  scene.pack.width_cells = scene.pack.height_cells = 256;
  scene.cone_radius_cells = 48;
  Parameters& parameters = scene.pack.parameters;
  parameters.slopes = rule.rule;
  parameters.drift_weights = rule.weights;
  parameters.sweeps_per_tick = kSweepsPerTick;
  MaterialRules& soil = parameters.materials[0];
  const double rests_q = std::tan(material.repose_rad) * scene.pack.cell_q;
  soil.slope_threshold_q = std::int32_t(rests_q);
  soil.diagonal_threshold_q = std::int32_t(rests_q * std::numbers::sqrt2);
  soil.repose_q16 = std::int32_t(std::lround(material.repose_rad * 2 / std::numbers::pi * kOneQ16));
  soil.diffusion_q16 = std::int32_t(std::lround(material.diffusion * kOneQ16));
  soil.roughness_q16 = std::int32_t(rule.roughness * kOneQ16);
  scene.id = packId(encodePack(scene.pack));
  return scene;
}

/// The slope at which a rule lets the material rest. By displacement: tan(slope) = alpha / D (rules/drift.h).
double restingAngle(const ConeMaterial& material, const ConeRule& rule) {
  return rule.rule == SlopeRule::drift && rule.weights == DriftWeights::displacement
             ? std::atan(material.repose_rad / material.diffusion)
             : material.repose_rad;
}

void measureCone(const Settings& settings, const ConeMaterial& material, const ConeRule& rule, Report& report) {
  const BenchScene scene = coneOf(material, rule);
  auto backend = openEngine(settings.engine);
  if (!backend) throw std::runtime_error(backend.error());
  const BaseTerrain base(scene.pack);
  Simulation simulation(base, startOf(scene, base), std::move(*backend));
  const std::int64_t volume = simulation.state().ledger.events;
  const double resting_deg = restingAngle(material, rule) / kDegree;
  double relax_ms = 0;
  std::int64_t sweeps = 0;
  bool at_rest = false;
  for (const std::int64_t mark : kMarks) {
    while (sweeps < mark && !at_rest) {
      auto result = simulation.step({});
      if (!result) throw std::runtime_error(result.error());
      relax_ms += result->effect.stage_ms[int(Stage::relax)];
      sweeps += sweepsOf(scene.pack.parameters);
      at_rest = simulation.state().tiles.awake().empty();
    }
    const PileShape shape = pileShape(simulation.state(), scene.pack);
    std::int64_t lies = 0;
    for (const Tile* tile : simulation.state().tiles.sorted()) {
      PlaneCells dormant;
      base.fillHeights(tile->at, dormant);
      for (int i = 0; i < rules::kTileCells; ++i) lies += tile->height()[std::size_t(i)] - dormant[std::size_t(i)];
    }
    std::printf(
        "  %-8s %-27s %6lld%s %9.1f ms  edge %+7.2f  flank %+7.2f deg  azimuth %.3f  shape %6.2f %%  volume %lld\n",
        material.name, rule.name, static_cast<long long>(sweeps), at_rest ? " at rest" : "        ", relax_ms,
        shape.edge_deg - resting_deg, shape.flank_deg - resting_deg, shape.azimuth_ratio, 100 * shape.shape_error,
        static_cast<long long>(lies - volume));
    if (lies != volume || simulation.state().ledger.error() != 0)
      report.faults.push_back(std::string(material.name) + ", " + rule.name + ": the volume changed");
    if (at_rest) return;
  }
}

}  // namespace

void measureCones(const Settings& settings, Report& report) {
  std::printf(
      "Cones twice as steep as they rest, 96 cells of 5 cm across, on level ground\n"
      "  sweeps and time in stage relax; the steepest edge and the mean gradient less the angle of repose "
      "(drift by displacement: less the\n  angle at which it lets soil rest); largest over smallest radius; "
      "difference from a round cone; volume error, 0.1 mm * cells\n");
  for (const ConeRule& rule : kRules)
    for (const ConeMaterial& material : kMaterials) measureCone(settings, material, rule, report);
  std::printf("\n");
}

}  // namespace spoor
