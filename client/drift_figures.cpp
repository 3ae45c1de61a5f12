#include "client/drift_figures.h"

#include <utility>

#include "client/drift_scenes.h"
#include "client/figure_scene.h"
#include "client/views.h"

namespace spoor {

namespace {

using WritePicture = std::function<Status(const Renderer&, const std::string&)>;

/// From beside the tracks, over the ground.
Camera besideTracks(const TerrainView& view, const glm::dvec2& eye_m, double over_m, const glm::dvec2& target_m) {
  return cameraLookingAt({eye_m, groundHeight(view, eye_m) + over_m}, {target_m, groundHeight(view, target_m)});
}

/// One scene at some tick, from some places.
struct DriftPicture {
  const char* name;
  glm::dvec2 eye_m;
  double over_m;
  glm::dvec2 target_m;
};

Status drawAt(FigureScene& scene, std::int32_t tick, std::span<const DriftPicture> pictures,
              const RenderSettings& settings, const std::string& prefix, const WritePicture& write) {
  if (const Status run = scene.runTo(tick); !run) return run;
  Renderer renderer(scene.pack(), settings);
  for (const DriftPicture& picture : pictures) {
    renderer.draw(scene.view(), besideTracks(scene.view(), picture.eye_m, picture.over_m, picture.target_m));
    if (const Status written = write(renderer, prefix + picture.name); !written) return written;
  }
  return {};
}

Status drawScene(ScenePack pack, std::int32_t tick, std::span<const DriftPicture> pictures,
                 const RenderSettings& settings, const std::string& prefix, const BackendMaker& makeBackend,
                 const WritePicture& write) {
  auto backend = makeBackend();
  if (!backend) return Error{backend.error()};
  FigureScene scene(std::move(pack), std::move(*backend));
  return drawAt(scene, tick, pictures, settings, prefix, write);
}

constexpr double kSun_deg = 30.0;

}  // namespace

Status drawDrift(const RenderSettings& asked, const BackendMaker& makeBackend, const WritePicture& write) {
  RenderSettings settings = asked;
  settings.sun_elevation_deg = kSun_deg;
  constexpr DriftPicture kTracks[] = {{"", {5.2, 6.3}, 1.5, {7.6, 8.2}}, {"_close", {7.3, 7.2}, 0.75, {8.1, 8.05}}};
  constexpr std::pair<const char*, DriftMaterial> kMaterials[] = {
      {"mud", DriftMaterial::mud}, {"pebbles", DriftMaterial::pebbles}, {"sand", DriftMaterial::sand}};
  for (const auto& [name, material] : kMaterials)
    if (const Status drawn = drawScene(driftTracksPack({material}), kTracksTicks, kTracks, settings,
                                       std::string("drift_") + name, makeBackend, write);
        !drawn)
      return drawn;

  constexpr DriftPicture kBorders[] = {{"_mud_pebbles", {3.4, 5.6}, 1.7, {5.4, 8.2}},
                                       {"_pebbles_sand", {8.6, 5.6}, 1.7, {10.3, 7.9}},
                                       {"_close", {4.6, 7.4}, 0.8, {5.3, 8.3}},
                                       {"_all", {7.7, -3.5}, 7.0, {7.7, 6.0}}};
  if (const Status drawn = drawScene(driftTracksPack({DriftMaterial::mud, DriftMaterial::pebbles, DriftMaterial::sand}),
                                     kTracksTicks, kBorders, settings, "drift_border", makeBackend, write);
      !drawn)
    return drawn;

  auto backend = makeBackend();
  if (!backend) return Error{backend.error()};
  FigureScene snowed(snowedTracksPack(), std::move(*backend));
  constexpr std::pair<std::int32_t, const char*> kMoments[] = {
      {kTracksTicks, "_before"}, {kTracksTicks + 90, "_little"}, {kTracksTicks + 270, "_some"}, {kSnowTicks, "_after"}};
  for (const auto& [tick, moment] : kMoments)
    if (const Status drawn =
            drawAt(snowed, tick, std::span(kTracks).first(1), settings, std::string("drift_snow") + moment, write);
        !drawn)
      return drawn;

  constexpr DriftPicture kBall[] = {{"", {6.3, 1.6}, 3.6, {7.0, 7.6}}};
  return drawScene(growingBallPack(), 300, kBall, settings, "drift_growing", makeBackend, write);
}

}  // namespace spoor
