#include "client/drift_measure.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <iterator>
#include <set>
#include <utility>
#include <vector>

#include "client/drift_scenes.h"
#include "client/views.h"
#include "shaders/host/gl_context.h"
#include "shared/base/json.h"
#include "shared/base/statistics.h"
#include "shared/sim/simulation.h"
#include "shared/world/script.h"

namespace spoor {

namespace {

constexpr int kSides_cells[] = {512, 1024, 2048};
constexpr int kFactors[] = {8, 16, 32, 64};
// Table 1 of Gilardi et al., ms on an NVIDIA Quadro 2000.
constexpr double kPaperFrame_ms[][3] = {
    {2.12, 3.88, 10.56}, {2.32, 4.08, 10.78}, {2.80, 4.55, 11.28}, {4.32, 6.08, 12.85}};
constexpr double kPaperSweep_ms[] = {0.58, 2.09, 7.97};
constexpr int kWarmUpFrames = 1;
constexpr int kLeastFrames = 3;
constexpr double kLeastTime_s = 0.7;

/// The pack's session.
class MeasuredScene {
 public:
  MeasuredScene(std::int32_t side_cells, std::unique_ptr<Backend> backend)
      : pack_(driftMeasurePack(side_cells)),
        base_(pack_),
        script_(base_),
        simulation_(base_, packId(encodePack(pack_)), std::move(backend)) {}

  Result<TickResult> step() { return simulation_.step(script_.poses(simulation_.state().tick + 1)); }
  const ScenePack& pack() const { return pack_; }
  const WorldState& state() const { return simulation_.state(); }
  TerrainView view() const { return {&base_, &simulation_.state()}; }
  std::string backendName() const { return simulation_.backend().name() + " on " + simulation_.backend().renderer(); }

 private:
  ScenePack pack_;
  BaseTerrain base_;
  Script script_;
  Simulation simulation_;
};

/// The whole grid, from over its southern edge.
Camera cameraOver(const MeasuredScene& scene) {
  const double side_m = double(scene.pack().width_cells) * scene.pack().cell_q / rules::kUnitsPerMetre;
  Camera camera = cameraLookingAt({0.5 * side_m, -0.12 * side_m, 0.55 * side_m}, {0.5 * side_m, 0.45 * side_m, 0.0});
  camera.focus_m = glm::dvec2(0.5 * side_m);
  return camera;
}

bool isEmpty(const Image& image) {
  std::set<std::uint32_t> colours;
  std::size_t ground = 0;
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    ground += image.rgba[i + 3] == 255;
    if (colours.size() < 100)
      colours.insert(std::uint32_t(image.rgba[i]) << 16 | std::uint32_t(image.rgba[i + 1]) << 8 | image.rgba[i + 2]);
  }
  return colours.size() < 100 || ground * 4 < image.rgba.size() / 4;
}

/// Times of one size of the grid.
struct SizeTimes {
  std::vector<double> frame_ms;  // by factor
  double sweep_ms = 0.0;
  std::int32_t ticks = 0;
  std::uint64_t hash = 0;
};

Result<double> timeFrames(MeasuredScene& scene, RenderSettings settings, int factor, std::vector<double>& sweeps_ms) {
  settings.tessellation = factor;
  settings.fine_pages = scene.pack().width_cells / render::kPageSamples;
  settings.patches_per_row = 0;
  Renderer renderer(scene.pack(), settings);
  const Camera camera = cameraOver(scene);
  renderer.draw(scene.view(), camera);  // loads the ground
  std::vector<double> frames_ms;
  double whole_ms = 0.0;
  for (int frame = 0; frame < kWarmUpFrames + kLeastFrames || whole_ms < kLeastTime_s * 1000.0; ++frame) {
    glFinish();
    const auto start = std::chrono::steady_clock::now();
    const auto result = scene.step();
    if (!result) return Error{result.error()};
    std::vector<TileCoordinate> changed;
    for (const TileChange& change : result->effect.changes) changed.push_back(change.at);
    renderer.tilesChanged(changed);
    renderer.draw(scene.view(), camera);
    glFinish();
    const double ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    if (frame < kWarmUpFrames) continue;
    sweeps_ms.push_back(result->effect.stage_ms[int(Stage::relax)]);
    frames_ms.push_back(ms);
    whole_ms += ms;
  }
  if (isEmpty(renderer.readPicture()))
    return Error{fmt::format("tessellation factor {}: the picture is empty", factor)};
  return percentile(frames_ms, 0.5);
}

Result<SizeTimes> timeSize(MeasuredScene& scene, const RenderSettings& settings) {
  SizeTimes times;
  std::vector<double> sweeps_ms;
  for (const int factor : kFactors) {
    const auto frame_ms = timeFrames(scene, settings, factor, sweeps_ms);
    if (!frame_ms) return Error{frame_ms.error()};
    times.frame_ms.push_back(*frame_ms);
  }
  times.sweep_ms = percentile(sweeps_ms, 0.5);
  times.ticks = scene.state().tick;
  times.hash = stateHash(scene.state());
  return times;
}

/// Runs the same ticks on the other backend. Nothing where it does not run here.
Status compareHashes(const SizeTimes& times, int side_cells, bool ran_gl, const BackendChoice& choice) {
  BackendChoice other = choice;
  other.name = ran_gl ? "native" : "gl";
  auto backend = makeBackend(other, [](const std::string&) {});
  if (!backend) {
    fmt::print("{} x {}: not compared with {}: {}\n", side_cells, side_cells, other.name, backend.error());
    return {};
  }
  MeasuredScene scene(side_cells, std::move(*backend));
  while (scene.state().tick < times.ticks)
    if (const auto done = scene.step(); !done) return Error{done.error()};
  if (stateHash(scene.state()) != times.hash)
    return Error{fmt::format("{} x {}: the hash after {} ticks is not that of {}", side_cells, side_cells, times.ticks,
                             other.name)};
  fmt::print("{} x {}: the hash after {} ticks is that of {}\n", side_cells, side_cells, times.ticks, other.name);
  std::fflush(stdout);
  return {};
}

JsonWriter jsonOf(const RenderSettings& settings, const std::string& backend, const std::vector<SizeTimes>& sizes) {
  JsonWriter json;
  json.beginObject();
  json.value("renderer", glText(GL_RENDERER));
  json.value("backend", backend);
  json.value("width_px", std::int64_t(settings.width_px));
  json.value("height_px", std::int64_t(settings.height_px));
  json.beginArray("measurements");
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    for (std::size_t factor = 0; factor < std::size(kFactors); ++factor) {
      json.beginObject();
      json.value("side_cells", std::int64_t(kSides_cells[i]));
      json.value("tessellation", std::int64_t(kFactors[factor]));
      json.value("frame_ms", sizes[i].frame_ms[factor]);
      json.value("sweep_ms", sizes[i].sweep_ms);
      json.value("paper_frame_ms", kPaperFrame_ms[factor][i]);
      json.value("paper_sweep_ms", kPaperSweep_ms[i]);
      json.end();
    }
  }
  json.end();
  json.end();
  return json;
}

void printTable(const std::vector<SizeTimes>& sizes) {
  fmt::print("{:>14}", "tessellation");
  for (const int side : kSides_cells) fmt::print("{:>22}", fmt::format("{} x {}", side, side));
  fmt::print("\n");
  const auto printRow = [&](const std::string& name, const auto& ours, const double(&paper)[3]) {
    fmt::print("{:>14}", name);
    for (std::size_t i = 0; i < sizes.size(); ++i)
      fmt::print("{:>22}", fmt::format("{:.2f} ({:.2f})", ours(sizes[i]), paper[i]));
    fmt::print("\n");
  };
  for (std::size_t factor = 0; factor < std::size(kFactors); ++factor)
    printRow(
        std::to_string(kFactors[factor]), [&](const SizeTimes& times) { return times.frame_ms[factor]; },
        kPaperFrame_ms[factor]);
  printRow(
      "sweep alone", [](const SizeTimes& times) { return times.sweep_ms; }, kPaperSweep_ms);
}

}  // namespace

Status measureDrift(const RenderSettings& settings, const BackendChoice& choice, const std::string& json_file) {
  std::vector<SizeTimes> sizes;
  std::string backend_name;
  for (const int side : kSides_cells) {
    auto backend = makeBackend(choice, [](const std::string& line) { fmt::print("{}\n", line); });
    if (!backend) return Error{backend.error()};
    const bool ran_gl = (*backend)->name() == "gl";
    {
      MeasuredScene scene(side, std::move(*backend));
      backend_name = scene.backendName();
      const auto times = timeSize(scene, settings);
      if (!times) return Error{fmt::format("{} x {}: {}", side, side, times.error())};
      sizes.push_back(*times);
    }
    if (const Status equal = compareHashes(sizes.back(), side, ran_gl, choice); !equal) return equal;
  }
  fmt::print("median ms a frame of {} x {}, drawn by {}, simulated by {} (in brackets: Gilardi et al., Quadro 2000)\n",
             settings.width_px, settings.height_px, glText(GL_RENDERER), backend_name);
  printTable(sizes);
  return json_file.empty() ? Status{} : jsonOf(settings, backend_name, sizes).writeFile(json_file);
}

}  // namespace spoor
