#include "client/headless_run.h"

#include <fmt/format.h>

#include <filesystem>
#include <system_error>

#include "client/recording.h"
#include "client/views.h"

namespace spoor {

namespace {

constexpr int kUpdateWait_ms = 20;

Status makeFolder(const std::string& folder) {
  std::error_code problem;
  std::filesystem::create_directories(folder, problem);
  if (problem) return Error{fmt::format("folder {}: {}", folder, problem.message())};
  return {};
}

Status follow(ClientSession& session, CraterAsker asker, Recording& recording) {
  while (!session.ended()) {
    if (const Status served = session.update(kUpdateWait_ms); !served) return served;
    asker.update(session);
    if (session.inSync()) recording.add(session.state(), session.takeChangedTiles());
  }
  if (!session.inSync()) return Error{"session: it ended before its state had arrived"};
  asker.finish();
  recording.finish(session.state());
  return {};
}

Status drawAndWrite(Renderer& renderer, const TerrainView& view, const Camera& camera, const std::string& file) {
  renderer.draw(view, camera);
  if (const Status written = writePng(renderer.readPicture(), file); !written) return written;
  fmt::print("picture {}\n", file);
  std::fflush(stdout);
  return {};
}

}  // namespace

Status runHeadless(ClientSession& session, const HeadlessOptions& options) {
  if (const Status made = makeFolder(options.folder); !made) return made;
  Recording recording(options.frame_count);
  if (const Status followed = follow(session, CraterAsker(options.craters), recording); !followed) return followed;

  const TerrainView view{&session.base(), &session.state()};
  const auto fileOf = [&](const std::string& name) { return (std::filesystem::path(options.folder) / name).string(); };
  const bool has_bodies = !session.pack().bodies.empty();
  const RenderSettings& settings = options.render;
  const Camera above = aboveView(view, double(settings.width_px) / settings.height_px);
  Renderer renderer(session.pack(), settings);
  if (const Status s = drawAndWrite(renderer, view, trailsView(view, settings.sun_azimuth_deg), fileOf("trails.png"));
      !s)
    return s;
  if (has_bodies)
    if (const Status s = drawAndWrite(renderer, view, followView(view, 0), fileOf("follow.png")); !s) return s;
  if (const Status s = drawAndWrite(renderer, view, above, fileOf("above.png")); !s) return s;
  if (options.frame_count == 0 || !has_bodies) return {};

  renderer.forget();
  Status result;
  recording.replay(session.base(), [&](int index, const WorldState& state, std::span<const TileCoordinate> changed) {
    const TerrainView then{&session.base(), &state};
    renderer.tilesChanged(changed);
    result = drawAndWrite(renderer, then, followView(then, 0), fileOf(fmt::format("frame_{:04}.png", index + 1)));
    return bool(result);
  });
  return result;
}

}  // namespace spoor
