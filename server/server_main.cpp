// spoor-server: hosts a session.
#include <spdlog/async.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <optional>
#include <thread>

#include "server/console.h"
#include "server/report.h"
#include "server/scene_source.h"
#include "shaders/host/make_backend.h"

namespace spoor {
namespace {

struct Settings {
  SceneSource source;
  std::string backend = "auto", gl_device = "auto", session, json;
  bool list_devices = false, console = false;
  std::vector<std::string> set;
  std::vector<ParameterChange> changes;  // of `set`
  std::vector<std::string> crater;
  std::vector<TimedCrater> craters;  // of `crater`
  std::vector<std::string> snowfall;
  std::vector<TimedSnowfall> snowfalls;  // of `snowfall`
  std::int64_t port = 47474, ticks = 0, seed = -1, threads = 0, wait_clients = 0;
  double rate_hz = -1, wait_s = 60;
};

/// Parses each text of an option; a bad one ends the program.
template <typename Parse>
auto parseAllOrExit(const char* option, const std::vector<std::string>& texts, Parse parse) {
  std::vector<std::remove_cvref_t<decltype(*parse(""))>> values;
  for (const std::string& text : texts) {
    auto value = parse(text);
    if (!value) {
      std::fprintf(stderr, "spoor-server: --%s '%s': %s (see --help)\n", option, text.c_str(), value.error().c_str());
      std::exit(2);
    }
    values.push_back(std::move(*value));
  }
  return values;
}

void parse(int argc, char** argv, Settings& settings) {
  Options options("spoor-server", "hosts a session of a scene");
  addSceneOptions(options, settings.source);
  options.add("port", "N", "UDP port; 0: one the system picks", &settings.port, 0, 65535);
  options.add("backend", "NAME", "auto, gl or native; auto: gl on a hardware renderer", &settings.backend);
  options.add("gl-device", "NAME", "of the gl backend: auto, surfaceless or an EGL device's number",
              &settings.gl_device);
  options.addFlag("list-devices", "print what the gl backend can run on, and leave", &settings.list_devices);
  options.add("threads", "N", "of the processor; 0: one for each core", &settings.threads, 0, 256);
  options.add("ticks", "N", "length of the session; 0: as the scene says", &settings.ticks, 0, 1 << 30);
  options.add("rate", "HZ", "ticks per second; 0: as fast as they go; -1: as the scene says", &settings.rate_hz, -1.0,
              1000.0);
  options.add("session", "FILE", "record the session there", &settings.session);
  options.add("seed", "N", "instead of the scene's seed; -1: the scene's", &settings.seed, -1, INT64_MAX);
  options.add("wait-clients", "N", "begin when so many clients are in sync", &settings.wait_clients, 0, 1000);
  options.add("wait", "S", "how long to wait for them", &settings.wait_s, 0.0, 86400.0);
  options.add("json", "FILE", "also write the table's figures there", &settings.json);
  options.add("set", "T:NAME=VALUE,...", "from tick T on; names as in a scene's [thesis], or MATERIAL.NAME",
              &settings.set);
  options.add("crater", "T:X,Y,R1,R2,D5,...", "at tick T, metres; then H4 or balanced, then noise, 0 .. 1",
              &settings.crater);
  options.add("snowfall", "T:X0,Y0,X1,Y1,MM_PER_HOUR,SECONDS[,SEED]", "from tick T on, metres", &settings.snowfall);
  options.addFlag("console",
                  "read lines NAME=VALUE,..., crater X,Y,R1,R2,D5,... or snow X0,Y0,X1,Y1,... for the next tick",
                  &settings.console);
  options.parseOrExit(argc, argv);
  settings.changes = parseAllOrExit("set", settings.set, parseChange);
  settings.craters = parseAllOrExit("crater", settings.crater, parseTimedCrater);
  settings.snowfalls = parseAllOrExit("snowfall", settings.snowfall, parseTimedSnowfall);
}

/// Logging on a thread of its own that drops its oldest lines rather than hold a tick up.
void setUpLog() {
  spdlog::init_thread_pool(1024, 1);
  auto sink = std::make_shared<spdlog::sinks::stderr_color_sink_mt>();
  spdlog::set_default_logger(std::make_shared<spdlog::async_logger>("spoor-server", sink, spdlog::thread_pool(),
                                                                    spdlog::async_overflow_policy::overrun_oldest));
  spdlog::set_pattern("%H:%M:%S.%e %v");
}

template <typename T>
T orThrow(Result<T> result) {
  if (!result) throw std::runtime_error(result.error());
  return std::move(*result);
}

LoadedScene loadSeeded(const Settings& settings) {
  LoadedScene scene = orThrow(loadScene(settings.source));
  if (settings.seed < 0) return scene;
  scene.pack.seed = std::uint64_t(settings.seed);
  if (scene.pack.base_kind == BaseKind::noise) scene.pack.noise.seed = scene.pack.seed;
  scene.encoded = encodePack(scene.pack);
  scene.id = packId(scene.encoded);
  return scene;
}

/// What is known to be wrong before the first tick is said then: changes that do not go with the pack, or with each
/// other.
void checkChanges(const ScenePack& pack, std::vector<ParameterChange> changes) {
  std::ranges::stable_sort(changes, {}, &ParameterChange::tick);
  Parameters parameters = pack.parameters;
  std::vector<std::string> notes;
  for (const ParameterChange& change : changes) {
    const auto changed = changeParameters(pack, parameters, change.values, notes);
    if (!changed) throw std::runtime_error(fmt::format("--set, tick {}: {}", change.tick, changed.error()));
    parameters = *changed;
  }
}

void checkCraters(const ScenePack& pack, const std::vector<TimedCrater>& craters) {
  for (const TimedCrater& crater : craters)
    if (const auto resolved = resolveCrater(pack, crater.wish); !resolved)
      throw std::runtime_error(fmt::format("--crater, tick {}: {}", crater.tick, resolved.error()));
}

void checkSnowfalls(const ScenePack& pack, const std::vector<TimedSnowfall>& snowfalls) {
  if (pack.snowfalls.size() + snowfalls.size() > kSnowfallsLimit)
    throw std::runtime_error(fmt::format("--snowfall: {} with the scene's, the limit is {}",
                                         pack.snowfalls.size() + snowfalls.size(), kSnowfallsLimit));
  for (const TimedSnowfall& snowfall : snowfalls)
    if (const auto resolved = resolveSnowfall(pack, snowfall.wish, snowfall.tick); !resolved)
      throw std::runtime_error(fmt::format("--snowfall, tick {}: {}", snowfall.tick, resolved.error()));
}

/// Inputs of the command line for ticks that will not come.
template <typename Input>
void warnLate(const char* option, const std::vector<Input>& inputs, std::int32_t ticks) {
  for (const Input& input : inputs)
    if (input.tick > ticks) spdlog::warn("--{}, tick {}: the session ends with tick {}", option, input.tick, ticks);
}

void awaitClients(const SessionHost& host, const Settings& settings) {
  if (settings.wait_clients == 0) return;
  spdlog::info("waiting for {} clients", settings.wait_clients);
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(settings.wait_s);
  while (host.clientsInSync() < settings.wait_clients) {
    if (std::chrono::steady_clock::now() > end)
      throw std::runtime_error(fmt::format("{} of {} clients came within {} s", host.clientsInSync(),
                                           settings.wait_clients, settings.wait_s));
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

int run(int argc, char** argv) {
  Settings settings;
  parse(argc, argv, settings);
  if (settings.list_devices) {
    for (const std::string& line : listDevices()) std::printf("%s\n", line.c_str());
    return 0;
  }
  setUpLog();
  LoadedScene scene = loadSeeded(settings);
  for (const std::string& text : scene.notes) spdlog::info("import: {}", text);
  checkChanges(scene.pack, settings.changes);
  checkCraters(scene.pack, settings.craters);
  checkSnowfalls(scene.pack, settings.snowfalls);
  const BaseTerrain base(scene.pack);
  const auto say = [](const std::string& line) { spdlog::info(line); };
  Simulation simulation(base, scene.id,
                        orThrow(makeBackend({settings.backend, settings.gl_device, int(settings.threads)}, say)));
  spdlog::info("scene {}, {} x {} cells of {} m, pack {}", scene.pack.name, scene.pack.width_cells,
               scene.pack.height_cells, scene.pack.cell_q / 1e4, toText(scene.id));
  spdlog::info("backend {}", simulation.backend().name());
  std::unique_ptr<SessionWriter> writer;
  if (!settings.session.empty()) writer = orThrow(SessionWriter::create(settings.session, scene.encoded));
  HostOptions host_options;
  host_options.port = std::uint16_t(settings.port);
  host_options.max_clients = std::max(host_options.max_clients, int(settings.wait_clients) + 4);
  const auto host = orThrow(SessionHost::open(host_options, scene.pack, scene.encoded));
  spdlog::info("port {}", host->port());

  awaitClients(*host, settings);
  LoopOptions loop;
  loop.ticks = settings.ticks > 0 ? std::int32_t(settings.ticks) : scene.pack.default_ticks;
  loop.rate_hz = settings.rate_hz < 0 ? scene.pack.ticks_per_second : settings.rate_hz;
  loop.changes = settings.changes;
  loop.craters = settings.craters;
  loop.snowfalls = settings.snowfalls;
  warnLate("set", loop.changes, loop.ticks);
  warnLate("crater", loop.craters, loop.ticks);
  warnLate("snowfall", loop.snowfalls, loop.ticks);
  ChangeQueue typed;
  CraterQueue typed_craters;
  SnowfallQueue typed_snowfalls;
  std::optional<Console> console;
  if (settings.console) {
    loop.console = &typed;
    loop.console_craters = &typed_craters;
    loop.console_snowfalls = &typed_snowfalls;
    console.emplace(STDIN_FILENO, typed, typed_craters, typed_snowfalls, say);
  }
  SessionReport report;
  report.figures = runTicks(simulation, base, loop, host.get(), writer.get(), say);
  console.reset();
  report.clients = host->finish(30);
  report.scene = scene.pack.name;
  report.pack_id = toText(scene.id);
  report.backend = simulation.backend().name();
  report.renderer = simulation.backend().renderer();
  report.ticks = simulation.state().tick;
  report.ledger = simulation.state().ledger;
  report.server_hash = stateHash(simulation.state());
  report.live_tiles = simulation.state().tiles.size();
  report.store_bytes = simulation.state().tiles.memoryBytes();
  spdlog::shutdown();
  std::printf("%s", tableOf(report).c_str());
  std::fflush(stdout);

  std::vector<std::string> faults = faultsOf(report, int(settings.wait_clients));
  if (report.ticks < loop.ticks) faults.push_back("the session ended early");
  if (!recount(simulation.state())) faults.push_back("a recount from the heights gives other sums");
  if (writer != nullptr)
    if (Status status = writer->close(); !status) faults.push_back(status.error());
  if (!settings.json.empty())
    if (Status status = jsonOf(report).writeFile(settings.json); !status) faults.push_back(status.error());
  for (const std::string& fault : faults) std::fprintf(stderr, "spoor-server: %s\n", fault.c_str());
  return faults.empty() ? 0 : 1;
}

}  // namespace
}  // namespace spoor

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);
  try {
    return spoor::run(argc, argv);
  } catch (const std::exception& error) {
    spdlog::shutdown();
    std::fprintf(stderr, "spoor-server: %s\n", error.what());
    return 1;
  }
}
