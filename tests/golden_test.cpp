// Every example scene from its committed pack: one hash on every backend, at any thread count and kernel set, a
// balanced ledger at every tick, and sleep soon after the bodies stop. tests/golden/NAME.txt holds a hash for every
// 50th tick.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>

#include "shared/base/json.h"
#include "shared/sim/simulation.h"
#include "shared/world/script.h"
#include "tests/backends.h"

namespace spoor {
namespace {

constexpr int kEvery = 50;
constexpr int kSleepTicks = 120;  // stated bound: ticks from the bodies' stop to the last tile's sleep

std::filesystem::path folder() { return SPOOR_GOLDEN_DIR; }

struct GoldenScene {
  ScenePack pack;
  PackId id;
  std::map<std::int32_t, std::string> hashes;
};

GoldenScene load(const std::string& name) {
  std::ifstream file(folder() / (name + ".pack"), std::ios::binary);
  const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(file), {}};
  auto pack = decodePack(bytes);
  EXPECT_TRUE(pack) << name << ": " << (pack ? "" : pack.error());
  GoldenScene scene{pack ? std::move(*pack) : ScenePack{}, packId(bytes), {}};
  std::ifstream lines(folder() / (name + ".txt"));
  std::int32_t tick;
  for (std::string hash; lines >> tick >> hash;) scene.hashes[tick] = hash;
  return scene;
}

std::vector<std::string> sceneNames() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder()))
    if (entry.path().extension() == ".pack") names.push_back(entry.path().stem());
  std::ranges::sort(names);
  return names;
}

class Golden : public testing::TestWithParam<std::string> {};

/// One case of each of the schedules of gl.
std::vector<test::BackendCase> schedules() {
  std::vector<test::BackendCase> cases = test::glCases();
  std::erase_if(cases, [](const auto& backend_case) { return backend_case.group != 64; });
  return cases;
}

/// A software renderer takes too long for all of a scene's ticks.
constexpr std::int32_t kTicksOnGl = kEvery;

class GoldenOnGl : public testing::TestWithParam<std::tuple<std::string, test::BackendCase>> {
 protected:
  void SetUp() override {
    if (const std::string& lack = test::lackOf(std::get<1>(GetParam())); !lack.empty()) GTEST_SKIP() << lack;
  }
};

TEST_P(GoldenOnGl, TheFirstHashesAreTheCommittedOnes) {
  const auto& [name, backend_case] = GetParam();
  const GoldenScene scene = load(name);
  const BaseTerrain base(scene.pack);
  const Script script(base);
  Simulation simulation(base, scene.id, test::borrowBackend(backend_case));
  const std::int32_t ticks = std::min(scene.pack.default_ticks, kTicksOnGl);
  for (std::int32_t tick = 1; tick <= ticks; ++tick) {
    const auto result = simulation.step(script.poses(tick), {}, script.craters(tick));
    ASSERT_TRUE(result) << result.error();
    ASSERT_EQ(result->ledger.error(), 0) << "tick " << tick;
    if (tick % kEvery == 0 || tick == scene.pack.default_ticks) {
      ASSERT_EQ(hexText(result->update.state_hash), scene.hashes.at(tick)) << "tick " << tick;
    }
  }
  EXPECT_TRUE(recount(simulation.state()));
}

std::string sceneOnCase(const testing::TestParamInfo<GoldenOnGl::ParamType>& info) {
  return std::get<0>(info.param) + "On" + std::get<1>(info.param).name;
}

TEST_P(Golden, HashesAreTheCommittedOnesAndTheGroundGoesToSleep) {
  const GoldenScene scene = load(GetParam());
  const BaseTerrain base(scene.pack);
  const Script script(base);
  Simulation simulation(base, scene.id, makeNativeBackend());
  std::string seen, first_difference;
  const std::int32_t ticks = scene.pack.default_ticks;
  for (std::int32_t tick = 1; tick <= ticks; ++tick) {
    const auto result = simulation.step(script.poses(tick), {}, script.craters(tick));
    ASSERT_TRUE(result) << result.error();
    ASSERT_EQ(simulation.state().ledger.error(), 0) << "tick " << tick;
    EXPECT_FALSE(result->too_fast) << "tick " << tick;
    if (tick % kEvery != 0 && tick != ticks) continue;
    const std::string hash = hexText(result->update.state_hash);
    seen += std::to_string(tick) + " " + hash + "\n";
    const auto golden = scene.hashes.find(tick);
    if (first_difference.empty() && (golden == scene.hashes.end() || golden->second != hash))
      first_difference = std::to_string(tick);
  }
  ASSERT_TRUE(recount(simulation.state()));
  EXPECT_TRUE(first_difference.empty()) << "the hash moved by tick " << first_difference << "; " << GetParam()
                                        << ".txt would now read\n"
                                        << seen;
  if (const char* update = std::getenv("SPOOR_GOLDEN_UPDATE"); update != nullptr)
    std::ofstream(folder() / (GetParam() + ".txt")) << seen;

  const std::vector<Pose> rest = simulation.state().poses;
  int waited = 0;
  while (!simulation.state().tiles.awake().empty() && waited <= kSleepTicks) {
    ASSERT_TRUE(simulation.step(rest));
    ++waited;
  }
  EXPECT_LE(waited, kSleepTicks) << simulation.state().tiles.awake().size() << " tiles still awake";
  RecordProperty("ticks_to_sleep", waited);
  const auto asleep = simulation.step(rest);
  ASSERT_TRUE(asleep);
  EXPECT_EQ(asleep->effect.active_cells, 0);
  EXPECT_TRUE(asleep->effect.changes.empty());
}

TEST_P(Golden, NeitherThreadsNorKernelsNorSkippingShow) {
  const GoldenScene scene = load(GetParam());
  const BaseTerrain base(scene.pack);
  const Script script(base);
  std::vector<NativeOptions> variants = {
      {1, nullptr, false}, {2, nullptr, true}, {3, nullptr, true}, {8, nullptr, true}};
  for (const Kernels* set : availableKernels()) variants.push_back({2, set, true});
  for (const NativeOptions& options : variants) {
    Simulation simulation(base, scene.id, makeNativeBackend(options));
    for (std::int32_t tick = 1; tick <= kEvery; ++tick)
      ASSERT_TRUE(simulation.step(script.poses(tick), {}, script.craters(tick)));
    EXPECT_EQ(hexText(stateHash(simulation.state())), scene.hashes.at(kEvery)) << simulation.backend().name();
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, GoldenOnGl,
                         testing::Combine(testing::ValuesIn(sceneNames()), testing::ValuesIn(schedules())),
                         sceneOnCase);
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(GoldenOnGl);
INSTANTIATE_TEST_SUITE_P(Scenes, Golden, testing::ValuesIn(sceneNames()),
                         [](const auto& scene) { return scene.param; });

}  // namespace
}  // namespace spoor
