// spoor-bench snow: what snowfall costs: where nobody is, on ground that was reached and rests, and where it slides.
#include <chrono>
#include <cstdio>
#include <stdexcept>

#include "shared/base/statistics.h"
#include "tests/bench/bench_measures.h"

namespace spoor {
namespace {

/// Ground 2^24 cells long; rolling dunes, or level.
BenchScene snowScene(bool dunes, bool snows) {
  BenchScene scene;
  ScenePack& pack = scene.pack;
  pack.name = "snow";
  pack.cell_q = 100;
  pack.width_cells = kWorldCellsLimit;
  pack.height_cells = 1 << 13;
  pack.soil_depth_q = 10000;
  pack.noise = {1, std::int64_t(1) << 26, 2, 0, dunes ? 2000 : 0};
  pack.parameters.materials[0].slope_threshold_q = 70;
  pack.parameters.materials[0].diagonal_threshold_q = 98;
  if (snows) pack.snowfalls = {{{0, 0, pack.width_cells, pack.height_cells}, std::int64_t(1) << 29, 1, 1 << 20, 7}};
  if (Status status = validatePack(pack); !status) throw std::runtime_error(status.error());
  scene.id = packId(encodePack(pack));
  return scene;
}

/// What lies on the tiles that were reached.
enum class Reached { nothing, level, cones };

void measureTicks(const Settings& settings, const char* name, Reached reached, int side_tiles, bool snows,
                  Report& report) {
  const BenchScene scene = snowScene(reached == Reached::cones, snows);
  auto backend = openEngine(settings.engine);
  if (!backend) throw std::runtime_error(backend.error());
  const BaseTerrain base(scene.pack);
  WorldState state = initialState(scene.id, base);
  if (side_tiles > 0)
    heapSoil(base, {0, 0, side_tiles * rules::kTileSize, side_tiles * rules::kTileSize}, state,
             [&](std::int32_t x, std::int32_t y) {
               // A cone on every tile, a little steeper than it rests.
               const std::int32_t dx = x % rules::kTileSize - 32, dy = y % rules::kTileSize - 32;
               const std::int32_t distance = std::max(std::abs(dx), std::abs(dy));
               return reached == Reached::cones ? std::max(80 * (16 - distance), 0) : 0;
             });
  Simulation simulation(base, std::move(state), std::move(*backend));
  // To rest, and then on.
  const std::int32_t ticks = std::int32_t(settings.tick_count);
  std::vector<double> times;
  std::int64_t active = 0;
  std::size_t live_before = 0;
  for (std::int32_t tick = 1; tick <= 400 + ticks; ++tick) {
    const auto start = std::chrono::steady_clock::now();
    auto result = simulation.step({});
    if (!result) throw std::runtime_error(result.error());
    if (result->ledger.error() != 0) report.faults.push_back(std::string("snow, ") + name + ": the ledger is off");
    if (tick <= 400) {
      live_before = simulation.state().tiles.size();
      continue;
    }
    times.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
    active += result->effect.active_cells / rules::kTileCells;
  }
  double sum = 0;
  for (const double time : times) sum += time;
  const auto live = simulation.state().tiles.size();
  if (live != live_before && reached != Reached::cones)
    report.faults.push_back(std::string("snow, ") + name + ": tiles became live by themselves");
  std::printf("  %-34s %-8s live tiles %6zu, active %8.2f a tick; mean %8.4f ms, median %8.4f, 99th %8.4f\n", name,
              snows ? "snow" : "no snow", live, double(active) / double(times.size()), sum / double(times.size()),
              percentile(times, 0.5), percentile(times, 0.99));
}

}  // namespace

void measureSnow(const Settings& settings, Report& report) {
  std::printf(
      "A world of 2^24 x 2^13 cells of 1 cm; 1/8 unit of 0.1 mm falls in a tick (27 m an hour at 60 ticks a second)\n");
  for (const bool snows : {false, true}) {
    measureTicks(settings, "nobody was there", Reached::nothing, 0, snows, report);
    measureTicks(settings, "level ground that was reached", Reached::level, 32, snows, report);
    measureTicks(settings, "the same, cones that just rest", Reached::cones, 32, snows, report);
  }
  std::printf("\n");
}

}  // namespace spoor
