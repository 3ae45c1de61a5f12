// spoor-bench drift: the drift rule beside the published scheme (Gilardi, Watten and Newbury): what becomes of soil
// under steps of any size, how the error falls with cells and steps, and what a sweep takes.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <stdexcept>

#include "shared/base/json.h"
#include "shared/base/statistics.h"
#include "tests/bench/bench_measures.h"
#include "tests/bench/gilardi.h"

namespace spoor {
namespace {

using Clock = std::chrono::steady_clock;
using test::DriftField;

constexpr std::int32_t kCell_q = 500;
constexpr double kRepose = std::numbers::pi / 4;  // the paper's sand
constexpr double kFrictionInverse = 4e-4;
constexpr double kForce_n = 4000;                // on each cell beneath the body
constexpr int kBodyCells = 8;                    // a side
constexpr double kLevel = 30, kThinLevel = 0.1;  // soil over bedrock, cells
constexpr double kTime = 10;                     // of a run
constexpr double kFineStep = 0.005;
constexpr double kSteps[] = {0.05, 0.1, 0.25, 0.3125, 0.5, 1, 2, 5, 10};

/// Soil over level bedrock, in cells: its height at a place.
using Heap = double (*)(double x, double y);

/// What a run starts from.
struct Start {
  const char* name;
  int side = 128;
  double level = kLevel;
  Heap heap = nullptr;
  bool pushed = false;
};

double hump(double x, double y) { return 24 * std::exp(-(x * x + y * y) / 72); }
double column(double x, double y) { return std::abs(x) <= 8 && std::abs(y) <= 8 ? 12 : 0; }
double flat(double, double) { return 0; }

bool beneathBody(const Start& start, int x, int y) {
  const int first = start.side / 2 - kBodyCells / 2;
  return start.pushed && x >= first && y >= first && x < first + kBodyCells && y < first + kBodyCells;
}

DriftField fieldOf(const Start& start) {
  DriftField field;
  field.columns = field.rows = start.side;
  field.friction_inverse = kFrictionInverse;
  field.repose = kRepose;
  for (int y = 0; y < start.side; ++y)
    for (int x = 0; x < start.side; ++x) {
      const double heaped = start.heap(x - start.side / 2, y - start.side / 2);
      field.height.push_back(start.level + std::round(heaped * kCell_q) / kCell_q);
      field.force_x.push_back(beneathBody(start, x, y) ? kForce_n : 0);
    }
  field.force_y.assign(field.height.size(), 0);
  return field;
}

/// The same as a scene. The body stands in the bedrock and creeps along x by 0.1 mm a tick, so that it pushes the same
/// cells all the time.
BenchScene sceneOf(const Start& start, DriftWeights weights, double step) {
  BenchScene scene;
  ScenePack& pack = scene.pack;
  pack.name = start.name;
  pack.width_cells = pack.height_cells = start.side;
  pack.cell_q = kCell_q;
  pack.soil_depth_q = std::int32_t(std::lround(start.level * kCell_q));
  pack.noise = {1, 1, 1, 0, 0};
  Parameters& parameters = pack.parameters;
  parameters.slopes = SlopeRule::drift;
  parameters.displacement = Displacement::none;
  parameters.drift_weights = weights;
  parameters.drift_step_q16 = std::int32_t(std::lround(step * kOneQ16));
  parameters.sweeps_per_tick = 1;
  parameters.active_areas = 0;
  MaterialRules& soil = parameters.materials[0];
  soil.slope_threshold_q = std::int32_t(std::lround(std::tan(kRepose) * kCell_q));
  soil.repose_q16 = std::int32_t(std::lround(kRepose * 2 / std::numbers::pi * kOneQ16));
  soil.friction_inverse_q32 = std::int32_t(std::lround(kFrictionInverse * 4294967296.0));
  if (start.pushed) {
    constexpr std::int32_t reach = kBodyCells * kCell_q / 2 - 120;
    Mesh mesh{"pusher", {}, {{0, 1, 2}, {0, 2, 3}}, {}};
    for (const auto& [x, y] : {std::pair{-reach, -reach}, {reach, -reach}, {reach, reach}, {-reach, reach}})
      mesh.vertices.push_back({x, y, 0});
    deriveEdges(mesh);
    pack.meshes.push_back(std::move(mesh));
    const std::int32_t middle_q = start.side / 2 * kCell_q;
    pack.paths.push_back({{{middle_q - 100, middle_q}, {middle_q + kCell_q, middle_q}}, 1, 0, 0});
    Body body;
    body.sinkage_q = std::int32_t(kLevel) * kCell_q;
    body.force_n = std::int32_t(kForce_n * kBodyCells * kBodyCells);
    pack.bodies.push_back(body);
  }
  if (Status status = validatePack(pack); !status) throw std::runtime_error(status.error());
  scene.id = packId(encodePack(pack));
  return scene;
}

/// How a run ended.
struct Outcome {
  std::vector<double> height;  // cells
  double time_ms = 0;
  std::int64_t volume_error = 0;  // ours: of the ledger and of the sum, 0.1 mm * cells
};

Outcome runOurs(const Settings& settings, const Start& start, DriftWeights weights, double step, double time) {
  const BenchScene scene = sceneOf(start, weights, step);
  auto backend = openEngine(settings.engine);
  if (!backend) throw std::runtime_error(backend.error());
  const BaseTerrain base(scene.pack);
  const Script script(base);
  WorldState state = initialState(scene.id, base);
  heapSoil(base, {0, 0, start.side, start.side}, state, [&](std::int32_t x, std::int32_t y) {
    return std::int32_t(std::lround(start.heap(x - start.side / 2, y - start.side / 2) * kCell_q));
  });
  const std::int64_t before = state.ledger.ground;
  Simulation simulation(base, std::move(state), std::move(*backend));
  Outcome outcome;
  for (int tick = 1; tick <= int(std::lround(time / step)); ++tick) {
    auto result = simulation.step(script.poses(tick));
    if (!result) throw std::runtime_error(result.error());
    outcome.time_ms += result->effect.stage_ms[int(Stage::relax)];
    outcome.volume_error = std::max(outcome.volume_error, std::abs(result->ledger.error()));
  }
  std::int64_t after = 0;
  outcome.height.resize(std::size_t(start.side) * std::size_t(start.side));
  for (const Tile* tile : simulation.state().tiles.sorted())
    for (int i = 0; i < rules::kTileCells; ++i) {
      after += tile->height()[std::size_t(i)];
      const int x = tile->at.x * rules::kTileSize + i % rules::kTileSize;
      const int y = tile->at.y * rules::kTileSize + i / rules::kTileSize;
      if (x < start.side && y < start.side)
        outcome.height[std::size_t(y * start.side + x)] = double(tile->height()[std::size_t(i)]) / kCell_q;
    }
  outcome.volume_error = std::max(outcome.volume_error, std::abs(after - before));
  return outcome;
}

using Scheme = void (*)(DriftField& field, double step, DriftWeights weights);

Outcome runReal(Scheme scheme, const Start& start, DriftWeights weights, double step, double time) {
  DriftField field = fieldOf(start);
  const auto from = Clock::now();
  for (int i = 0; i < int(std::lround(time / step)); ++i) scheme(field, step, weights);
  return {std::move(field.height), std::chrono::duration<double, std::milli>(Clock::now() - from).count()};
}

/// Differences from a reference: summed, of the soil that the reference has off its level; and the largest, of its
/// highest.
struct Difference {
  double sum = 0, peak = 0;
};

Difference differenceOf(const std::vector<double>& height, const std::vector<double>& reference, double level) {
  double differences = 0, heaped = 0, largest = 0, highest = 0;
  for (std::size_t i = 0; i < height.size(); ++i) {
    const double difference = std::abs(height[i] - reference[i]);
    differences += difference;
    largest = std::max(largest, difference);
    heaped += std::abs(reference[i] - level);
    highest = std::max(highest, std::abs(reference[i] - level));
  }
  return {differences / heaped, largest / highest};
}

int belowBedrock(const std::vector<double>& height) {
  return int(std::ranges::count_if(height, [](double cell) { return !(cell >= -1e-9); }));
}

double highestOf(const std::vector<double>& height) {
  double highest = 0;
  for (const double cell : height) highest = std::max(highest, std::abs(cell));
  return highest;
}

const char* nameOf(DriftWeights weights) {
  return weights == DriftWeights::none ? "none" : weights == DriftWeights::slope ? "slope" : "displacement";
}

void printRun(const char* scheme, double step, const Outcome& run, const Outcome& thin, const Start& start,
              const std::vector<double>& reference) {
  double before = 0, after = 0;
  for (const double cell : fieldOf(start).height) before += cell;
  for (const double cell : run.height) after += cell;
  const double heaped = std::max(before - start.level * start.side * start.side, 1.0);
  const Difference difference = differenceOf(run.height, reference, start.level);
  std::printf(
      "    %-10s dt %6.4f  below bedrock %6d  highest %10.4g  volume %+11.4g %%  L1 %10.4g %%  peak %10.4g %%  %8.2f "
      "ms\n",
      scheme, step, belowBedrock(thin.height), highestOf(run.height), 100 * (after - before) / heaped,
      100 * difference.sum, 100 * difference.peak, run.time_ms);
}

void measureStability(const Settings& settings, const Start& start, DriftWeights weights, Report& report) {
  Start thin = start;
  thin.level = kThinLevel;
  const bool published = weights != DriftWeights::slope;
  std::printf("  %s, weights: %s\n", start.name, nameOf(weights));
  const std::vector<double> own = runReal(test::stepConserved, start, weights, kFineStep, kTime).height;
  if (published) {
    const std::vector<double> reference = runReal(test::stepGilardi, start, weights, kFineStep, kTime).height;
    for (const double step : kSteps)
      printRun("published", step, runReal(test::stepGilardi, start, weights, step, kTime),
               runReal(test::stepGilardi, thin, weights, step, kTime), start, reference);
  }
  for (const double step : kSteps) {
    const Outcome run = runOurs(settings, start, weights, step, kTime);
    const Outcome on_thin = runOurs(settings, thin, weights, step, kTime);
    printRun("ours", step, run, on_thin, start, own);
    const std::string name =
        std::string("drift, ") + start.name + ", " + nameOf(weights) + ", dt " + std::to_string(step);
    if (run.volume_error != 0 || on_thin.volume_error != 0) report.faults.push_back(name + ": the volume changed");
    if (differenceOf(run.height, own, start.level).sum > 0.01)
      report.faults.push_back(name + ": more than 1 % from the fine steps");
    if (belowBedrock(run.height) + belowBedrock(on_thin.height) > 0)
      report.faults.push_back(name + ": a cell lies below bedrock");
  }
}

double gWidth = 0;  // of wideGaussian, cells: a Heap takes no more than a place
double wideGaussian(double x, double y) { return 2000 * std::exp(-(x * x + y * y) / (2 * gWidth * gWidth)); }

/// A Gaussian diffuses until its variance is half as much again; more cells across it, the same step.
void measureConvergence(const Settings& settings) {
  std::printf(
      "Order of convergence, weights: none, D = 1: a Gaussian after a quarter of width^2, beside the analytic "
      "solution\n");
  Difference last;
  for (const double width : {4.0, 8.0, 16.0, 32.0}) {
    gWidth = width;
    const Start start{"gaussian", int(width) * 16, 300, wideGaussian, false};
    const double time = width * width / 4;
    const Outcome run = runOurs(settings, start, DriftWeights::none, 0.25, time);
    std::vector<double> analytic;
    for (int y = 0; y < start.side; ++y)
      for (int x = 0; x < start.side; ++x) {
        const double dx = x - start.side / 2, dy = y - start.side / 2;
        analytic.push_back(start.level + test::diffusedGaussian(2000, width, 1, time, dx * dx + dy * dy));
      }
    const Difference difference = differenceOf(run.height, analytic, start.level);
    std::printf("  width %4.0f cells, dt 0.25: L1 %9.6f %%  peak %9.6f %%  %9.2f ms", width, 100 * difference.sum,
                100 * difference.peak, run.time_ms);
    if (last.sum > 0)
      std::printf("   order %.2f, %.2f", std::log2(last.sum / difference.sum), std::log2(last.peak / difference.peak));
    std::printf("\n");
    last = difference;
  }
  gWidth = 8;
  const Start start{"gaussian", 128, 300, wideGaussian, false};
  const std::vector<double> fine = runReal(test::stepGilardi, start, DriftWeights::none, 1.0 / 1024, 16).height;
  std::printf("  the same of width 8 after 16 units of time, beside steps of 1/1024 in real numbers\n");
  for (const auto& [name, ours] : {std::pair{"published", false}, {"ours", true}}) {
    last = {};
    for (const double step : {0.125, 0.0625, 0.03125, 0.015625}) {
      const Outcome run = ours ? runOurs(settings, start, DriftWeights::none, step, 16)
                               : runReal(test::stepGilardi, start, DriftWeights::none, step, 16);
      const Difference difference = differenceOf(run.height, fine, start.level);
      std::printf("  %-9s dt %.5f: L1 %9.6f %%  peak %9.6f %%  %9.2f ms", name, step, 100 * difference.sum,
                  100 * difference.peak, run.time_ms);
      if (last.sum > 0)
        std::printf("   order %.2f, %.2f", std::log2(last.sum / difference.sum),
                    std::log2(last.peak / difference.peak));
      std::printf("\n");
      last = difference;
    }
  }
  std::printf("\n");
}

/// The paper's Table 1, its last row: one iteration over the whole grid.
void measureKernel(const Settings& settings, Report& report) {
  constexpr std::pair<int, double> kPaper[] = {{512, 0.58}, {1024, 2.09}, {2048, 7.97}};
  std::printf("Table 1, one iteration of the kernel alone: the paper's Quadro 2000, and stage relax here\n");
  for (const auto& [side, paper_ms] : kPaper) {
    gWidth = side / 16.0;
    const Start start{"gaussian", side, 300, wideGaussian, false};
    std::vector<Engine> engines{nativeBeside(settings)};
    if (settings.engine.on_gl) engines.push_back(settings.engine);
    std::uint64_t hash = 0;
    for (const Engine& engine : engines)
      for (const DriftWeights weights : {DriftWeights::none, DriftWeights::displacement, DriftWeights::slope}) {
        // Short enough that a sweep is one pass (driftSteps).
        BenchScene scene = sceneOf(start, weights, weights == DriftWeights::displacement ? 0.04 : 0.125);
        scene.pack.parameters.displacement = Displacement::direct;  // no bodies: nothing besides the sweep
        auto backend = openEngine(engine);
        if (!backend) throw std::runtime_error(backend.error());
        const BaseTerrain base(scene.pack);
        WorldState state = initialState(scene.id, base);
        heapSoil(base, {0, 0, side, side}, state, [&](std::int32_t x, std::int32_t y) {
          return std::int32_t(std::lround(start.heap(x - side / 2, y - side / 2) * kCell_q));
        });
        Simulation simulation(base, std::move(state), std::move(*backend));
        std::vector<double> times;
        std::uint64_t sum = 0;
        for (int tick = 0; tick < 9; ++tick) {
          auto result = simulation.step({});
          if (!result) throw std::runtime_error(result.error());
          times.push_back(result->effect.stage_ms[int(Stage::relax)]);
          sum = simulation.state().tiles_hash;
        }
        if (weights == DriftWeights::slope) {
          if (engine.on_gl && sum != hash) report.faults.push_back("drift kernel: gl and native differ");
          hash = sum;
        }
        std::printf("  %4d^2  paper %5.2f ms   %-6s weights %-12s %8.2f ms  %8.1f M cells/s, hash %s\n", side, paper_ms,
                    engine.on_gl ? "gl" : "native", nameOf(weights), percentile(times, 0.5),
                    double(side) * side / percentile(times, 0.5) / 1e3, hexText(sum).c_str());
      }
  }
  std::printf("\n");
}

}  // namespace

void measureDrift(const Settings& settings, Report& report) {
  std::printf(
      "Stability and error after %.0f units of time: sand of the paper (alpha pi/4, D 1, 1/zeta 4e-4), %.0f cell of "
      "soil over bedrock\n"
      "  below bedrock: on %.1f cells of soil; volume: change, of what was heaped up; L1, peak: differences from "
      "steps of %.3f of the same\n  equations (published: by cells; ours: over edges) in real numbers\n",
      kTime, kLevel, kThinLevel, kFineStep);
  const Start starts[] = {{"hump", 128, kLevel, hump, false},
                          {"column", 128, kLevel, column, false},
                          {"pushed by a body", 128, kLevel, flat, true}};
  for (const Start& start : starts)
    for (const DriftWeights weights : {DriftWeights::none, DriftWeights::displacement, DriftWeights::slope})
      measureStability(settings, start, weights, report);
  std::printf("\n");
  measureConvergence(settings);
  measureKernel(settings, report);
}

}  // namespace spoor
