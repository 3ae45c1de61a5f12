// spoor-bench: times of the pipeline's stages, each run checked against a second one that must give the same hash.
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iterator>

#include "shaders/host/make_backend.h"
#include "shared/base/json.h"
#include "shared/base/options.h"
#include "shared/base/statistics.h"
#include "shared/sim/simulation.h"
#include "shared/world/script.h"
#include "tests/bench/bench_scenes.h"

namespace spoor {
namespace {

struct Settings {
  std::string backend = "native", scene, json, csv;
  std::int64_t ticks = 60, threads = 0;
};

struct Scene {
  ScenePack pack;
  PackId id;
};

struct Series {
  std::string scene, backend;
  std::vector<double> tick_ms;
  std::array<std::vector<double>, kStageCount> stage_ms;
  TickEffect last;
  std::int64_t bytes_moved = 0, delta_bytes = 0;
  std::uint64_t hash = 0;
  std::int64_t ledger_error = 0;
  std::size_t live_tiles = 0, memory_bytes = 0;
};

/// Runs a scene's scripted bodies; the first tick is warm-up and not in the figures.
Series runScene(const Settings& settings, const Scene& scene, const NativeOptions& options) {
  auto backend = settings.backend == "native"
                     ? Result<std::unique_ptr<Backend>>(makeNativeBackend(options))
                     : makeBackend({settings.backend, "auto", int(settings.threads)},
                                   [](const std::string& line) { std::fprintf(stderr, "%s\n", line.c_str()); });
  if (!backend) throw std::runtime_error(backend.error());
  const BaseTerrain base(scene.pack);
  const Script script(base);
  Simulation simulation(base, scene.id, std::move(*backend));
  Series series{scene.pack.name, simulation.backend().name(), {}, {}, {}, 0, 0, 0, 0, 0, 0};
  for (std::int32_t tick = 1; tick <= settings.ticks; ++tick) {
    const auto poses = script.poses(tick);
    StageTimes whole{};
    Result<TickResult> result = [&] {
      StageTimer timer(whole, Stage::commands);
      return simulation.step(poses);
    }();
    if (!result) throw std::runtime_error(result.error());
    series.ledger_error += std::abs(simulation.state().ledger.error());
    if (tick == 1) continue;
    series.tick_ms.push_back(whole[0]);
    for (int stage = 0; stage < kStageCount; ++stage) series.stage_ms[stage].push_back(result->effect.stage_ms[stage]);
    series.bytes_moved += result->effect.bytes_moved;
    series.delta_bytes += std::int64_t(result->update.tiles.size());
    series.last = std::move(result->effect);
    series.hash = result->update.state_hash;
  }
  series.live_tiles = simulation.state().tiles.size();
  series.memory_bytes = simulation.state().tiles.memoryBytes();
  return series;
}

void print(const Series& series) {
  const auto ticks = std::int64_t(series.tick_ms.size());
  std::printf("%s, %s, %lld ticks: tick %.3f ms median, %.3f ms 99th percentile\n", series.scene.c_str(),
              series.backend.c_str(), static_cast<long long>(ticks), percentile(series.tick_ms, 0.5),
              percentile(series.tick_ms, 0.99));
  for (int stage = 0; stage < kStageCount; ++stage)
    if (percentile(series.stage_ms[stage], 1) > 0)
      std::printf("  %-12s %8.3f ms\n", kStageNames[stage], percentile(series.stage_ms[stage], 0.5));
  std::printf("  cells: domain %lld, active %lld, penetrating %lld; pairs visited %lld\n",
              static_cast<long long>(series.last.domain_cells), static_cast<long long>(series.last.active_cells),
              static_cast<long long>(series.last.penetrating_cells), static_cast<long long>(series.last.pairs_visited));
  std::printf("  bytes moved %.2f MB/tick, delta %lld B/tick before compression, live tiles %zu, store %.2f MB\n",
              double(series.bytes_moved) / double(std::max<std::int64_t>(ticks, 1)) / 1e6,
              static_cast<long long>(series.delta_bytes / std::max<std::int64_t>(ticks, 1)), series.live_tiles,
              double(series.memory_bytes) / 1e6);
  std::printf("  hash %s, ledger error %lld\n", hexText(series.hash).c_str(),
              static_cast<long long>(series.ledger_error));
}

void writeJson(JsonWriter& json, const Series& series) {
  const auto ticks = std::max<std::int64_t>(std::int64_t(series.tick_ms.size()), 1);
  json.beginObject();
  json.value("scene", series.scene);
  json.value("backend", series.backend);
  json.value("ticks", std::int64_t(series.tick_ms.size()));
  json.value("tick_ms_median", percentile(series.tick_ms, 0.5));
  json.value("tick_ms_99", percentile(series.tick_ms, 0.99));
  json.beginObject("stage_ms_median");
  for (int stage = 0; stage < kStageCount; ++stage)
    json.value(kStageNames[stage], percentile(series.stage_ms[stage], 0.5));
  json.end();
  json.value("domain_cells", series.last.domain_cells);
  json.value("active_cells", series.last.active_cells);
  json.value("penetrating_cells", series.last.penetrating_cells);
  json.value("bytes_moved_per_tick", series.bytes_moved / ticks);
  json.value("live_tiles", std::int64_t(series.live_tiles));
  json.value("store_bytes", std::int64_t(series.memory_bytes));
  json.hash("hash", series.hash);
  json.value("ledger_error", series.ledger_error);
  json.end();
}

std::string csvLine(const Series& series) {
  std::string line = series.scene + "," + series.backend + "," + std::to_string(percentile(series.tick_ms, 0.5));
  for (const auto& stage : series.stage_ms) line += "," + std::to_string(percentile(stage, 0.5));
  return line + "," + std::to_string(series.last.domain_cells) + "," + hexText(series.hash) + "\n";
}

Scene loadScene(const std::string& name) {
  if (std::ranges::count(benchSceneNames(), name) > 0) {
    Scene scene{makeBenchScene(name), {}};
    scene.id = packId(encodePack(scene.pack));
    return scene;
  }
  std::ifstream file(name, std::ios::binary);
  if (!file)
    throw std::runtime_error("scene " + name + ": neither a scene of the benchmark nor a pack that can be opened");
  const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(file), {}};
  auto pack = decodePack(bytes);
  if (!pack) throw std::runtime_error(name + ": " + pack.error());
  return {std::move(*pack), packId(bytes)};
}

/// The plainest schedule there is: what every other run must equal.
NativeOptions plainest() { return {1, availableKernels().front(), false}; }

bool measureTicks(const Settings& settings, const std::vector<std::string>& names, JsonWriter& json, std::string& csv) {
  bool good = true;
  for (const std::string& name : names) {
    const Scene scene = loadScene(name);
    std::fprintf(stderr, "measuring %s ...\n", name.c_str());
    const Series series = runScene(settings, scene, {int(settings.threads), nullptr, true});
    std::fprintf(stderr, "checking %s against one thread, baseline kernels, every pair visited ...\n", name.c_str());
    const Series check = runScene(settings, scene, plainest());
    print(series);
    std::printf("  check: %s takes %.3f ms (%.1f x) and gives %s\n", check.backend.c_str(),
                percentile(check.tick_ms, 0.5), percentile(check.tick_ms, 0.5) / percentile(series.tick_ms, 0.5),
                check.hash == series.hash ? "the same hash" : "ANOTHER HASH");
    good = good && check.hash == series.hash && series.ledger_error == 0;
    writeJson(json, series);
    csv += csvLine(series);
  }
  return good;
}

/// The same car on level ground in a small and a large world: time and memory as ratios.
bool measureWorlds(const Settings& settings, JsonWriter& json, std::string& csv) {
  const Scene small = loadScene("car"), wide = loadScene("car_wide");
  std::vector<double> ratios;
  Series a, b;
  for (int round = 0; round < 7; ++round) {  // in turns, so that a noisy machine disturbs both alike
    a = runScene(settings, small, {int(settings.threads), nullptr, true});
    b = runScene(settings, wide, {int(settings.threads), nullptr, true});
    ratios.push_back(percentile(b.tick_ms, 0.5) / percentile(a.tick_ms, 0.5));
  }
  const bool same =
      a.hash == runScene(settings, small, plainest()).hash && b.hash == runScene(settings, wide, plainest()).hash;
  print(a);
  print(b);
  std::printf("check: the plainest schedule gives %s\n", same ? "the same hashes" : "OTHER HASHES");
  std::printf(
      "65 536^2 against 2048^2: time x %.3f (median of 7 rounds), store memory x %.3f, live tiles %zu and %zu\n",
      percentile(ratios, 0.5), double(b.memory_bytes) / double(a.memory_bytes), b.live_tiles, a.live_tiles);
  writeJson(json, a);
  writeJson(json, b);
  csv += csvLine(a) + csvLine(b);
  return same && a.ledger_error == 0 && b.ledger_error == 0 && double(b.memory_bytes) <= 1.1 * double(a.memory_bytes);
}

/// Cell-iterations per second of plain sweeps: the slab's domain at work, nothing skipped against settled pairs
/// skipped.
bool measureRelax(const Settings& settings, JsonWriter& json, std::string& csv) {
  const Scene scene = loadScene("slab491");
  bool good = true;
  std::uint64_t hash = 0;
  for (const Kernels* set : availableKernels())
    for (const bool skip : {false, true}) {
      const Series series = runScene(settings, scene, {int(settings.threads), set, skip});
      const double sweeps_per_s =
          scene.pack.sweeps_per_tick / (percentile(series.stage_ms[int(Stage::relax)], 0.5) / 1e3);
      std::printf("%-30s %-22s relax %7.3f ms, %6.0f M cell-iterations/s, hash %s\n", series.backend.c_str(),
                  skip ? "settled pairs skipped" : "every pair visited",
                  percentile(series.stage_ms[int(Stage::relax)], 0.5),
                  sweeps_per_s * double(series.last.active_cells) / 1e6, hexText(series.hash).c_str());
      good = good && series.ledger_error == 0 && (hash == 0 || hash == series.hash);
      hash = series.hash;
      writeJson(json, series);
      csv += csvLine(series);
    }
  return good;
}

int run(int argc, char** argv) {
  Settings settings;
  std::vector<std::string> what;
  Options options("spoor-bench", "times of the pipeline, checked by hash");
  options.addPlain("tick|relax|world",
                   "a whole tick by stages; sweeps by kernel set; one car in a small and a large world [tick]", &what,
                   1);
  options.add("scene", "NAME|PACK", "scene of the benchmark, or a pack file; car491 and slab491 where none is named",
              &settings.scene);
  options.add("backend", "NAME", "auto or native", &settings.backend);
  options.add("ticks", "N", "ticks of each run", &settings.ticks, 2, 1000000);
  options.add("threads", "N", "0: one for each processor", &settings.threads, 0, 256);
  options.add("json", "FILE", "also write the figures there", &settings.json);
  options.add("csv", "FILE", "also write medians there, a line for each run", &settings.csv);
  options.parseOrExit(argc, argv);
  const std::string kind = what.empty() ? "tick" : what.front();
  JsonWriter json;
  json.beginObject();
  json.beginArray("runs");
  std::string csv = "scene,backend,tick_ms";
  for (const char* stage : kStageNames) csv += std::string(",") + stage + "_ms";
  csv += ",domain_cells,hash\n";
  bool good = false;
  if (kind == "tick") {
    good = measureTicks(
        settings, settings.scene.empty() ? std::vector<std::string>{"car491", "slab491"} : std::vector{settings.scene},
        json, csv);
  } else if (kind == "relax") {
    good = measureRelax(settings, json, csv);
  } else if (kind == "world") {
    good = measureWorlds(settings, json, csv);
  } else {
    std::fprintf(stderr, "spoor-bench: '%s' is none of tick, relax, world (see --help)\n", kind.c_str());
    return 2;
  }
  json.end();
  json.value("good", good);
  json.end();
  if (!settings.json.empty())
    if (Status status = json.writeFile(settings.json); !status) throw std::runtime_error(status.error());
  if (!settings.csv.empty() && !(std::ofstream(settings.csv) << csv))
    throw std::runtime_error("cannot write " + settings.csv);
  if (!good) std::fprintf(stderr, "spoor-bench: a hash or a ledger is wrong\n");
  return good ? 0 : 1;
}

}  // namespace
}  // namespace spoor

int main(int argc, char** argv) {
  try {
    return spoor::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "spoor-bench: %s\n", error.what());
    return 1;
  }
}
