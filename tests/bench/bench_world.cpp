// spoor-bench world: the same car on level ground in a small and a large world, time and memory as ratios.
#include <cstdio>

#include "shared/base/statistics.h"
#include "tests/bench/bench_measures.h"

namespace spoor {

void measureWorlds(const Settings& settings, Report& report) {
  const std::vector<BenchScene> scenes{makeBenchScene("car"), makeBenchScene("car_wide")};
  std::fprintf(stderr, "measuring a small and a large world in turns ...\n");
  std::vector<double> ratios;
  std::vector<Series> both;
  for (int round = 0; round < 7; ++round) {  // in turns, so that a noisy machine disturbs both alike
    both.clear();
    for (const BenchScene& scene : scenes)
      both.push_back(runTogether(scene, {settings.engine}, settings.tick_count).front());
    compareTimes(both[1], both[0]);
    ratios.push_back(both[1].tick_ratio);
  }
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const Series check = runTogether(scenes[i], {plainest()}, settings.tick_count).front();
    for (std::string& fault : faultsOf(both[i], check)) report.faults.push_back(std::move(fault));
    both[i].label = both[i].scene;
  }
  printTable("one car in 2048 x 2048 and in 65 536 x 65 536 cells", both);
  const double memory_ratio = double(both[1].store_bytes) / double(both[0].store_bytes);
  std::printf("  check: the plainest schedule gives %s\n",
              report.faults.empty() ? "the same hash after every tick" : "OTHER HASHES");
  std::printf(
      "  large against small: time x %.3f (median of 7 rounds), store memory x %.3f, live tiles %lld and %lld\n",
      percentile(ratios, 0.5), memory_ratio, static_cast<long long>(both[1].live_tiles),
      static_cast<long long>(both[0].live_tiles));
  if (memory_ratio > 1.1) report.faults.push_back("the large world's store takes more than 1.1 x the small one's");
  both[1].tick_ratio = percentile(ratios, 0.5);
  report.runs = both;
}

}  // namespace spoor
