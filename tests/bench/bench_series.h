#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "shared/sim/simulation.h"
#include "tests/bench/bench_engine.h"
#include "tests/bench/bench_scenes.h"

namespace spoor {

/// What was measured of one scene on one engine. The first tick is warm-up: it is in the hashes only.
struct Series {
  std::string scene;
  std::string label;    // of its column: "native", "gl plain, every pair"
  std::string backend;  // as it names itself
  bool skip_settled = true;
  std::int64_t map_cells = 0;

  std::vector<std::uint64_t> hashes;  // after every tick
  std::int64_t ledger_error = 0;      // its size, of all ticks
  std::vector<double> tick_ms;
  std::array<std::vector<double>, kStageCount> stage_ms;
  std::vector<double> relax_rate;        // 10^6 cells swept per second
  std::vector<std::int64_t> dispatches;  // of each tick
  std::int64_t domain_cells = 0, active_cells = 0, penetrating_cells = 0, pairs_visited = 0;  // of all ticks
  std::int64_t bytes_moved = 0, relax_bytes = 0, bytes_to_device = 0, bytes_from_device = 0, delta_bytes = 0;

  // At the end.
  Ledger ledger;
  std::int64_t live_tiles = 0, store_bytes = 0;
  BackendMemory memory;

  double tick_ratio = 1;     // median of a tick over that of the series that it stands beside
  double copy_gb_per_s = 0;  // copyBandwidth of its device; 0: not measured
};

/// Runs a scene once on each engine, tick by tick in turns, so that a noisy machine disturbs all alike.
/// Throws std::runtime_error where an engine cannot be had or fails.
std::vector<Series> runTogether(const BenchScene& scene, const std::vector<Engine>& engines, std::int64_t tick_count);
/// The same for scenes of different size; one series for each scene and engine, engines fastest.
std::vector<Series> runTogether(const std::vector<BenchScene>& scenes, const std::vector<Engine>& engines,
                                std::int64_t tick_count);

/// What is wrong with the ledger, and where a series' hashes first differ from those of the one it must equal; a line
/// each.
std::vector<std::string> faultsOf(const Series& series, const Series& expected);

// Persson 2019, section 4.4: what the textures and the buffer of the thesis's deformation system take for each cell of
// the whole map, whatever part of it is touched.
inline constexpr int kThesisBufferBytes = 78;      // the approach with shader storage buffers
inline constexpr int kThesisIterativeBytes = 126;  // the approach with textures only

/// One number of a series.
struct Figure {
  std::string key;    // in JSON and CSV
  std::string label;  // in tables, with its unit
  double value = 0;
  bool whole = false;     // a count
  bool compared = false;  // worth a ratio
};
std::vector<Figure> figuresOf(const Series& series);

/// Bytes that the relaxation moved over its time, 10^9 per second.
double relaxRate(const Series& series);

/// Prints series side by side, a row for each figure that any of them has; where there are two, their ratio too.
void printTable(const std::string& title, const std::vector<Series>& columns);

}  // namespace spoor
