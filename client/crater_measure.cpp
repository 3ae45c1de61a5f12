#include "client/crater_measure.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>
#include <vector>

#include "client/views.h"
#include "shaders/host/gl_context.h"
#include "shared/base/json.h"
#include "shared/base/statistics.h"

namespace spoor {

namespace {

constexpr std::int32_t kMetre_q = 10000;
constexpr std::int32_t kCell_q = kMetre_q / 4;
constexpr double kSide_m = 700.0;  // of the world
constexpr double kDisc_m = 500.0;  // diameter
constexpr int kCraterCounts[] = {0, 100, 250, 500, 1000};
constexpr int kHashCells_m[] = {25, 50, 75, 125, 250, 500, 0};  // 0: one as large as the world
constexpr std::uint32_t kSeed = 6;
constexpr int kWarmUpFrames = 1;
constexpr int kLeastFrames = 3;
constexpr double kLeastTime_s = 1.0;

ScenePack emptyPack(int hash_cell_m) {
  ScenePack pack;
  pack.name = "craters in a disc";
  pack.width_cells = pack.height_cells = std::int32_t(kSide_m * kMetre_q) / kCell_q;
  pack.cell_q = kCell_q;
  pack.soil_depth_q = 30 * kMetre_q;
  pack.noise = {4, (std::int64_t(1) << 32) / 600, 5, -pack.soil_depth_q - 4 * kMetre_q,
                -pack.soil_depth_q + 4 * kMetre_q};
  pack.crater_limits.radius_q = 10 * kMetre_q;
  pack.crater_limits.hash_cell_q = hash_cell_m == 0 ? pack.width_cells * kCell_q : hash_cell_m * kMetre_q;
  return pack;
}

/// Anywhere in the disc; an eighth of the diameter deep, a twentieth high, as those of the paper's pictures.
std::vector<Crater> randomCraters(int count) {
  std::mt19937 random(kSeed);
  const auto between = [&](double low, double high) { return low + (high - low) * double(random()) / 4294967296.0; };
  std::vector<Crater> craters;
  for (int i = 0; i < count; ++i) {
    const double away_m = kDisc_m / 2.0 * std::sqrt(between(0.0, 1.0)), angle = between(0.0, 2.0 * std::numbers::pi);
    const double outer_q = between(2.5, 10.0) * kMetre_q;
    Crater crater;
    crater.x_q = std::int32_t((kSide_m / 2.0 + away_m * std::cos(angle)) * kMetre_q);
    crater.y_q = std::int32_t((kSide_m / 2.0 + away_m * std::sin(angle)) * kMetre_q);
    crater.crest_radius_q = std::int32_t(outer_q * 0.65);
    crater.inner_radius_q = std::int32_t(2 * crater.crest_radius_q - outer_q);
    crater.depth_q = std::int32_t(outer_q * 0.25);
    crater.rim_height_q = std::int32_t(outer_q * 0.10);
    crater.noise_seed = std::uint16_t(random());
    crater.noise_q16 = 16384;
    crater.tick = 1;
    crater.id = std::uint32_t(i);
    craters.push_back(crater);
  }
  return craters;
}

struct Measurement {
  int hash_cell_m = 0;
  int crater_count = 0;
  double frame_ms = 0.0;
  std::vector<std::uint8_t> picture;
};

Measurement measure(const RenderSettings& settings, int hash_cell_m, int crater_count) {
  const ScenePack pack = emptyPack(hash_cell_m);
  const BaseTerrain base(pack);
  WorldState state = initialState(packId(encodePack(pack)), base);
  state.craters.add(randomCraters(crater_count));
  const TerrainView view{&base, &state};
  // From over the disc's southern edge: most of it is seen.
  const glm::dvec2 middle_m(kSide_m / 2.0);
  const double ground_m = groundHeight(view, middle_m);
  Camera camera = cameraLookingAt({middle_m + glm::dvec2(0.0, -0.55 * kDisc_m), ground_m + 0.45 * kDisc_m},
                                  {middle_m + glm::dvec2(0.0, -0.06 * kDisc_m), ground_m});
  camera.focus_m = middle_m;
  Renderer renderer(pack, settings);
  std::vector<double> frames_ms;
  double whole_ms = 0.0;
  for (int frame = 0; frame < kWarmUpFrames + kLeastFrames || whole_ms < kLeastTime_s * 1000.0; ++frame) {
    const auto start = std::chrono::steady_clock::now();
    renderer.draw(view, camera);
    glFinish();
    const double ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    if (frame < kWarmUpFrames) continue;
    frames_ms.push_back(ms);
    whole_ms += ms;
  }
  return {hash_cell_m, crater_count, percentile(frames_ms, 0.5), renderer.readPicture().rgba};
}

std::string nameOf(int hash_cell_m) { return hash_cell_m == 0 ? "no hash" : fmt::format("{} m", hash_cell_m); }

JsonWriter jsonOf(const RenderSettings& settings, const std::vector<Measurement>& measurements) {
  JsonWriter json;
  json.beginObject();
  json.value("renderer", glText(GL_RENDERER));
  json.value("width_px", std::int64_t(settings.width_px));
  json.value("height_px", std::int64_t(settings.height_px));
  json.value("seed", std::int64_t(kSeed));
  json.beginArray("measurements");
  for (const Measurement& m : measurements) {
    json.beginObject();
    json.value("hash_cell_m", std::int64_t(m.hash_cell_m));
    json.value("craters", std::int64_t(m.crater_count));
    json.value("frame_ms", m.frame_ms);
    json.value("frames_per_second", 1000.0 / m.frame_ms);
    json.end();
  }
  json.end();
  json.end();
  return json;
}

}  // namespace

Status measureCraters(const RenderSettings& settings, const std::string& json_file) {
  fmt::print("{} x {}, median ms a picture (frames a second; time over that without craters), by the hash's cells\n",
             settings.width_px, settings.height_px);
  fmt::print("{:>8}", "craters");
  for (const int hash_cell_m : kHashCells_m) fmt::print("{:>24}", nameOf(hash_cell_m));
  fmt::print("\n");
  std::vector<Measurement> measurements;
  std::vector<double> empty_ms;
  for (const int count : kCraterCounts) {
    fmt::print("{:>8}", count);
    const std::size_t first = measurements.size();
    for (std::size_t i = 0; i < std::size(kHashCells_m); ++i) {
      measurements.push_back(measure(settings, kHashCells_m[i], count));
      const Measurement& last = measurements.back();
      if (last.picture != measurements[first].picture)
        return Error{fmt::format("{} craters: the picture with hash cells of {} differs from that of {}", count,
                                 nameOf(last.hash_cell_m), nameOf(measurements[first].hash_cell_m))};
      if (count == 0) empty_ms.push_back(last.frame_ms);
      fmt::print("{:>24}", fmt::format("{:.2f} ({:.1f}; {:.2f})", last.frame_ms, 1000.0 / last.frame_ms,
                                       last.frame_ms / empty_ms[i]));
      std::fflush(stdout);
    }
    fmt::print("\n");
  }
  fmt::print("pictures of the same craters: equal in all bytes\n");
  return json_file.empty() ? Status{} : jsonOf(settings, measurements).writeFile(json_file);
}

}  // namespace spoor
