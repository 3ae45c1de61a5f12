// spoor-bench errors: what each way to find the nearest free cell gets wrong, and how near each rule of evening out
// comes to the shape that soil rests in, beside their speed.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>
#include <stdexcept>

#include "shaders/rules/nearest.h"
#include "shared/base/statistics.h"
#include "shared/sim/native_stages.h"
#include "tests/bench/bench_measures.h"
#include "tests/bench/bench_pile.h"

namespace spoor {
namespace {

using Clock = std::chrono::steady_clock;

double millisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// What bodies overlap: 1 where a cell penetrates, kFree elsewhere.
struct Shape {
  std::string name;
  int side = 0;
  std::vector<std::int32_t> overlap;  // [side * side]
};

template <typename Covers>
Shape shapeOf(const std::string& name, int side, Covers covers) {
  Shape shape{name, side, std::vector<std::int32_t>(std::size_t(side) * std::size_t(side), rules::kFree)};
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      if (covers(x - side / 2, y - side / 2)) shape.overlap[std::size_t(y * side + x)] = 1;
  return shape;
}

bool inEllipse(double x, double y, double middle_x, double middle_y, double radius_x, double radius_y) {
  const double dx = (x - middle_x) / radius_x, dy = (y - middle_y) / radius_y;
  return dx * dx + dy * dy <= 1;
}

std::vector<Shape> makeShapes() {
  std::vector<Shape> shapes;
  shapes.push_back(shapeOf("disc, R = 200", 492, [](int x, int y) { return x * x + y * y <= 200 * 200; }));
  shapes.push_back(shapeOf("disc, R = 60", 163, [](int x, int y) { return x * x + y * y <= 60 * 60; }));
  std::mt19937 engine(7);
  std::vector<std::array<int, 3>> blobs;
  for (int i = 0; i < 120; ++i)
    blobs.push_back({int(engine() % 460) - 230, int(engine() % 460) - 230, 6 + int(engine() % 16)});
  shapes.push_back(shapeOf("120 blobs", 492, [&](int x, int y) {
    return std::ranges::any_of(blobs, [&](const auto& blob) {
      return (x - blob[0]) * (x - blob[0]) + (y - blob[1]) * (y - blob[1]) <= blob[2] * blob[2];
    });
  }));
  // A tread's lugs, 6 cells wide and at an angle on either half, with grooves of 4 cells, and a rib in the middle.
  shapes.push_back(shapeOf("tyre tread", 320, [](int x, int y) {
    if (std::abs(x) > 140 || std::abs(y) > 40) return false;
    return std::abs(y) <= 4 || (x + std::abs(y) / 2 + 1000) % 10 < 6;
  }));
  shapes.push_back(shapeOf("foot", 320, [](int x, int y) {
    return inEllipse(x, y, -90, 0, 42, 36) || inEllipse(x, y, 60, 8, 75, 48) ||
           (std::abs(x + 20) <= 60 && std::abs(y + 12) <= 22);
  }));
  shapes.push_back(shapeOf("random free cells, 1 %", 492, [&](int, int) { return engine() % 100 != 0; }));
  return shapes;
}

/// The native stage on a shape.
class NearestBench {
 public:
  NearestBench(const Settings& settings, const Shape& shape) : pool_(threadsOf(settings)), shape_(shape) {
    domain_.box = {0, 0, shape.side, shape.side};
    domain_.overlap = shape.overlap;
    for (int y = 0; y < shape.side; ++y) {
      const auto row = shape.overlap.begin() + y * shape.side;
      domain_.penetrating_in_row.push_back(int(std::count(row, row + shape.side, 1)));
      domain_.penetrating_count += domain_.penetrating_in_row.back();
    }
  }

  /// Targets of the penetrating cells, and the median time.
  std::vector<std::int32_t> run(NearestSearch search, Metric metric, double& time_ms) {
    parameters_.nearest = search;
    parameters_.metric = metric;
    std::vector<double> times;
    for (int round = 0; round < 7; ++round) {
      const int tasks = (shape_.side + domain_.columnsPerTask() - 1) / domain_.columnsPerTask();
      domain_.stale_columns.assign(std::size_t(tasks), 1);
      const auto start = Clock::now();
      runNearest({pack_, 0, parameters_, kernels(), pool_, area_}, domain_);
      times.push_back(millisecondsSince(start));
    }
    time_ms = percentile(times, 0.5);
    return domain_.target;
  }

  int queriedCount() const { return domain_.penetrating_count; }

 private:
  static int threadsOf(const Settings& settings) {
    return settings.engine.thread_count > 0 ? settings.engine.thread_count
                                            : std::max(1, int(std::thread::hardware_concurrency()));
  }
  ThreadPool pool_;
  const Shape& shape_;
  ScenePack pack_;
  Parameters parameters_;
  WorkArea area_;
  DomainWork domain_;
};

double distanceOf(const Shape& shape, int cell, int target, Metric metric) {
  const int distance = rules::metricDistance(cell % shape.side - target % shape.side,
                                             cell / shape.side - target / shape.side, int(metric));
  return metric == Metric::euclidean ? std::sqrt(double(distance)) : distance;
}

/// Checks targets that should be exact on every 997th cell against a search over all.
bool isExact(const Shape& shape, const std::vector<std::int32_t>& target, Metric metric) {
  for (int cell = 0; cell < shape.side * shape.side; cell += 997) {
    if (shape.overlap[std::size_t(cell)] <= 0) continue;
    double nearest = 1e9;
    for (int other = 0; other < shape.side * shape.side; ++other)
      if (shape.overlap[std::size_t(other)] == rules::kFree)
        nearest = std::min(nearest, distanceOf(shape, cell, other, metric));
    if (distanceOf(shape, cell, target[std::size_t(cell)], metric) != nearest) return false;
  }
  return true;
}

void measureSearches(const Settings& settings, const Shape& shape, Metric metric, const char* metric_name,
                     Report& report) {
  constexpr std::pair<NearestSearch, const char*> kVariants[] = {{NearestSearch::jump_flooding, "JFA"},
                                                                 {NearestSearch::jump_flooding_plus_1, "JFA+1"},
                                                                 {NearestSearch::jump_flooding_plus_2, "JFA+2"},
                                                                 {NearestSearch::one_plus_jump_flooding, "1+JFA"},
                                                                 {NearestSearch::jump_flooding_squared, "JFA^2"}};
  NearestBench bench(settings, shape);
  double exact_ms = 0;
  const std::vector<std::int32_t> exact = bench.run(NearestSearch::exact, metric, exact_ms);
  if (!isExact(shape, exact, metric)) report.faults.push_back(shape.name + ": the exact search is not exact");
  std::printf("  %-24s %-10s exact   %8.3f ms  %d cells\n", shape.name.c_str(), metric_name, exact_ms,
              bench.queriedCount());
  for (const auto& [variant, name] : kVariants) {
    double time_ms = 0;
    const std::vector<std::int32_t> found = bench.run(variant, metric, time_ms);
    std::int64_t wrong = 0;
    double worst = 0;
    for (std::size_t cell = 0; cell < found.size(); ++cell) {
      if (shape.overlap[cell] <= 0) continue;
      const double excess = found[cell] == rules::kNoTarget ? 1e9
                                                            : distanceOf(shape, int(cell), found[cell], metric) -
                                                                  distanceOf(shape, int(cell), exact[cell], metric);
      if (excess < 0) report.faults.push_back(shape.name + ": " + name + " finds a nearer cell than the exact search");
      wrong += excess > 0 ? 1 : 0;
      worst = std::max(worst, excess);
    }
    std::printf("  %-24s %-10s %-7s %8.3f ms  x %5.2f  %8.4f %% wrong, at worst %.3f cells too far\n", "", "", name,
                time_ms, time_ms / exact_ms, 100.0 * double(wrong) / bench.queriedCount(), worst);
  }
}

constexpr std::int64_t kSweepMarks[] = {10, 40, 160, 640, 2560};
constexpr int kSweepsPerTick = 10;

void measureRule(const Settings& settings, SlopeRule rule, double roughness, const std::string& name, Report& report) {
  BenchScene scene = makeBenchScene("small_pile");
  scene.pack.parameters.slopes = rule;
  scene.pack.parameters.materials[0].roughness_q16 = std::int32_t(roughness * kOneQ16);
  scene.pack.parameters.sweeps_per_tick = kSweepsPerTick;
  scene.id = packId(encodePack(scene.pack));
  auto backend = openEngine(settings.engine);
  if (!backend) throw std::runtime_error(backend.error());
  const BaseTerrain base(scene.pack);
  Simulation simulation(base, startOf(scene, base), std::move(*backend));
  double relax_ms = 0;
  std::int64_t sweeps = 0;
  const auto print = [&](const char* state) {
    const PileShape shape = pileShape(simulation.state(), scene.pack);
    std::printf("  %-26s %6lld sweeps%-9s %9.1f ms  excess %8.2f %%  shape %6.2f %%  round to %.3f  centroid %.3f\n",
                name.c_str(), static_cast<long long>(sweeps), state, relax_ms, 100 * shape.steepest_excess,
                100 * shape.shape_error, shape.azimuth_ratio, shape.centroid_cells);
  };
  for (const std::int64_t mark : kSweepMarks) {
    while (sweeps < mark) {
      auto result = simulation.step({});
      if (!result) throw std::runtime_error(result.error());
      if (result->ledger.error() != 0) report.faults.push_back(name + ": the ledger is off");
      relax_ms += result->effect.stage_ms[int(Stage::relax)];
      sweeps += kSweepsPerTick;
      if (!simulation.state().tiles.awake().empty()) continue;
      print(" at rest");
      return;
    }
    print("");
  }
}

}  // namespace

void measureErrors(const Settings& settings, Report& report) {
  std::printf("Nearest free cell, native, %s\n", kernels().name);
  for (const Shape& shape : makeShapes())
    for (const auto& [metric, name] : {std::pair{Metric::euclidean, "Euclidean"},
                                       {Metric::manhattan, "Manhattan"},
                                       {Metric::chebyshev, "Chebyshev"}})
      measureSearches(settings, shape, metric, name, report);
  std::printf("\nA cone twice as steep as it rests, 128 cells across, on level ground\n");
  measureRule(settings, SlopeRule::exchange, 1, "exchange", report);
  for (const double roughness : {1.0, 0.5, 0.1}) {
    char text[32];
    std::snprintf(text, sizeof text, ", roughness %.1f", roughness);
    measureRule(settings, SlopeRule::flux, roughness, std::string("flux") + text, report);
    measureRule(settings, SlopeRule::interleaved, roughness, std::string("thesis") + text, report);
  }
  std::printf("\n");
}

}  // namespace spoor
