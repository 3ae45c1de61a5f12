#include "tests/bench/bench_series.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>

#include "shared/base/json.h"
#include "shared/base/statistics.h"

namespace spoor {
namespace {

// Stages that a backend runs, from `active` to `hash`: those that move the bytes it counts.
constexpr int kFirstMovingStage = int(Stage::active), kLastMovingStage = int(Stage::hash);

/// A scene on its way, on one engine.
class Runner {
 public:
  Runner(const BenchScene& scene, const Engine& engine)
      : scene_(&scene), base_(scene.pack), script_(base_), simulation_(base_, startOf(scene, base_), open(engine)) {
    series_.scene = scene.pack.name;
    series_.label = engine.on_gl ? "gl" : "native";
    series_.backend = simulation_.backend().name();
    series_.skip_settled = engine.skip_settled;
    series_.map_cells = std::int64_t(scene.pack.width_cells) * scene.pack.height_cells;
  }
  Runner(const Runner&) = delete;
  Runner& operator=(const Runner&) = delete;

  void step(std::int32_t tick) {
    const auto poses = posesOf(*scene_, script_, tick);
    StageTimes whole{};
    const Result<TickResult> result = [&] {
      StageTimer timer(whole, Stage::commands);
      return simulation_.step(poses);
    }();
    if (!result) throw std::runtime_error(series_.backend + ": " + result.error());
    series_.hashes.push_back(result->update.state_hash);
    series_.ledger_error += std::abs(result->ledger.error());
    if (tick > 1) count(*result, whole[0]);
  }

  Series take() {
    series_.ledger = simulation_.state().ledger;
    series_.live_tiles = std::int64_t(simulation_.state().tiles.size());
    series_.store_bytes = std::int64_t(simulation_.state().tiles.memoryBytes());
    series_.memory = simulation_.backend().memory();
    return std::move(series_);
  }

 private:
  static std::unique_ptr<Backend> open(const Engine& engine) {
    auto backend = openEngine(engine);
    if (!backend) throw std::runtime_error(backend.error());
    return std::move(*backend);
  }

  void count(const TickResult& result, double tick_ms) {
    const TickEffect& effect = result.effect;
    series_.tick_ms.push_back(tick_ms);
    for (int stage = 0; stage < kStageCount; ++stage) series_.stage_ms[stage].push_back(effect.stage_ms[stage]);
    const double relax_ms = effect.stage_ms[int(Stage::relax)];
    if (effect.active_cells > 0 && relax_ms > 0)
      series_.relax_rate.push_back(double(effect.active_cells) * scene_->pack.parameters.sweeps_per_tick / relax_ms /
                                   1e3);
    series_.dispatches.push_back(effect.dispatches);
    series_.domain_cells += effect.domain_cells;
    series_.active_cells += effect.active_cells;
    series_.penetrating_cells += effect.penetrating_cells;
    series_.pairs_visited += effect.pairs_visited;
    series_.bytes_moved += effect.bytes_moved;
    series_.relax_bytes += effect.relax_bytes;
    series_.bytes_to_device += effect.bytes_to_device;
    series_.bytes_from_device += effect.bytes_from_device;
    series_.delta_bytes += std::int64_t(result.update.tiles.size());
  }

  const BenchScene* scene_;
  BaseTerrain base_;
  Script script_;
  Simulation simulation_;
  Series series_;
};

double sum(const std::vector<double>& values) {
  double total = 0;
  for (const double value : values) total += value;
  return total;
}

double ratio(double part, double whole) { return whole > 0 ? part / whole : 0; }

/// 10^9 bytes per second.
double gbPerSecond(double bytes, double time_ms) { return ratio(bytes, time_ms * 1e6); }

std::string cellText(const Figure& figure) {
  char text[32];
  if (figure.value == 0)
    std::snprintf(text, sizeof text, "-");
  else if (figure.whole)
    std::snprintf(text, sizeof text, "%.0f", figure.value);
  else
    std::snprintf(text, sizeof text, figure.value < 100 ? "%.3f" : "%.1f", figure.value);
  return text;
}

}  // namespace

std::vector<Series> runTogether(const std::vector<BenchScene>& scenes, const std::vector<Engine>& engines,
                                std::int64_t tick_count) {
  std::vector<std::unique_ptr<Runner>> runners;
  for (const BenchScene& scene : scenes)
    for (const Engine& engine : engines) runners.push_back(std::make_unique<Runner>(scene, engine));
  for (std::int32_t tick = 1; tick <= tick_count; ++tick)
    for (const auto& runner : runners) runner->step(tick);
  std::vector<Series> result;
  for (const auto& runner : runners) result.push_back(runner->take());
  return result;
}

std::vector<Series> runTogether(const BenchScene& scene, const std::vector<Engine>& engines, std::int64_t tick_count) {
  return runTogether(std::vector{scene}, engines, tick_count);
}

std::vector<std::string> faultsOf(const Series& series, const Series& expected) {
  std::vector<std::string> faults;
  const std::string what = series.scene + ", " + series.label + ": ";
  if (series.ledger_error != 0) faults.push_back(what + "the ledger is off by " + std::to_string(series.ledger_error));
  const auto other = std::ranges::mismatch(series.hashes, expected.hashes);
  if (other.in1 != series.hashes.end() && other.in2 != expected.hashes.end())
    faults.push_back(what + "after tick " + std::to_string(other.in1 - series.hashes.begin() + 1) + " the hash is " +
                     hexText(*other.in1) + ", with " + expected.label + " it is " + hexText(*other.in2));
  return faults;
}

std::vector<Figure> figuresOf(const Series& series) {
  const double ticks = double(std::max<std::size_t>(series.tick_ms.size(), 1));
  const auto perTick = [ticks](std::int64_t total) { return double(total) / ticks; };
  std::vector<Figure> figures;
  const auto add = [&](std::string key, std::string label, double value, bool whole = false, bool compared = false) {
    figures.push_back({std::move(key), std::move(label), value, whole, compared});
  };
  double stages_ms = 0;
  for (int stage = 0; stage < kStageCount; ++stage) {
    const std::string name = kStageNames[stage];
    add(name + "_ms", name + ", ms (median)", percentile(series.stage_ms[stage], 0.5), false, true);
    if (stage >= kFirstMovingStage && stage <= kLastMovingStage) stages_ms += sum(series.stage_ms[stage]);
  }
  add("tick_ms_median", "whole tick, ms (median)", percentile(series.tick_ms, 0.5), false, true);
  add("tick_ms_99", "whole tick, ms (99th percentile)", percentile(series.tick_ms, 0.99), false, true);
  add("relax_m_cells_per_s", "relax, M cell-iterations/s", percentile(series.relax_rate, 0.5), false, true);

  std::int64_t dispatches = 0;
  for (const std::int64_t count : series.dispatches) dispatches += count;
  add("dispatches_per_tick", "dispatches per tick", perTick(dispatches), true);
  const double moved = double(series.bytes_moved), stages_rate = gbPerSecond(moved, stages_ms);
  add("bytes_moved_per_tick", "bytes moved per tick", perTick(series.bytes_moved), true, true);
  add("stages_gb_per_s", "  of the stages, GB/s", stages_rate, false, true);
  add("relax_gb_per_s", "  of relax alone, GB/s", relaxRate(series), false, true);
  add("copy_gb_per_s", "  a copy on the device, GB/s", series.copy_gb_per_s);
  add("stages_roofline", "  stages' share of that", ratio(stages_rate, series.copy_gb_per_s));
  add("relax_roofline", "  relax's share of that", ratio(relaxRate(series), series.copy_gb_per_s));
  add("bytes_to_device_per_tick", "bytes to the device per tick", perTick(series.bytes_to_device), true);
  add("bytes_from_device_per_tick", "bytes from the device per tick", perTick(series.bytes_from_device), true);
  add("delta_bytes_per_tick", "bytes of changes per tick, not compressed", perTick(series.delta_bytes), true);
  add("domain_cells", "domain cells per tick", perTick(series.domain_cells), true);
  add("active_cells", "active cells per tick", perTick(series.active_cells), true);
  add("penetrating_cells", "penetrating cells per tick", perTick(series.penetrating_cells), true);
  add("pairs_visited", "pairs visited per tick", perTick(series.pairs_visited), true, true);

  const double live_cells = double(series.live_tiles) * rules::kTileCells;
  const double host_bytes = double(series.store_bytes + series.memory.host_bytes);
  const double device_bytes = double(series.memory.device_bytes);
  add("live_tiles", "live tiles", double(series.live_tiles), true);
  add("store_bytes", "host: bytes of the tile store", double(series.store_bytes), true);
  add("host_bytes", "host: bytes of store and backend", host_bytes, true, true);
  add("host_bytes_per_live_cell", "  per cell of live tiles", ratio(host_bytes, live_cells));
  add("host_bytes_per_map_cell", "  per cell of the whole map", ratio(host_bytes, double(series.map_cells)));
  add("device_bytes", "device: bytes of the backend", device_bytes, true);
  add("device_bytes_per_live_cell", "  per cell of live tiles", ratio(device_bytes, live_cells));
  add("device_bytes_per_map_cell", "  per cell of the whole map", ratio(device_bytes, double(series.map_cells)));
  return figures;
}

double relaxRate(const Series& series) {
  return gbPerSecond(double(series.relax_bytes), sum(series.stage_ms[int(Stage::relax)]));
}

void printTable(const std::string& title, const std::vector<Series>& columns) {
  constexpr int kLabelWidth = 42, kColumnWidth = 17;
  std::printf("%s, %zu ticks\n", title.c_str(), columns.front().tick_ms.size());
  for (const Series& series : columns) std::printf("  %s: %s\n", series.label.c_str(), series.backend.c_str());
  std::printf("  %-*s", kLabelWidth, "");
  for (const Series& series : columns) std::printf(" %*s", kColumnWidth, series.label.c_str());
  const bool two = columns.size() == 2;
  if (two) std::printf(" %*s", kColumnWidth, (columns[1].label + "/" + columns[0].label).c_str());
  std::printf("\n");
  std::vector<std::vector<Figure>> figures;
  for (const Series& series : columns) figures.push_back(figuresOf(series));
  for (std::size_t row = 0; row < figures.front().size(); ++row) {
    if (std::ranges::all_of(figures, [row](const auto& column) { return column[row].value == 0; })) continue;
    std::printf("  %-*s", kLabelWidth, figures.front()[row].label.c_str());
    for (const auto& column : figures) std::printf(" %*s", kColumnWidth, cellText(column[row]).c_str());
    if (two && figures[0][row].compared && figures[0][row].value > 0)
      std::printf(" %*.2f", kColumnWidth, figures[1][row].value / figures[0][row].value);
    std::printf("\n");
  }
  std::printf("  %-*s", kLabelWidth, "hash after the last tick");
  for (const Series& series : columns) std::printf(" %*s", kColumnWidth, hexText(series.hashes.back()).c_str());
  std::printf("\n  %-*s", kLabelWidth, "ledger, units lost");
  for (const Series& series : columns) std::printf(" %*lld", kColumnWidth, static_cast<long long>(series.ledger_error));
  std::printf(
      "\n  for comparison, Persson 2019, 4.4: %d bytes (with storage buffers) or %d (iterative) per cell of the "
      "whole map,\n  textures of the deformation system on the device\n",
      kThesisBufferBytes, kThesisIterativeBytes);
}

}  // namespace spoor
