// spoor-bench relax: cells swept per second, by kernels and schedules, every pair visited and settled pairs skipped.
#include <cstdio>

#include "shared/base/json.h"
#include "shared/base/statistics.h"
#include "tests/bench/bench_measures.h"

namespace spoor {
namespace {

/// Every engine to compare with what its line says; the first is what the others must equal.
struct Lineup {
  std::vector<Engine> engines;
  std::vector<std::string> labels;

  void add(Engine engine, const std::string& label) {
    for (const bool skip : {false, true}) {
      engine.skip_settled = skip;
      engines.push_back(engine);
      labels.push_back(label + (skip ? ", settled pairs skipped" : ", every pair visited"));
    }
  }
};

Lineup lineupOf(const Settings& settings) {
  Lineup lineup;
  if (settings.engine.on_gl) {
    lineup.add(nativeBeside(settings), "native");
    for (const std::string schedule : {"plain", "fused"}) {
      if (settings.engine.gl_schedule != "auto" && settings.engine.gl_schedule != schedule) continue;
      Engine engine = settings.engine;
      engine.gl_schedule = schedule;
      lineup.add(engine, "gl " + schedule);
    }
  } else {
    for (const Kernels* set : availableKernels()) {
      Engine engine = nativeBeside(settings);
      engine.kernels = set;
      lineup.add(engine, std::string("native ") + set->name);
    }
  }
  return lineup;
}

void measureScene(const Settings& settings, const BenchScene& scene, Report& report) {
  const Lineup lineup = lineupOf(settings);
  std::fprintf(stderr, "measuring the relaxation of %s, %zu schedules in turns ...\n", scene.pack.name.c_str(),
               lineup.engines.size());
  std::vector<Series> runs = runTogether(scene, lineup.engines, settings.tick_count);
  std::printf("%s, %d sweeps a tick, %zu ticks\n", scene.pack.name.c_str(), scene.pack.parameters.sweeps_per_tick,
              runs.front().tick_ms.size());
  for (std::size_t i = 0; i < runs.size(); ++i) {
    runs[i].label = lineup.labels[i];
    if (settings.engine.on_gl) runs[i].copy_gb_per_s = lineup.engines[i].on_gl ? report.copy_gb_per_s : 0;
    compareTimes(runs[i], runs.front());
    std::printf("  %-38s relax %9.3f ms, %8.1f M cell-iterations/s (medians), %7.1f GB/s", runs[i].label.c_str(),
                percentile(runs[i].stage_ms[int(Stage::relax)], 0.5), percentile(runs[i].relax_rate, 0.5),
                relaxRate(runs[i]));
    if (runs[i].copy_gb_per_s > 0) std::printf(" (%.3f of a copy's)", relaxRate(runs[i]) / runs[i].copy_gb_per_s);
    std::printf(", hash %s\n", hexText(runs[i].hashes.back()).c_str());
    for (std::string& fault : faultsOf(runs[i], runs.front())) report.faults.push_back(std::move(fault));
  }
  std::printf("\n");
  for (Series& series : runs) report.runs.push_back(std::move(series));
}

}  // namespace

void measureRelax(const Settings& settings, Report& report) {
  if (settings.engine.on_gl) measureBandwidth(settings, report);
  const std::vector<std::string> names =
      settings.scene.empty() ? std::vector<std::string>{"pile", "slab491"} : std::vector{settings.scene};
  for (const std::string& name : names) measureScene(settings, loadScene(name), report);
}

}  // namespace spoor
