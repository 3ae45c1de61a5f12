// spoor-bench thesis, Table 5.9: no soil is lost, whatever the parameters.
#include <algorithm>
#include <cstdio>
#include <stdexcept>
#include <string>

#include "shared/base/json.h"
#include "shared/base/kernels.h"
#include "tests/bench/bench_measures.h"

namespace spoor {
namespace {

constexpr std::int64_t kFrameCount = 5000, kEvery = 500;
// A software renderer takes most of an hour for all of them over the whole map.
constexpr std::int64_t kSoftwareFrameCount = 500, kSoftwareEvery = 50;

/// Sum of all heights of a world before anything moved.
std::int64_t baseSum(const BaseTerrain& base) {
  const TileCoordinate extent = tileExtent(base.pack());
  PlaneCells cells;
  std::int64_t sum = 0;
  for (std::int32_t y = 0; y < extent.y; ++y)
    for (std::int32_t x = 0; x < extent.x; ++x) {
      base.fillHeights({x, y}, cells);
      sum += kernels().sum(cells.data(), rules::kTileCells);
    }
  return sum;
}

/// One engine's way through the frames.
struct Volume {
  std::string label;
  std::vector<std::int64_t> sum;  // of soil over the whole world, after each printed frame
  std::vector<std::int64_t> compacted;
  std::int64_t every = 0;
  std::int64_t unequal_ticks = 0;
  std::uint64_t hash = 0;
};

Volume runFrames(const BenchScene& scene, const Engine& engine, std::int64_t frame_count, std::int64_t every) {
  auto backend = openEngine(engine);
  if (!backend) throw std::runtime_error(backend.error());
  const BaseTerrain base(scene.pack);
  const Script script(base);
  Simulation simulation(base, startOf(scene, base), std::move(*backend));
  const std::int64_t before = baseSum(base);
  Volume volume;
  volume.every = every;
  volume.label = engine.on_gl ? "gl" : "native";
  for (std::int32_t tick = 1; tick <= frame_count; ++tick) {
    auto result = simulation.step(posesOf(scene, script, tick));
    if (!result) throw std::runtime_error(result.error());
    volume.unequal_ticks += result->ledger.error() != 0 ? 1 : 0;
    if (tick % every != 0) continue;
    // Added up from the cells, not from the sums that the tick keeps.
    if (!recount(simulation.state())) ++volume.unequal_ticks;
    const Ledger& ledger = result->ledger;
    volume.sum.push_back(before - ledger.initial + ledger.ground + ledger.compacted);
    volume.compacted.push_back(ledger.compacted);
    if (tick % 1000 == 0) std::fprintf(stderr, "  frame %d\n", tick);
  }
  volume.hash = stateHash(simulation.state());
  return volume;
}

bool isSoftware(const Engine& engine) {
  const auto backend = openEngine(engine);
  return backend && (*backend)->renderer().find("llvmpipe") != std::string::npos;
}

void printVolume(const Volume& volume, std::int64_t before, const std::string& name, Report& report) {
  std::printf("  %-10s %22lld (%s, initial value)\n", "-", static_cast<long long>(before), volume.label.c_str());
  for (std::size_t i = 0; i < volume.sum.size(); ++i)
    std::printf("  %-10lld %22lld (of it %lld compacted)\n", static_cast<long long>(volume.every * std::int64_t(i + 1)),
                static_cast<long long>(volume.sum[i]), static_cast<long long>(volume.compacted[i]));
  const bool all_equal = volume.unequal_ticks == 0 &&
                         std::ranges::all_of(volume.sum, [before](std::int64_t sum) { return sum == before; });
  std::printf("  every tick %s; hash %s\n", all_equal ? "equal" : "NOT EQUAL", hexText(volume.hash).c_str());
  if (!all_equal) report.faults.push_back(name + ", " + volume.label + ": the volume changed");
}

void measureWay(const Settings& settings, const char* title, const char* name, const Parameters& parameters,
                Report& report) {
  BenchScene scene = makeThesisScene(name, 512, 200, 1, parameters);
  scene.pack.paths[0].speed_q_per_tick = 200;  // 100 m in 5000 frames: on its way throughout
  scene.id = packId(encodePack(scene.pack));
  std::fprintf(stderr, "%s ...\n", name);
  const std::int64_t before = baseSum(BaseTerrain(scene.pack));
  std::printf("%s\n", title);
  const Volume native = runFrames(scene, nativeBeside(settings), kFrameCount, kEvery);
  printVolume(native, before, name, report);
  if (settings.engine.on_gl) {
    const bool software = isSoftware(settings.engine);
    const Volume beside =
        software ? runFrames(scene, nativeBeside(settings), kSoftwareFrameCount, kSoftwareEvery) : native;
    const Volume gl = runFrames(scene, settings.engine, software ? kSoftwareFrameCount : kFrameCount, beside.every);
    printVolume(gl, before, name, report);
    std::printf("  native after as many frames: hash %s\n", hexText(beside.hash).c_str());
    if (gl.hash != beside.hash) report.faults.push_back(std::string(name) + ": hashes differ");
  }
  std::printf("\n");
}

}  // namespace

void measureVolume(const Settings& settings, Report& report) {
  Parameters thesis = thesisSsbo();
  thesis.active_areas = 0;
  measureWay(settings,
             "Table 5.9: volume of the world, active areas off, compression 0 (the thesis: 889192448 throughout)",
             "thesis table 5.9", thesis, report);
  Parameters spoor = thesisSsboMultiple();
  spoor.materials[0].compression_q16 = kOneQ16 / 2;
  spoor.materials[0].compaction_limit_q16 = kOneQ16 / 2;
  measureWay(settings, "The same with active areas on and compression 0.5, which the thesis could not do",
             "thesis table 5.9, areas and compression", spoor, report);
}

}  // namespace spoor
