// spoor-bench tick: whole ticks by stages, and what they move and hold. spoor-bench bandwidth: what they could move.
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "shared/base/statistics.h"
#include "tests/bench/bench_measures.h"

namespace spoor {
namespace {

void addFaults(Report& report, const Series& series, const Series& expected) {
  for (std::string& fault : faultsOf(series, expected)) report.faults.push_back(std::move(fault));
}

void measureNative(const Settings& settings, const BenchScene& scene, Report& report) {
  std::fprintf(stderr, "measuring %s ...\n", scene.pack.name.c_str());
  Series series = runTogether(scene, {settings.engine}, settings.tick_count).front();
  std::fprintf(stderr, "checking %s against one thread, baseline kernels, every pair visited ...\n",
               scene.pack.name.c_str());
  const Series check = runTogether(scene, {plainest()}, settings.tick_count).front();
  addFaults(report, series, check);
  printTable(scene.pack.name, {series});
  std::printf("  check: %s takes %.3f ms (%.1f x) and gives %s\n\n", check.backend.c_str(),
              percentile(check.tick_ms, 0.5), percentile(check.tick_ms, 0.5) / percentile(series.tick_ms, 0.5),
              check.hashes == series.hashes ? "the same hash after every tick" : "OTHER HASHES");
  report.runs.push_back(std::move(series));
}

void measureGl(const Settings& settings, const BenchScene& scene, Report& report) {
  std::fprintf(stderr, "measuring %s, native and gl in turns ...\n", scene.pack.name.c_str());
  std::vector<Series> both = runTogether(scene, {nativeBeside(settings), settings.engine}, settings.tick_count);
  both[1].copy_gb_per_s = report.copy_gb_per_s;
  compareTimes(both[1], both[0]);
  addFaults(report, both[0], both[0]);
  addFaults(report, both[1], both[0]);
  printTable(scene.pack.name, both);
  std::printf("  check: gl gives %s\n\n",
              both[0].hashes == both[1].hashes ? "native's hash after every tick" : "OTHER HASHES THAN NATIVE");
  for (Series& series : both) report.runs.push_back(std::move(series));
}

}  // namespace

BenchScene loadScene(const std::string& name) {
  if (std::ranges::count(benchSceneNames(), name) > 0) return makeBenchScene(name);
  std::ifstream file(name, std::ios::binary);
  if (!file)
    throw std::runtime_error("scene " + name + ": neither a scene of the benchmark nor a pack that can be opened");
  const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(file), {}};
  auto pack = decodePack(bytes);
  if (!pack) throw std::runtime_error(name + ": " + pack.error());
  BenchScene scene;
  scene.pack = std::move(*pack);
  scene.id = packId(bytes);
  return scene;
}

Engine plainest() {
  Engine engine;
  engine.skip_settled = false;
  engine.thread_count = 1;
  engine.kernels = availableKernels().front();
  return engine;
}

Engine nativeBeside(const Settings& settings) {
  Engine engine;
  engine.skip_settled = settings.engine.skip_settled;
  engine.thread_count = settings.engine.thread_count;
  return engine;
}

void compareTimes(Series& series, const Series& beside) {
  const double beside_ms = percentile(beside.tick_ms, 0.5);
  series.tick_ratio = beside_ms > 0 ? percentile(series.tick_ms, 0.5) / beside_ms : 0;
}

void measureTicks(const Settings& settings, Report& report) {
  if (settings.engine.on_gl) measureBandwidth(settings, report);
  const std::vector<std::string> names =
      settings.scene.empty() ? std::vector<std::string>{"car491", "slab491"} : std::vector{settings.scene};
  for (const std::string& name : names) {
    const BenchScene scene = loadScene(name);
    if (settings.engine.on_gl)
      measureGl(settings, scene, report);
    else
      measureNative(settings, scene, report);
  }
}

void measureBandwidth(const Settings& settings, Report& report) {
  std::fprintf(stderr, "measuring the device's copy bandwidth ...\n");
  const auto rate = copyBandwidth(settings.engine.gl_device);
  if (!rate) throw std::runtime_error(rate.error());
  report.copy_gb_per_s = *rate;
  std::printf("copy bandwidth of device %s: %.1f GB/s, read and written\n\n", settings.engine.gl_device.c_str(), *rate);
}

}  // namespace spoor
