// spoor-client: joins a session, follows it, checks it, and shows it in a window or as pictures.
#include <fmt/format.h>

#include <charconv>
#include <cstdio>
#include <exception>
#include <optional>
#include <string>

#include "client/gl_window.h"
#include "client/headless_run.h"
#include "client/picture_options.h"
#include "client/session.h"
#include "client/window_run.h"
#include "shared/base/json.h"
#include "shared/base/options.h"

namespace spoor {

namespace {

struct Arguments {
  std::string connect;
  bool headless = false;
  std::int64_t frame_count = 0;
  std::string folder = ".";
  std::string name = "viewer";
  std::string shade = "lit";
  std::vector<std::string> craters;
  PictureArguments picture;
};

std::optional<std::uint16_t> portIn(std::string_view text) {
  int value = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (problem != std::errc() || end != text.data() + text.size() || value < 1 || value > 65535) return std::nullopt;
  return std::uint16_t(value);
}

Result<ConnectOptions> connectOptions(const Arguments& arguments) {
  const auto colon = arguments.connect.rfind(':');
  const auto port =
      colon == std::string::npos ? std::nullopt : portIn(std::string_view(arguments.connect).substr(colon + 1));
  if (!port || colon == 0)
    return Error{fmt::format("--connect \"{}\": want HOST:PORT with a port of 1 .. 65535", arguments.connect)};
  ConnectOptions options;
  options.host = arguments.connect.substr(0, colon);
  options.port = *port;
  options.name = arguments.name;
  return options;
}

Result<RenderSettings> renderSettings(const Arguments& arguments) {
  auto settings = pictureSettings(arguments.picture);
  if (!settings) return settings;
  if (arguments.shade != "lit" && arguments.shade != "normals" && arguments.shade != "columns")
    return Error{fmt::format("--shade \"{}\": want lit, normals or columns", arguments.shade)};
  if (arguments.shade != "lit") settings->shade = arguments.shade == "columns" ? Shade::columns : Shade::normals;
  return settings;
}

Result<std::vector<TimedCrater>> craterWishes(const Arguments& arguments) {
  std::vector<TimedCrater> craters;
  for (const std::string& text : arguments.craters) {
    const auto crater = parseTimedCrater(text);
    if (!crater) return Error{fmt::format("--crater \"{}\": {}", text, crater.error())};
    craters.push_back(*crater);
  }
  return craters;
}

/// Follows the session in the way asked for.
Status follow(const Arguments& arguments, const ConnectOptions& connect, const RenderSettings& settings,
              const std::vector<TimedCrater>& craters) {
  // The context first: whoever cannot draw should not join.
  std::unique_ptr<GlContext> headless;
  std::unique_ptr<WindowContext> window;
  if (arguments.headless) {
    auto opened = openHeadlessContext();
    if (!opened) return Error{opened.error()};
    headless = std::move(*opened);
  } else {
    auto opened = openWindowContext(settings.width_px, settings.height_px, "Spoor");
    if (!opened) return Error{opened.error()};
    window = std::move(*opened);
  }
  const GlContext& context = headless ? *headless : *window;
  fmt::print("renderer {} ({})\n", context.renderer(), context.path());
  std::fflush(stdout);

  auto session = ClientSession::start(connect);
  if (!session) return Error{session.error()};
  const Status done = arguments.headless
                          ? runHeadless(**session, {int(arguments.frame_count), arguments.folder, settings, craters})
                          : runInWindow(**session, *window, settings, CraterAsker(craters));
  if ((*session)->inSync()) {
    const WorldState& state = (*session)->state();
    fmt::print("tick {}\nmismatches {}\nhash {}\n", state.tick, (*session)->mismatchCount(), hexText(stateHash(state)));
  }
  return done;
}

int run(int argc, char** argv) {
  Arguments arguments;
  Options options("spoor-client", "Joins a session and shows it in a window, or as pictures with --headless.");
  options.add("connect", "HOST:PORT", "the server", &arguments.connect);
  options.addFlag("headless", "no window: follow to the end, then write pictures", &arguments.headless);
  options.add("frames", "count", "pictures spread over the session, with --headless", &arguments.frame_count, 0,
              100000);
  options.add("out", "DIR", "where pictures go", &arguments.folder);
  options.add("name", "NAME", "what the server calls this client", &arguments.name);
  addPictureOptions(options, arguments.picture);
  options.add("shade", "lit|normals|columns", "columns: cells round the focus as bars, coloured by height",
              &arguments.shade);
  options.add("crater", "T:X,Y,R1,R2,D5,...", "ask for one at tick T, metres; then H4 or balanced, then noise, 0 .. 1",
              &arguments.craters);
  options.parseOrExit(argc, argv);

  const auto connect = connectOptions(arguments);
  const auto settings = renderSettings(arguments);
  const auto craters = craterWishes(arguments);
  if (!connect || !settings || !craters) {
    fmt::print(stderr, "spoor-client: {}\n",
               !connect ? connect.error() : (!settings ? settings.error() : craters.error()));
    return 2;
  }
  if (const Status done = follow(arguments, *connect, *settings, *craters); !done) {
    fmt::print(stderr, "spoor-client: {}\n", done.error());
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
    fmt::print(stderr, "spoor-client: {}\n", problem.what());
    return 1;
  }
}
