// spoor-bench areas: what it costs that the same cells lie in several separate areas.
#include <algorithm>
#include <cstdio>

#include "shared/base/statistics.h"
#include "tests/bench/bench_measures.h"

namespace spoor {
namespace {

constexpr int kAreaCounts[] = {1, 2, 4, 8};

std::string areasText(int count) { return std::to_string(count) + (count == 1 ? " area" : " areas"); }

std::int64_t mostDispatches(const Series& series) {
  return series.dispatches.empty() ? 0 : std::ranges::max(series.dispatches);
}

/// Compares one engine's series, one for each count of areas, with that of one area, and prints them.
void compareCounts(std::vector<Series>& counts, const std::string& label, Report& report) {
  for (std::size_t i = 0; i < counts.size(); ++i) {
    Series& series = counts[i];
    const Series& one = counts.front();
    compareTimes(series, one);
    series.label = label + ", " + areasText(kAreaCounts[i]);
    AreasResult result{kAreaCounts[i], label, series.tick_ratio, mostDispatches(series), false, false};
    result.dispatches_met = result.most_dispatches <= mostDispatches(one);
    result.time_met = result.time_ratio <= kAreasTimeGoal;
    if (!result.dispatches_met)
      report.faults.push_back(series.label + ": " + std::to_string(result.most_dispatches) +
                              " dispatches in a tick, one area needs " + std::to_string(mostDispatches(one)));
    if (series.active_cells != one.active_cells)
      report.faults.push_back(series.label + ": not the same active cells as in one area, so nothing is compared");
    report.areas.push_back(std::move(result));
  }
  printTable("areas", counts);
  for (auto result = report.areas.end() - std::ssize(counts); result != report.areas.end(); ++result)
    std::printf("  %s, %-8s time x %.3f, at most %lld dispatches a tick\n", label.c_str(),
                (areasText(result->area_count) + ":").c_str(), result->time_ratio,
                static_cast<long long>(result->most_dispatches));
  const AreasResult& eight = report.areas.back();
  const bool dispatches_met = std::ranges::all_of(report.areas, &AreasResult::dispatches_met);
  std::printf("  goal: no more dispatches than one area: %s\n", dispatches_met ? "met" : "NOT MET");
  std::printf("  goal: eight areas at most %.1f x the time of one: %s (%.3f)\n\n", kAreasTimeGoal,
              eight.time_met ? "met" : "NOT MET", eight.time_ratio);
}

}  // namespace

void measureAreas(const Settings& settings, Report& report) {
  const std::int64_t tick_count = std::min(settings.tick_count, kAreasTickLimit);
  std::vector<BenchScene> scenes;
  for (const int count : kAreaCounts) scenes.push_back(makeAreasScene(count));
  // Native beside gl; native alone against its plainest schedule.
  const std::vector<Engine> engines{settings.engine.on_gl ? nativeBeside(settings) : plainest(), settings.engine};
  std::fprintf(stderr, "measuring 1, 2, 4 and 8 areas in turns ...\n");
  const std::vector<Series> runs = runTogether(scenes, engines, tick_count);
  std::vector<Series> expected, measured;
  for (std::size_t i = 0; i < runs.size(); i += 2) {
    expected.push_back(runs[i]);
    measured.push_back(runs[i + 1]);
    for (const Series& series : {runs[i], runs[i + 1]})
      for (std::string& fault : faultsOf(series, runs[i])) report.faults.push_back(std::move(fault));
  }
  if (settings.engine.on_gl) compareCounts(expected, "native", report);
  compareCounts(measured, settings.engine.on_gl ? "gl" : "native", report);
  if (settings.engine.on_gl) report.runs = expected;
  report.runs.insert(report.runs.end(), measured.begin(), measured.end());
}

}  // namespace spoor
