// spoor-fuzz-backends: the gl backend against native on random worlds, tick by tick, until they differ.
#include <chrono>
#include <cstdio>
#include <exception>
#include <optional>
#include <string>
#include <vector>

#include "shared/base/json.h"
#include "shared/base/options.h"
#include "tests/scenes.h"

namespace spoor::test {
namespace {

constexpr int kTicksPerWorld = 20;
constexpr int kExitSkipped = 77;  // for ctest

/// Runs a world on native once and on each case.
struct World20 {
  explicit World20(std::uint32_t seed) : random(randomWorld(seed, kTicksPerWorld)), world(random.pack) {
    Simulation native = world.simulate();
    for (std::size_t i = 0; i < random.ticks.size(); ++i)
      expected.push_back(*native.step(random.ticks[i], random.changeAt(i), random.cratersAt(i), random.snowfallsAt(i)));
  }

  /// What differs first, in words.
  std::optional<std::string> difference(const BackendCase& backend_case) const {
    Simulation simulation = world.simulateOn(backend_case);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const std::string tick = "tick " + std::to_string(i + 1) + ": ";
      const auto result =
          simulation.step(random.ticks[i], random.changeAt(i), random.cratersAt(i), random.snowfallsAt(i));
      if (!result) return tick + result.error();
      const TickResult& wanted = expected[i];
      if (result->update.state_hash != wanted.update.state_hash)
        return tick + "hash " + hexText(result->update.state_hash) + ", not " + hexText(wanted.update.state_hash);
      if (result->update.tiles != wanted.update.tiles) return tick + "other changes, of the same hash";
      if (result->effect.kept_back != wanted.effect.kept_back)
        return tick + std::to_string(result->effect.kept_back) + " kept back, not " +
               std::to_string(wanted.effect.kept_back);
      if (result->effect.penetrating_cells != wanted.effect.penetrating_cells)
        return tick + std::to_string(result->effect.penetrating_cells) + " penetrating cells, not " +
               std::to_string(wanted.effect.penetrating_cells);
    }
    if (!recount(simulation.state())) return "the sums are not those of the cells";
    return std::nullopt;
  }

  RandomWorld random;
  World world;
  std::vector<TickResult> expected;
};

int run(int argc, char** argv) {
  std::int64_t ticks = 1000, seed = 1;
  std::string only;
  Options options("spoor-fuzz-backends", "Compares the gl backend with native on random worlds, tick by tick.");
  options.add("ticks", "ticks", "to run in all, on all cases together", &ticks, 1, std::int64_t(1) << 40);
  options.add("seed", "", "of the first world; the next has the next one", &seed, 0, INT32_MAX);
  options.add("backend-case", "", "the only case to run, by name; empty: all of gl", &only);
  options.parseOrExit(argc, argv);

  std::vector<BackendCase> cases;
  std::string names;
  for (const BackendCase& backend_case : backendCases()) {
    names += " " + backend_case.name;
    if (only.empty() ? backend_case.gl : backend_case.name == only) cases.push_back(backend_case);
  }
  if (cases.empty() && !only.empty()) {
    std::fprintf(stderr, "spoor-fuzz-backends: no case \"%s\"; there are%s\n", only.c_str(), names.c_str());
    return 2;
  }
  const std::string lack = cases.empty() ? "the gl backend is not in this build" : lackOf(cases[0]);
  if (!lack.empty()) {
    std::printf("skipped: %s\n", lack.c_str());
    return kExitSkipped;
  }

  std::int64_t done = 0;
  std::vector<double> seconds(cases.size());
  std::vector<std::int64_t> case_ticks(cases.size());
  for (std::uint32_t world_seed = std::uint32_t(seed); done < ticks; ++world_seed) {
    const World20 world(world_seed);
    for (std::size_t i = 0; i < cases.size() && done < ticks; ++i) {
      const auto start = std::chrono::steady_clock::now();
      if (const auto difference = world.difference(cases[i])) {
        std::printf("%s differs from native\n%s\n%s\n", cases[i].name.c_str(), world.random.description.c_str(),
                    difference->c_str());
        return 1;
      }
      seconds[i] += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      case_ticks[i] += kTicksPerWorld;
      done += kTicksPerWorld;
    }
    if ((world_seed - std::uint32_t(seed)) % 100 == 99) {
      std::printf("seed %u, %lld ticks\n", world_seed, static_cast<long long>(done));
      std::fflush(stdout);
    }
  }
  for (std::size_t i = 0; i < cases.size(); ++i)
    std::printf("%s: %lld ticks equal native's, %.0f ticks/s\n", cases[i].name.c_str(),
                static_cast<long long>(case_ticks[i]), double(case_ticks[i]) / seconds[i]);
  return 0;
}

}  // namespace
}  // namespace spoor::test

int main(int argc, char** argv) {
  try {
    return spoor::test::run(argc, argv);
  } catch (const std::exception& problem) {
    std::fprintf(stderr, "spoor-fuzz-backends: %s\n", problem.what());
    return 1;
  }
}
