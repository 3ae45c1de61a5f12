// spoor-figures: simulates scenes without a server and draws them as pictures, the thesis's figures among them.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>

#include "client/crater_measure.h"
#include "client/drift_figures.h"
#include "client/drift_measure.h"
#include "client/figure_scene.h"
#include "client/picture_options.h"
#include "client/views.h"
#include "shaders/host/gl_context.h"
#include "shaders/host/make_backend.h"
#include "shared/base/options.h"
#include "shared/base/statistics.h"
#include "shared/world/tile_snow.h"

namespace spoor {

namespace {

struct Arguments {
  std::string folder = ".";
  std::string only;
  std::string pack;
  std::int64_t tick = -1;
  std::string look = "trails";
  std::int64_t crater = 0;
  std::string measure;
  std::string json;
  std::string name;
  bool highlight = false;
  bool everything_active = false;
  bool no_bodies = false;
  std::int64_t range_mm = 0;
  std::int64_t frame_count = 0;
  double sun_deg = 0.0;
  BackendChoice backend;
  PictureArguments picture;
};

/// A figure of the thesis that needs no pack: one way of displacement with each metric.
struct DisplacementFigure {
  const char* number;
  const char* name;
  Displacement displacement;
};
constexpr DisplacementFigure kDisplacementFigures[] = {{"5.1", "iterative", Displacement::iterative},
                                                       {"5.2", "direct", Displacement::direct},
                                                       {"5.3", "spread", Displacement::spread}};
constexpr std::pair<const char*, Metric> kMetrics[] = {
    {"euclidean", Metric::euclidean}, {"manhattan", Metric::manhattan}, {"chebyshev", Metric::chebyshev}};
// Untouched ground is pale, the bottom of the box's hole blue, the highest wall of all nine pictures all but the last
// red.
constexpr ColumnSettings kFigureColours{-5000, 0, 40000};

constexpr std::array<std::string_view, 5> kLooks{"trails", "follow", "above", "overview", "columns"};
constexpr std::pair<std::string_view, CraterLook> kCraterLooks[] = {{"crater", CraterLook::at_once},
                                                                    {"crater-ground", CraterLook::ground},
                                                                    {"crater-inside", CraterLook::inside},
                                                                    {"crater-above", CraterLook::above}};

/// What the pictures of craterLooksPack() show.
struct CraterFigure {
  const char* name;
  int id;
  CraterLook look;
};
constexpr CraterFigure kCraterFigures[] = {
    {"single", CraterLooks::single, CraterLook::at_once}, {"double", CraterLooks::twin, CraterLook::at_once},
    {"deep", CraterLooks::deep, CraterLook::at_once},     {"shallow", CraterLooks::shallow, CraterLook::at_once},
    {"inside", CraterLooks::deep, CraterLook::inside},    {"ground", CraterLooks::single, CraterLook::ground},
    {"above", CraterLooks::single, CraterLook::above}};

constexpr double kCraterSun_deg = 34.0;  // a lower one leaves cavities dark

/// Above the horizon.
double sunOf(const Arguments& arguments, bool of_crater) {
  if (arguments.sun_deg > 0.0) return arguments.sun_deg;
  return of_crater ? kCraterSun_deg : RenderSettings().sun_elevation_deg;
}

Result<std::unique_ptr<Backend>> backendFor(const Arguments& arguments) {
  return makeBackend(arguments.backend, [](const std::string& line) { fmt::print("{}\n", line); });
}

Status writePicture(const Renderer& renderer, const Arguments& arguments, const std::string& name) {
  const std::string file = (std::filesystem::path(arguments.folder) / (name + ".png")).string();
  if (const Status written = writePng(renderer.readPicture(), file); !written) return written;
  fmt::print("picture {}\n", file);
  std::fflush(stdout);
  return {};
}

Status drawDisplacement(const Arguments& arguments, const RenderSettings& settings, const DisplacementFigure& figure) {
  for (const auto& [metric_name, metric] : kMetrics) {
    auto backend = backendFor(arguments);
    if (!backend) return Error{backend.error()};
    FigureScene scene(pressedBoxPack(figure.displacement, metric), std::move(*backend));
    if (const Status run = scene.runTo(kPressedBoxTicks, pressedBoxPoses(scene.pack())); !run) return run;
    RenderSettings columns = settings;
    columns.shade = Shade::columns;
    columns.columns = kFigureColours;
    columns.bodies = false;  // the box would hide what it did
    Renderer renderer(scene.pack(), columns);
    renderer.draw(scene.view(), columnsView(scene.view()));
    const std::string name = fmt::format("figure_{}_{}_{}", figure.number, figure.name, metric_name);
    if (const Status written = writePicture(renderer, arguments, name); !written) return written;
  }
  fmt::print("colours: blue {} mm, pale {} mm, red {} mm\n", kFigureColours.lowest_q / 10, kFigureColours.middle_q / 10,
             kFigureColours.highest_q / 10);
  return {};
}

Status drawCraters(const Arguments& arguments, RenderSettings settings) {
  auto backend = backendFor(arguments);
  if (!backend) return Error{backend.error()};
  FigureScene scene(craterLooksPack(), std::move(*backend));
  if (const Status run = scene.runTo(scene.pack().default_ticks); !run) return run;
  settings.sun_elevation_deg = sunOf(arguments, true);
  Renderer renderer(scene.pack(), settings);
  for (const CraterFigure& figure : kCraterFigures) {
    renderer.draw(scene.view(), craterView(scene.view(), std::uint32_t(figure.id), figure.look,
                                           settings.sun_azimuth_deg, double(settings.width_px) / settings.height_px));
    const bool own = settings.ground == Ground::scene;  // which is snow
    const std::string name = fmt::format("crater_{}_{}", figure.name, own ? "snow" : arguments.picture.ground);
    if (const Status written = writePicture(renderer, arguments, name); !written) return written;
  }
  return {};
}

Result<ScenePack> readPack(const std::string& path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) return Error{path + ": cannot be opened"};
  const auto size = std::size_t(file.tellg());
  if (size > kPackBytesLimit) return Error{fmt::format("{}: {} bytes, over the limit of a pack", path, size)};
  file.seekg(0);
  const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(file), {}};
  auto pack = decodePack(bytes);
  if (!pack) return Error{path + ": " + pack.error()};
  return pack;
}

const std::pair<std::string_view, CraterLook>* craterLookNamed(std::string_view look) {
  const auto found = std::ranges::find(kCraterLooks, look, &std::pair<std::string_view, CraterLook>::first);
  return found == std::end(kCraterLooks) ? nullptr : found;
}

Camera cameraFor(const Arguments& arguments, const TerrainView& view, const RenderSettings& settings) {
  const std::string& look = arguments.look;
  const double aspect = double(settings.width_px) / settings.height_px;
  if (const auto* crater = craterLookNamed(look))
    return craterView(view, std::uint32_t(arguments.crater), crater->second, settings.sun_azimuth_deg, aspect);
  if (look == "follow") return followView(view, 0);
  if (look == "above") return aboveView(view, aspect);
  if (look == "overview") return overviewView(view, aspect);
  if (look == "columns") return columnsView(view);
  return trailsView(view, settings.sun_azimuth_deg);
}

/// Runs and draws some ticks more and says what a picture takes.
Status timeFrames(FigureScene& scene, Renderer& renderer, const Camera& camera, std::int32_t tick, int frame_count) {
  std::vector<double> heights_ms, normals_ms, draw_ms;
  for (int frame = 1; frame <= frame_count; ++frame) {
    if (const Status run = scene.runTo(tick + frame); !run) return run;
    renderer.tilesChanged(scene.activeTiles());
    for (const Tile* tile : tilesInSnow(scene.state(), tick + frame, SnowTiles::asleep))
      renderer.tilesChanged({&tile->at, 1});
    FrameTimes times;
    renderer.draw(scene.view(), camera, &times);
    heights_ms.push_back(times.heights_ms);
    normals_ms.push_back(times.normals_ms);
    draw_ms.push_back(times.draw_ms);
  }
  fmt::print("medians of {} pictures of {} x {}: normals {:.3f} ms, copy of heights {:.3f} ms, drawing {:.3f} ms\n",
             frame_count, renderer.settings().width_px, renderer.settings().height_px, percentile(normals_ms, 0.5),
             percentile(heights_ms, 0.5), percentile(draw_ms, 0.5));
  return {};
}

Status drawPack(const Arguments& arguments, RenderSettings settings) {
  auto pack = readPack(arguments.pack);
  if (!pack) return Error{pack.error()};
  if (arguments.everything_active) pack->parameters.active_areas = 0;
  if (const Status valid = validatePack(*pack); !valid) return Error{arguments.pack + ": " + valid.error()};
  if (arguments.look == "follow" && pack->bodies.empty()) return Error{arguments.pack + ": no body to follow"};
  const std::string name = arguments.name.empty()
                               ? std::filesystem::path(arguments.pack).stem().string() + "_" + arguments.look
                               : arguments.name;
  const std::int32_t tick = arguments.tick < 0 ? pack->default_ticks : std::int32_t(arguments.tick);
  auto backend = backendFor(arguments);
  if (!backend) return Error{backend.error()};
  FigureScene scene(std::move(*pack), std::move(*backend));
  if (const Status run = scene.runTo(tick); !run) return Error{arguments.pack + ": " + run.error()};

  if (craterLookNamed(arguments.look) && std::size_t(arguments.crater) >= scene.state().craters.size())
    return Error{fmt::format("{}: crater {} is asked for, there are {} at tick {}", arguments.pack, arguments.crater,
                             scene.state().craters.size(), tick)};

  if (arguments.look == "columns") settings.shade = Shade::columns;
  settings.sun_elevation_deg = sunOf(arguments, craterLookNamed(arguments.look) != nullptr);
  settings.columns = {-std::int32_t(arguments.range_mm) * 10, 0, std::int32_t(arguments.range_mm) * 10};
  settings.bodies = !arguments.no_bodies;
  Renderer renderer(scene.pack(), settings);
  if (arguments.highlight) renderer.highlightTiles(scene.activeTiles());
  renderer.draw(scene.view(), cameraFor(arguments, scene.view(), settings));
  fmt::print("tick {}, {} tiles simulated in it\n", tick, scene.activeTiles().size());
  if (const Status written = writePicture(renderer, arguments, name); !written) return written;
  if (arguments.frame_count == 0) return {};
  return timeFrames(scene, renderer, cameraFor(arguments, scene.view(), settings), tick, int(arguments.frame_count));
}

Status drawAll(const Arguments& arguments, const RenderSettings& settings) {
  std::error_code problem;
  std::filesystem::create_directories(arguments.folder, problem);
  if (problem) return Error{fmt::format("folder {}: {}", arguments.folder, problem.message())};
  const auto context = openHeadlessContext();
  if (!context) return Error{context.error()};
  fmt::print("renderer {} ({})\n", (*context)->renderer(), (*context)->path());
  if (arguments.measure == "craters") return measureCraters(settings, arguments.json);
  if (arguments.measure == "drift") return measureDrift(settings, arguments.backend, arguments.json);
  if (!arguments.pack.empty()) return drawPack(arguments, settings);
  if (arguments.only == "craters") return drawCraters(arguments, settings);
  if (arguments.only == "drift")
    return drawDrift(
        settings, [&] { return backendFor(arguments); },
        [&](const Renderer& renderer, const std::string& name) { return writePicture(renderer, arguments, name); });
  for (const DisplacementFigure& figure : kDisplacementFigures)
    if (arguments.only.empty() || arguments.only == figure.number)
      if (const Status drawn = drawDisplacement(arguments, settings, figure); !drawn) return drawn;
  return {};
}

int refuse(const std::string& why) {
  fmt::print(stderr, "spoor-figures: {}\n", why);
  return 2;
}

int run(int argc, char** argv) {
  Arguments arguments;
  Options options(
      "spoor-figures",
      "Simulates and draws: without --pack the thesis's figures 5.1 to 5.3, with it one picture of a pack.");
  options.add("out", "DIR", "where pictures go", &arguments.folder);
  options.add("only", "NUMBER",
              "one figure: 5.1, 5.2 or 5.3; craters: a crater of each kind; drift: tracks in materials",
              &arguments.only);
  options.add("pack", "FILE", "the scene pack to draw", &arguments.pack);
  options.add("ticks", "COUNT", "after how many ticks; -1: the pack's own", &arguments.tick, -1, 1 << 30);
  options.add(
      "look", "LOOK",
      "trails, follow, above, overview, columns, or of a crater: crater, crater-ground, crater-inside, crater-above",
      &arguments.look);
  options.add("crater", "ID", "which crater to look at", &arguments.crater, 0, kCratersLimit - 1);
  options.add(
      "measure", "WHAT",
      "craters: what a picture takes with and without them, by the cells of their hash; drift: what a frame takes "
      "with a sweep of it, by grid and tessellation",
      &arguments.measure);
  options.add("json", "FILE", "with --measure: where the numbers go", &arguments.json);
  options.add("name", "NAME", "of the picture, without .png; default: the pack's file and the look", &arguments.name);
  options.add("range", "MM", "columns: heights of the first and last colour, below and above 0; 0: what the area holds",
              &arguments.range_mm, 0, 100000);
  options.add("sun", "DEGREES", "above the horizon: the lower, the better shallow tracks show; 0: 21, of craters 34",
              &arguments.sun_deg, 0.0, 89.0);
  options.add("frames", "COUNT", "with --pack: run and draw so many ticks more, and print what a picture takes",
              &arguments.frame_count, 0, 100000);
  options.addFlag("highlight", "mark the tiles that the last tick simulated", &arguments.highlight);
  options.addFlag("all-active", "simulate all of the terrain in every tick", &arguments.everything_active);
  options.addFlag("no-bodies", "leave the bodies out of the picture", &arguments.no_bodies);
  options.add("backend", "NAME", "auto, gl or native; auto: gl on a hardware renderer", &arguments.backend.name);
  options.add("gl-device", "NAME", "of the gl backend: auto, surfaceless or an EGL device's number",
              &arguments.backend.gl_device);
  addPictureOptions(options, arguments.picture);
  options.parseOrExit(argc, argv);

  const auto settings = pictureSettings(arguments.picture);
  if (!settings) return refuse(settings.error());
  if (std::ranges::find(kLooks, arguments.look) == kLooks.end() && !craterLookNamed(arguments.look))
    return refuse(
        fmt::format("--look \"{}\": want trails, follow, above, overview, columns, crater, crater-ground, "
                    "crater-inside or crater-above",
                    arguments.look));
  if (!arguments.measure.empty() && arguments.measure != "craters" && arguments.measure != "drift")
    return refuse(fmt::format("--measure \"{}\": want craters or drift", arguments.measure));
  if (!arguments.json.empty() && arguments.measure.empty()) return refuse("--json: goes with --measure");
  const auto known = [&](const DisplacementFigure& figure) { return arguments.only == figure.number; };
  const bool other = arguments.only == "craters" || arguments.only == "drift";
  if (!arguments.only.empty() && !other && std::ranges::none_of(kDisplacementFigures, known))
    return refuse(fmt::format("--only \"{}\": want 5.1, 5.2 or 5.3, or craters or drift", arguments.only));
  if (const Status done = drawAll(arguments, *settings); !done) {
    fmt::print(stderr, "spoor-figures: {}\n", done.error());
    return 1;
  }
  return 0;
}

}  // namespace

}  // namespace spoor

int main(int argc, char** argv) {
  try {
    return spoor::run(argc, argv);
  } catch (const std::exception& problem) {
    fmt::print(stderr, "spoor-figures: {}\n", problem.what());
    return 1;
  }
}
