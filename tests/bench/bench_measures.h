#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/bench/bench_series.h"

namespace spoor {

/// What the command line chose.
struct Settings {
  std::string scene;  // empty: those that a measurement is made for
  std::int64_t tick_count = 60;
  Engine engine;  // with everything that was chosen for gl, whether it runs on gl or not
};

/// How a number of separate areas compares with one, on one engine.
struct AreasResult {
  int area_count = 0;
  std::string label;
  double time_ratio = 0;             // of the medians of a tick
  std::int64_t most_dispatches = 0;  // of a tick
  bool dispatches_met = false;       // no more than one area needs
  bool time_met = false;             // no more than kAreasTimeGoal
};
inline constexpr double kAreasTimeGoal = 1.3;

/// What the measurements found.
struct Report {
  std::vector<Series> runs;
  std::vector<AreasResult> areas;
  double copy_gb_per_s = 0;         // of the device; 0: not measured
  std::vector<std::string> faults;  // what makes the run fail, a line each
};

// The measurements. Each prints what it finds and adds it to the report; each throws std::runtime_error where it cannot
// be made.

/// Whole ticks by stages. Native against its plainest schedule; gl beside native, with the device's copy bandwidth.
void measureTicks(const Settings& settings, Report& report);
/// The relaxation by schedules: native's sets of kernels or gl's two, every pair visited and settled pairs skipped.
void measureRelax(const Settings& settings, Report& report);
/// The same cells in 1, 2, 4 and 8 separate areas.
void measureAreas(const Settings& settings, Report& report);
/// One car on level ground in a small and in a large world.
void measureWorlds(const Settings& settings, Report& report);
/// The thesis's Tables 4.5, 4.6, 5.4 to 5.7 and 5.9 and the sweeps of its figures 5.6 and 5.7, beside its own numbers.
void measureThesis(const Settings& settings, Report& report);
/// Errors beside speed: of each way to find the nearest free cell, and of each rule that evens out slopes.
void measureErrors(const Settings& settings, Report& report);
/// Craters: error and speed of their profile, memory, the spatial hash, lazy ground beside eager. Cossetin Neto et al.,
/// figure 7.
void measureCraters(const Settings& settings, Report& report);
/// Cones of every material under every slope rule: how they come to rest.
void measureCones(const Settings& settings, Report& report);
/// Rule `drift` beside the published scheme of Gilardi et al.: stability, error, order of convergence, and time.
void measureDrift(const Settings& settings, Report& report);
/// What snowfall costs a tick, on ground that nobody reached, that rests, and that slides.
void measureSnow(const Settings& settings, Report& report);
/// The device's copy bandwidth.
void measureBandwidth(const Settings& settings, Report& report);

/// Table 5.9: the volume of a whole world over 5000 ticks; the thesis's way, and with active areas and compaction.
void measureVolume(const Settings& settings, Report& report);

/// A scene of the benchmark, or a pack file.
BenchScene loadScene(const std::string& name);

/// The plainest schedule there is, which every other one must equal: native, one thread, baseline kernels, every pair.
Engine plainest();
/// The fastest native one, with as many threads as the settings say.
Engine nativeBeside(const Settings& settings);

/// Sets a series' ratio to the one that it stands beside.
void compareTimes(Series& series, const Series& beside);

/// Writes a report to files. Throws std::runtime_error where one cannot be written.
void writeReportJson(const Report& report, const std::string& measurement, const std::string& path);
void writeReportCsv(const Report& report, const std::string& path);

}  // namespace spoor
