// spoor-replay: what a session file holds, and whether this machine gets the same.
#include <algorithm>
#include <cstdio>
#include <deque>
#include <exception>

#include "server/named_parameters.h"
#include "server/snowfall_text.h"
#include "shaders/host/make_backend.h"
#include "shared/base/json.h"
#include "shared/base/options.h"
#include "shared/codec/session.h"
#include "shared/sim/simulation.h"
#include "shared/world/crater_text.h"

namespace spoor {
namespace {

int fail(const std::string& why) {
  std::fprintf(stderr, "spoor-replay: %s\n", why.c_str());
  return 1;
}

void printInfo(const SessionReader& reader) {
  const ScenePack& pack = reader.pack();
  std::printf("scene %s, pack %s\nworld %d x %d cells of %g m, %zu bodies\n", pack.name.c_str(),
              toText(reader.id()).c_str(), pack.width_cells, pack.height_cells, pack.cell_q / 1e4, pack.bodies.size());
}

constexpr std::size_t kCratersListed = 20;

void printCraters(std::span<const Crater> craters) {
  for (const Crater& crater : craters.first(std::min(craters.size(), kCratersListed)))
    std::printf("tick %d: crater %u at %s\n", crater.tick, crater.id, describeCrater(crater).c_str());
  if (craters.size() > kCratersListed) std::printf("and %zu craters more\n", craters.size() - kCratersListed);
}

void printMaterials(const ScenePack& pack) {
  constexpr const char* kMaps[] = {"the first everywhere", "by an image", "by rules over height and slope"};
  std::printf("materials %zu, %s\n", pack.materials.size(), kMaps[int(pack.material_map.kind)]);
  for (const Material& material : pack.materials)
    std::printf("  %s, colour #%02x%02x%02x\n", material.name.c_str(), material.colour[0], material.colour[1],
                material.colour[2]);
}

int info(SessionReader& reader) {
  printInfo(reader);
  printMaterials(reader.pack());
  Parameters parameters = reader.pack().parameters;
  std::printf("parameters at the start\n");
  for (const std::string& line : describeParameters(reader.pack(), parameters)) std::printf("  %s\n", line.c_str());
  for (const Snowfall& snowfall : reader.pack().snowfalls)
    std::printf("snowfall on %s\n", describeSnowfall(reader.pack(), snowfall).c_str());
  TickRecord last;
  std::vector<Crater> craters;
  std::size_t snowfall_count = reader.pack().snowfalls.size();
  for (;;) {
    auto record = reader.next();
    if (!record) return fail(record.error());
    if (!*record) break;
    last = std::move(**record);
    craters.insert(craters.end(), last.craters.begin(), last.craters.end());
    for (const Snowfall& snowfall : last.snowfalls)
      std::printf("tick %d: snowfall on %s\n", last.tick, describeSnowfall(reader.pack(), snowfall).c_str());
    snowfall_count += last.snowfalls.size();
    if (!last.parameters) continue;
    std::printf("tick %d: %s\n", last.tick, describeChange(reader.pack(), parameters, *last.parameters).c_str());
    parameters = *last.parameters;
  }
  printCraters(craters);
  std::printf("craters %zu, ledger's crater budget %lld\n", craters.size(),
              static_cast<long long>(last.ledger.craters));
  std::printf("snowfalls %zu, ledger's events %lld\n", snowfall_count, static_cast<long long>(last.ledger.events));
  std::printf("ticks %d%s\nlast hash %s, ledger error %lld\n", last.tick,
              reader.truncated() ? " (the file ends within the next)" : "", hexText(last.state_hash).c_str(),
              static_cast<long long>(last.ledger.error()));
  return 0;
}

/// One line for each tick, as comma-separated values.
int exportTicks(SessionReader& reader) {
  std::printf("tick,state_hash,initial,ground,compacted,craters,events,new_craters,new_snowfalls\n");
  for (;;) {
    auto record = reader.next();
    if (!record) return fail(record.error());
    if (!*record) return 0;
    const TickRecord& tick = **record;
    std::printf("%d,%s,%lld,%lld,%lld,%lld,%lld,%zu,%zu\n", tick.tick, hexText(tick.state_hash).c_str(),
                static_cast<long long>(tick.ledger.initial), static_cast<long long>(tick.ledger.ground),
                static_cast<long long>(tick.ledger.compacted), static_cast<long long>(tick.ledger.craters),
                static_cast<long long>(tick.ledger.events), tick.craters.size(), tick.snowfalls.size());
  }
}

int verify(SessionReader& reader, std::unique_ptr<Backend> backend) {
  printInfo(reader);
  const BaseTerrain base(reader.pack());
  Simulation simulation(base, reader.id(), std::move(backend));
  std::printf("backend %s\n", simulation.backend().name().c_str());
  // The next tick is begun before one is finished, so that a device works on it while this one is compared.
  std::deque<TickRecord> begun;
  for (bool ended = false;;) {
    while (!ended && begun.size() < Simulation::kTicksInFlight) {
      auto record = reader.next();
      if (!record) return fail(record.error());
      ended = !*record;
      if (ended) break;
      if (Status status =
              simulation.begin((*record)->poses, (*record)->parameters, (*record)->craters, (*record)->snowfalls);
          !status)
        return fail("tick " + std::to_string((*record)->tick) + ": " + status.error());
      begun.push_back(std::move(**record));
    }
    if (begun.empty()) break;
    const TickRecord tick = std::move(begun.front());
    begun.pop_front();
    auto result = simulation.finish();
    if (!result) return fail("tick " + std::to_string(tick.tick) + ": " + result.error());
    if (result->update.state_hash != tick.state_hash)
      return fail("tick " + std::to_string(tick.tick) + ": hash " + hexText(result->update.state_hash) + " here, " +
                  hexText(tick.state_hash) + " recorded");
    if (result->ledger != tick.ledger || tick.ledger.error() != 0)
      return fail("tick " + std::to_string(tick.tick) + ": the ledger is off by " +
                  std::to_string(result->ledger.error()) + " here, by " + std::to_string(tick.ledger.error()) +
                  " in the record");
    if (tick.tick % 100 == 0) std::fprintf(stderr, "tick %d\n", tick.tick);
  }
  if (simulation.state().tick == 0) return fail("the session holds no ticks");
  std::printf("verified %d ticks%s: every hash and ledger equal, last hash %s\n", simulation.state().tick,
              reader.truncated() ? " (the file ends within the next)" : "",
              hexText(stateHash(simulation.state())).c_str());
  return 0;
}

int run(int argc, char** argv) {
  std::vector<std::string> arguments;
  std::string backend_name = "auto";
  std::int64_t threads = 0;
  Options options("spoor-replay",
                  "reads a session file: info, verify (run it again), export (one CSV line for each tick)");
  options.addPlain("info|verify|export FILE", "what to do, with which session file", &arguments, 2);
  options.add("backend", "NAME", "auto, gl or native; auto: gl on a hardware renderer", &backend_name);
  options.add("threads", "N", "of the processor; 0: one for each core", &threads, 0, 256);
  options.parseOrExit(argc, argv);
  const std::string what = arguments.empty() ? "" : arguments[0];
  if (arguments.size() < 2 || (what != "info" && what != "verify" && what != "export")) {
    std::fprintf(stderr, "spoor-replay: give info, verify or export, and a session file (see --help)\n");
    return 2;
  }
  auto reader = SessionReader::open(arguments[1]);
  if (!reader) return fail(reader.error());
  if (what == "info") return info(**reader);
  if (what == "export") return exportTicks(**reader);
  const auto say = [](const std::string& line) { std::fprintf(stderr, "%s\n", line.c_str()); };
  auto backend = makeBackend({backend_name, "auto", int(threads)}, say);
  if (!backend) return fail(backend.error());
  return verify(**reader, std::move(*backend));
}

}  // namespace
}  // namespace spoor

int main(int argc, char** argv) {
  try {
    return spoor::run(argc, argv);
  } catch (const std::exception& error) {
    return spoor::fail(error.what());
  }
}
