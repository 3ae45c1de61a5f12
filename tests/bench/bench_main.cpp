// spoor-bench: times of the pipeline's stages, each run checked against a second one that must give the same hashes.
#include <cstdio>
#include <exception>
#include <set>

#include "shaders/host/make_backend.h"
#include "shared/base/options.h"
#include "tests/bench/bench_measures.h"

namespace spoor {
namespace {

struct Measurement {
  const char* name;
  void (*measure)(const Settings&, Report&);
  bool on_gl_only;
};
constexpr Measurement kMeasurements[] = {
    {"tick", measureTicks, false},      {"relax", measureRelax, false},       {"areas", measureAreas, false},
    {"world", measureWorlds, false},    {"thesis", measureThesis, false},     {"errors", measureErrors, false},
    {"craters", measureCraters, false}, {"cones", measureCones, false},       {"drift", measureDrift, false},
    {"snow", measureSnow, false},       {"bandwidth", measureBandwidth, true}};

/// The command line, as it is written.
struct Arguments {
  std::vector<std::string> what;
  std::string backend = "native", scene, schedule = "auto", gl_device = "auto", json, csv;
  std::int64_t tick_count = 60, thread_count = 0, group = 0;
  bool every_pair = false, list_devices = false;
};

Arguments parse(int argc, char** argv) {
  Arguments arguments;
  Options options("spoor-bench", "times of the pipeline, checked by hash");
  options.addPlain(
      "tick|relax|areas|world|thesis|errors|craters|cones|drift|snow|bandwidth",
      "a whole tick by stages; sweeps by schedules; the same cells in 1 to 8 areas; a car in a small and a "
      "large world; the tables of Persson's thesis; errors of the ways to choose from beside their speed; craters as "
      "records; piles of every material; the drift rule beside its paper's; snowfall; how fast the device copies "
      "[tick]",
      &arguments.what, 1);
  options.add("scene", "NAME|PACK",
              "a scene of the benchmark or a pack, for tick (else car491, slab491) and relax "
              "(else pile, slab491)",
              &arguments.scene);
  options.add("backend", "NAME", "native, gl (native runs beside it and must give the same hashes), or auto",
              &arguments.backend);
  options.add("ticks", "N", "ticks of each run; areas runs 60 at most, thesis 5000 for its sums", &arguments.tick_count,
              2, 1000000);
  options.add("threads", "N", "0: one for each processor", &arguments.thread_count, 0, 256);
  options.addFlag("every-pair", "visit settled pairs too", &arguments.every_pair);
  options.add("schedule", "NAME", "gl: sweeps plain (a dispatch each matching), fused (one a sweep), or auto",
              &arguments.schedule);
  options.add("group", "N", "gl: lanes of a group, 64, 128 or 256; 0: as the backend likes", &arguments.group, 0, 256);
  options.add("gl-device", "NAME", "gl: auto, surfaceless, or the number of an EGL device", &arguments.gl_device);
  options.addFlag("list-devices", "print what gl can be asked to run on, and end", &arguments.list_devices);
  options.add("json", "FILE", "also write the figures there", &arguments.json);
  options.add("csv", "FILE", "also write the figures there, a line for each run", &arguments.csv);
  options.parseOrExit(argc, argv);
  return arguments;
}

/// What is wrong with the arguments together, which Options cannot see.
Status check(const Arguments& arguments, const Measurement* measurement) {
  if (measurement == nullptr)
    return Error{"'" + arguments.what.front() +
                 "' is none of tick, relax, areas, world, thesis, errors, craters, cones, drift, snow, bandwidth"};
  const std::set<std::string> schedules{"auto", "plain", "fused"}, backends{"auto", "gl", "native"};
  if (schedules.count(arguments.schedule) == 0)
    return Error{"--schedule: '" + arguments.schedule + "' is none of auto, plain, fused"};
  if (backends.count(arguments.backend) == 0)
    return Error{"--backend: '" + arguments.backend + "' is none of auto, gl, native"};
  if (arguments.group != 0 && arguments.group != 64 && arguments.group != 128 && arguments.group != 256)
    return Error{"--group: " + std::to_string(arguments.group) + " is none of 64, 128, 256"};
  return {};
}

const Measurement* find(const std::string& name) {
  for (const Measurement& measurement : kMeasurements)
    if (measurement.name == name) return &measurement;
  return nullptr;
}

int run(int argc, char** argv) {
  const Arguments arguments = parse(argc, argv);
  const Measurement* measurement = find(arguments.what.empty() ? "tick" : arguments.what.front());
  if (const Status status = check(arguments, measurement); !status) {
    std::fprintf(stderr, "spoor-bench: %s (see --help)\n", status.error().c_str());
    return 2;
  }
  if (arguments.list_devices) {
    for (const std::string& line : listDevices()) std::printf("%s\n", line.c_str());
    return 0;
  }
  std::set<std::string> said;  // each engine has the same to say
  const Say say = [&said](const std::string& text) {
    if (said.insert(text).second) std::fprintf(stderr, "%s\n", text.c_str());
  };
  Settings settings{arguments.scene, arguments.tick_count, {}};
  settings.engine.skip_settled = !arguments.every_pair;
  settings.engine.thread_count = int(arguments.thread_count);
  settings.engine.gl_device = arguments.gl_device;
  settings.engine.gl_schedule = arguments.schedule;
  settings.engine.gl_group = int(arguments.group);
  settings.engine.say = say;
  if (!measurement->on_gl_only) {
    const auto on_gl = runsOnGl(arguments.backend, arguments.gl_device, say);
    if (!on_gl) throw std::runtime_error(on_gl.error());
    settings.engine.on_gl = *on_gl;
  }
  Report report;
  measurement->measure(settings, report);
  if (!arguments.json.empty()) writeReportJson(report, measurement->name, arguments.json);
  if (!arguments.csv.empty()) writeReportCsv(report, arguments.csv);
  for (const std::string& fault : report.faults) std::fprintf(stderr, "spoor-bench: %s\n", fault.c_str());
  return report.faults.empty() ? 0 : 1;
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
