// spoor-bench thesis: the tables and sweeps of Persson 2019, chapter 5 and section 4.4, on this machine beside the
// thesis's own numbers (a GTX 660). Rows of both backends must end with the same hash.
#include <algorithm>
#include <cstdio>

#include "shared/base/json.h"
#include "shared/base/statistics.h"
#include "tests/bench/bench_measures.h"

namespace spoor {
namespace {

constexpr int kMapSizes[] = {512, 1024, 2048, 4096};
constexpr int kMapCount = 4;
constexpr int kIterations = 10;  // Table 5.3, of displacement and of slopes

/// The engines of a row: native, and gl beside it where it was asked for.
std::vector<Engine> enginesOf(const Settings& settings) {
  std::vector<Engine> engines{nativeBeside(settings)};
  if (settings.engine.on_gl) engines.push_back(settings.engine);
  return engines;
}

/// Runs a scene on all engines; faults and runs go to the report.
std::vector<Series> runRow(const Settings& settings, const BenchScene& scene, std::int64_t tick_count, Report& report) {
  std::fprintf(stderr, "%s ...\n", scene.pack.name.c_str());
  std::vector<Series> runs = runTogether(scene, enginesOf(settings), tick_count);
  for (Series& series : runs) {
    compareTimes(series, runs.front());
    for (std::string& fault : faultsOf(series, runs.front())) report.faults.push_back(std::move(fault));
    report.runs.push_back(series);
  }
  return runs;
}

Parameters withIterations(Parameters parameters, int displace, int slopes) {
  parameters.displace_iterations = displace;
  parameters.sweeps_per_tick = slopes;
  return parameters;
}

double stageMs(const Series& series, Stage stage) { return percentile(series.stage_ms[int(stage)], 0.5); }

std::string hashOf(const Series& series) { return hexText(series.hashes.back()); }

/// One of the thesis's textures or buffers, with what its own table says it takes.
struct ThesisBuffer {
  const char* name;
  int bytes_per_cell;
};

/// What a backend holds for each simulated cell beside what the thesis's textures take for each cell of the map.
void printMemory(const char* title, std::span<const ThesisBuffer> thesis, int stated_bytes,
                 const std::vector<Series>& runs) {
  std::printf("%s\n", title);
  int sum = 0;
  for (const ThesisBuffer& buffer : thesis) {
    std::printf("  thesis  %-44s %4d B for each cell of the map\n", buffer.name, buffer.bytes_per_cell);
    sum += buffer.bytes_per_cell;
  }
  std::printf("  thesis  %-44s %4d B (the thesis states %d)\n", "together", sum, stated_bytes);
  for (const Series& series : runs) {
    const double active = double(series.active_cells) / double(std::max<std::size_t>(series.tick_ms.size(), 1));
    std::int64_t total = 0;
    for (const BufferBytes& buffer : series.memory.buffers) {
      total += buffer.bytes;
      if (buffer.bytes * 1000 < std::int64_t(active))  // tables of a few bytes
        continue;
      std::printf("  %-7s %-44s %10lld B, %7.2f B for each active cell\n", series.label.c_str(), buffer.name.c_str(),
                  static_cast<long long>(buffer.bytes), double(buffer.bytes) / active);
    }
    std::printf("  %-7s %-44s %10lld B, %7.2f B for each cell of the map; hash %s\n", series.label.c_str(), "together",
                static_cast<long long>(total), double(total) / double(series.map_cells), hashOf(series).c_str());
    std::printf("  %-7s %-44s %10lld B, of %lld live tiles\n", series.label.c_str(), "world on the host",
                static_cast<long long>(series.store_bytes), static_cast<long long>(series.live_tiles));
  }
  std::printf("\n");
}

void measureMemory(const Settings& settings, Report& report) {
  constexpr ThesisBuffer kSsbo[] = {{"Heightmap", 4},
                                    {"Heightmap for rendering", 4},
                                    {"Normalmap", 16},
                                    {"Blurred normalmap (2)", 32},
                                    {"Depth texture", 2},
                                    {"Penetration texture", 16},
                                    {"Distance texture (2)", 32},
                                    {"SSBO", 4}};
  constexpr ThesisBuffer kIterative[] = {{"Heightmap", 4},
                                         {"Heightmap for rendering", 4},
                                         {"Normalmap", 16},
                                         {"Blurred normalmap (2)", 32},
                                         {"Depth texture", 2},
                                         {"Penetration texture", 16},
                                         {"Distance texture (2)", 32},
                                         {"Distance texture with neighbor data", 16},
                                         {"Offset texture (2)", 32},
                                         {"Packed texture for evening out slopes", 8},
                                         {"Average height difference texture", 16},
                                         {"Evened heights texture", 8}};
  const auto run = [&](const char* name, const Parameters& parameters) {
    return runRow(settings, makeThesisScene(name, 1024, 200, 1, withIterations(parameters, kIterations, kIterations)),
                  3, report);
  };
  printMemory("Table 4.5: memory of the SSBO approach, map of 1024 x 1024, one car", kSsbo, kThesisBufferBytes,
              run("thesis table 4.5", thesisSsbo()));
  printMemory("Table 4.6: memory of the iterative approach, map of 1024 x 1024, one car", kIterative,
              kThesisIterativeBytes, run("thesis table 4.6", thesisIterative()));
}

/// A row of Tables 5.4 and 5.5.
struct StepRow {
  const char* name;
  Stage stage;
  double thesis_ms[kMapCount];
};

/// Times of the steps over the size of the map.
void measureSteps(const Settings& settings, const std::string& table, const char* approach,
                  const Parameters& parameters, std::span<const StepRow> rows, Report& report) {
  std::vector<std::vector<Series>> runs;
  for (const int size : kMapSizes)
    runs.push_back(runRow(settings,
                          makeThesisScene("thesis table " + table + ", " + std::to_string(size), size, 200, 1,
                                          withIterations(parameters, kIterations, kIterations)),
                          settings.tick_count, report));
  std::printf("Table %s: steps of the %s approach, ms (medians; the thesis's are means)\n  %-34s", table.c_str(),
              approach, "heightmapSize");
  for (const int size : kMapSizes) std::printf("%11d", size);
  std::printf("\n  %-34s", "cells searched, a tick");
  for (const auto& run : runs) std::printf("%11.0f", double(run[0].domain_cells) / double(run[0].tick_ms.size()));
  std::printf("\n");
  for (const StepRow& row : rows) {
    std::printf("  %-24s thesis   ", row.name);
    for (const double value : row.thesis_ms) std::printf("%11.3f", value);
    for (std::size_t engine = 0; engine < runs[0].size(); ++engine) {
      std::printf("\n  %-24s %-9s", "", runs[0][engine].label.c_str());
      for (const auto& run : runs) std::printf("%11.3f", stageMs(run[engine], row.stage));
    }
    std::printf("\n");
  }
  for (std::size_t engine = 0; engine < runs[0].size(); ++engine) {
    std::printf("  %-24s %-9s", "Whole tick", runs[0][engine].label.c_str());
    for (const auto& run : runs) std::printf("%11.3f", percentile(run[engine].tick_ms, 0.5));
    std::printf("\n  %-24s %-9s", "Hash", "");
    for (const auto& run : runs) std::printf("  %s", hashOf(run[engine]).substr(7).c_str());
    std::printf("\n");
  }
  std::printf(
      "  (normals, copying heights for rendering and drawing are the client's: spoor-figures --pack PACK --frames "
      "N)\n\n");
}

void measureStepTables(const Settings& settings, Report& report) {
  constexpr StepRow kIterative[] = {{"Render depth texture", Stage::depth, {.203, .202, .201, .373}},
                                    {"Create penetration tex.", Stage::penetration, {.116, .112, .118, .671}},
                                    {"Jump flooding", Stage::nearest, {.403, .529, .909, 10.692}},
                                    {"Displace material", Stage::displace, {.513, .579, .847, 11.864}},
                                    {"Even out steep slopes", Stage::relax, {.826, .988, 1.531, 14.480}}};
  constexpr StepRow kSsbo[] = {{"Render depth texture", Stage::depth, {.204, .207, .201, .210}},
                               {"Create penetration tex.", Stage::penetration, {.111, .116, .120, .670}},
                               {"Jump flooding", Stage::nearest, {.408, .549, .905, 9.045}},
                               {"Displace material", Stage::displace, {.107, .127, .177, 1.659}},
                               {"Even out steep slopes", Stage::relax, {.544, .773, 1.617, 5.486}}};
  measureSteps(settings, "5.4", "iterative", thesisIterative(), kIterative, report);
  measureSteps(settings, "5.5", "SSBO", thesisSsbo(), kSsbo, report);
  Parameters spoor = thesisSsbo();
  spoor.nearest = NearestSearch::exact;
  spoor.slopes = SlopeRule::exchange;
  measureSteps(settings, "5.5 with Spoor's defaults (exact search, exchange)", "SSBO", spoor, kSsbo, report);
}

/// A way to displace soil, as the thesis calls it.
struct Method {
  const char* name;
  Parameters parameters;
  double thesis_ms;  // Table 5.6
};

/// Table 5.6 and the sweep of figure 5.6: displacement at 4096 x 4096.
void measureDisplacement(const Settings& settings, Report& report) {
  const auto run = [&](const std::string& name, const Parameters& parameters, int iterations) {
    return runRow(
        settings,
        makeThesisScene("thesis displacement, " + name, 4096, 200, 1, withIterations(parameters, iterations, 1)),
        settings.tick_count, report);
  };
  const Method methods[] = {{"iterative, 1 iteration", thesisIterative(), 2.84},
                            {"SSBO", thesisSsbo(), 1.04},
                            {"SSBO with multiple targets", thesisSsboMultiple(), 1.15}};
  std::printf("Table 5.6: displacement at 4096 x 4096, ms\n");
  for (const Method& method : methods)
    for (const Series& series : run(method.name, method.parameters, 1))
      std::printf("  %-28s thesis %7.2f   %-7s %9.3f   hash %s\n", method.name, method.thesis_ms, series.label.c_str(),
                  stageMs(series, Stage::displace), hashOf(series).c_str());
  std::printf("\nFigure 5.6: iterative displacement at 4096 x 4096 over its iterations, ms\n");
  for (const int iterations : {1, 2, 4, 6, 8, 10})
    for (const Series& series : run("iterative, " + std::to_string(iterations), thesisIterative(), iterations))
      std::printf("  %4d iterations   %-7s %9.3f   hash %s\n", iterations, series.label.c_str(),
                  stageMs(series, Stage::displace), hashOf(series).c_str());
  std::printf("\n");
}

/// The sweep of figure 5.7: evening out at 4096 x 4096, by every rule.
void measureSlopes(const Settings& settings, Report& report) {
  constexpr std::pair<SlopeRule, const char*> kRules[] = {{SlopeRule::interleaved, "iterative (interleaved)"},
                                                          {SlopeRule::scatter, "SSBO (scatter)"},
                                                          {SlopeRule::flux, "flux"},
                                                          {SlopeRule::exchange, "exchange"}};
  std::printf("Figure 5.7: evening out slopes at 4096 x 4096 over its iterations, ms\n");
  for (const auto& [rule, name] : kRules)
    for (const int iterations : {1, 5, 10, 20}) {
      Parameters parameters = withIterations(thesisSsbo(), 1, iterations);
      parameters.slopes = rule;
      const auto runs =
          runRow(settings,
                 makeThesisScene(std::string("thesis slopes, ") + name + ", " + std::to_string(iterations), 4096, 200,
                                 1, parameters),
                 settings.tick_count, report);
      for (const Series& series : runs)
        std::printf("  %-24s %4d iterations   %-7s %9.3f   hash %s\n", name, iterations, series.label.c_str(),
                    stageMs(series, Stage::relax), hashOf(series).c_str());
    }
  std::printf("  (interleaved and scatter are one rule: the same hash)\n\n");
}

double ticksPerSecond(const Series& series) { return 1e3 / percentile(series.tick_ms, 0.5); }

/// Table 5.7: ticks per second with one to eight cars, active areas on and off.
void measureActiveAreas(const Settings& settings, Report& report) {
  constexpr double kThesis[8][4] = {{452, 496, 17, 22}, {331, 388, 16, 23}, {258, 313, 16, 23}, {210, 255, 16, 23},
                                    {180, 227, 16, 23}, {155, 199, 16, 23}, {136, 174, 16, 23}, {123, 157, 16, 23}};
  constexpr const char* kColumns[4] = {"active areas, iterative", "active areas, SSBO", "whole map, iterative",
                                       "whole map, SSBO"};
  std::printf("Table 5.7: ticks per second at 2048 x 2048 by cars (the thesis: frames per second, drawing too)\n");
  for (int cars = 1; cars <= 8; ++cars)
    for (int column = 0; column < 4; ++column) {
      const bool whole_map = column >= 2;
      Parameters parameters = withIterations(column % 2 == 0 ? thesisIterative() : thesisSsbo(), 10, 1);
      parameters.active_areas = whole_map ? 0 : 1;
      const auto runs =
          runRow(settings,
                 makeThesisScene("thesis table 5.7, " + std::to_string(cars) + " cars, " + kColumns[column], 2048, 300,
                                 cars, parameters),
                 whole_map ? 3 : settings.tick_count, report);
      for (const Series& series : runs)
        std::printf("  %d cars, %-24s thesis %5.0f   %-7s %10.1f   %8.0f cells a tick   hash %s\n", cars,
                    kColumns[column], kThesis[cars - 1][column], series.label.c_str(), ticksPerSecond(series),
                    double(series.domain_cells) / double(series.tick_ms.size()), hashOf(series).c_str());
    }
  std::printf("\n");
}

}  // namespace

void measureThesis(const Settings& settings, Report& report) {
  measureMemory(settings, report);
  measureStepTables(settings, report);
  measureDisplacement(settings, report);
  measureSlopes(settings, report);
  measureActiveAreas(settings, report);
  measureVolume(settings, report);
}

}  // namespace spoor
