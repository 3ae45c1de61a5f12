// One rule, the same hash: whatever the backend, threads, kernels, order of bodies, and wherever a session was taken up
// again.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/scenes.h"

namespace spoor::test {
namespace {

using Hashes = std::vector<std::uint64_t>;

constexpr int kMeetingTicks = 24;

/// Four bodies that meet in the middle of 4 x 3 tiles, one of them faster than a cell a tick. With `ticks` fewer than
/// kMeetingTicks they start nearer to each other.
RandomWorld meeting(int ticks = kMeetingTicks) {
  RandomWorld made;
  made.pack = noisePack(250, 170, 77, -5000, 5000, 4000);
  made.pack.parameters.obstacle_threshold_q = 30;
  const int ahead = kMeetingTicks - ticks;
  addBody(made.pack, boxMesh(9000, 5000, 4000), 60000 + ahead * 2900, 80000, 800);
  addBody(made.pack, wedgeMesh(7000, 12000, 4000), 190000 - ahead * 2900, 85000, 1500);
  addBody(made.pack, tetrahedronMesh(6000), 125000, 30000 + ahead * 2300, 2500);
  addBody(made.pack, bladeMesh(20000, 5000), 130000, 140000 - ahead * 2500, 700);
  std::vector<Pose> poses = initialState({}, BaseTerrain(made.pack)).poses;
  for (int tick = 0; tick < ticks; ++tick) {
    poses = {moved(poses[0], 2900, 0, 0, 30), moved(poses[1], -2900, 100), moved(poses[2], 10, 2300, -20, 200),
             moved(poses[3], -100, -2500, 0, -50)};
    if (tick < ticks - 4)
      made.ticks.push_back(poses);
    else
      made.ticks.push_back(made.ticks.back());
  }
  return made;
}

/// With the craters, snowfalls and new parameters of `random`, if any.
Hashes hashesOf(Simulation simulation, const std::vector<std::vector<Pose>>& ticks,
                const RandomWorld* random = nullptr) {
  Hashes hashes;
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    const auto result = random == nullptr ? simulation.step(ticks[i])
                                          : simulation.step(ticks[i], random->changeAt(i), random->cratersAt(i),
                                                            random->snowfallsAt(i));
    EXPECT_TRUE(result);
    hashes.push_back(result->update.state_hash);
  }
  EXPECT_TRUE(recount(simulation.state()));
  EXPECT_EQ(simulation.state().ledger.error(), 0);
  return hashes;
}

Hashes hashesOf(const World& world, const std::vector<std::vector<Pose>>& ticks, const NativeOptions& options,
                const RandomWorld* random = nullptr) {
  return hashesOf(world.simulate(options), ticks, random);
}

Hashes hashesOn(const BackendCase& backend_case, const World& world, const std::vector<std::vector<Pose>>& ticks) {
  return hashesOf(world.simulateOn(backend_case), ticks);
}

/// Four bodies that meet, with the hashes of native on one thread.
struct Meeting {
  explicit Meeting(int ticks) : made_(meeting(ticks)) {}
  RandomWorld made_;
  World world_{made_.pack};
  Hashes expected_ = hashesOf(world_, made_.ticks, {.thread_count = 1});
};

class Determinism : public ::testing::Test, protected Meeting {
 protected:
  Determinism() : Meeting(kMeetingTicks) {}
};

class DeterminismOfBackends : public OnEveryBackend, protected Meeting {
 protected:
  DeterminismOfBackends() : Meeting(GetParam().slow() ? 8 : kMeetingTicks) {}
};

TEST_P(DeterminismOfBackends, TwoRunsHaveNativesHashes) {
  EXPECT_EQ(hashesOn(GetParam(), world_, made_.ticks), expected_);
  EXPECT_EQ(hashesOn(GetParam(), world_, made_.ticks), expected_);
}

TEST_F(Determinism, EveryTickHasAnotherHash) {
  Hashes distinct = expected_;
  std::ranges::sort(distinct);
  EXPECT_EQ(std::ranges::unique(distinct).begin(), distinct.end()) << "every tick has another hash";
}

TEST_F(Determinism, AnyNumberOfThreadsHasTheSameHashes) {
  for (const int threads : {2, 3, 8})
    for (int run = 0; run < 2; ++run)
      EXPECT_EQ(hashesOf(world_, made_.ticks, {.thread_count = threads}), expected_) << threads;
}

TEST_F(Determinism, EveryKernelsHaveTheSameHashes) {
  for (const Kernels* set : availableKernels())
    EXPECT_EQ(hashesOf(world_, made_.ticks, {.thread_count = 2, .kernels = set}), expected_) << set->name;
}

TEST_F(Determinism, SkippingWhatIsSettledDoesNotShow) {
  EXPECT_EQ(hashesOf(world_, made_.ticks, {.thread_count = 1, .skip_settled = false}), expected_);
  EXPECT_EQ(hashesOf(world_, made_.ticks, {.thread_count = 3, .skip_settled = false}), expected_);
}

/// Hashes of the tiles alone, at every tick, with the bodies listed in another order.
Hashes tileHashesInOrder(const BackendCase& backend_case, const RandomWorld& made,
                         const std::vector<std::size_t>& order) {
  ScenePack pack = made.pack;
  for (std::size_t i = 0; i < order.size(); ++i) pack.bodies[i] = made.pack.bodies[order[i]];
  const World world(std::move(pack));
  Simulation simulation = world.simulateOn(backend_case);
  Hashes hashes;
  for (const auto& poses : made.ticks) {
    std::vector<Pose> permuted;
    for (const std::size_t i : order) permuted.push_back(poses[i]);
    EXPECT_TRUE(simulation.step(permuted));
    hashes.push_back(simulation.state().tiles_hash);
  }
  return hashes;
}

TEST_P(DeterminismOfBackends, TheOrderOfBodiesDoesNotShow) {
  std::vector<std::size_t> order = {0, 1, 2, 3};
  const Hashes expected = tileHashesInOrder(nativeCases()[0], made_, order);
  for (int i = 1; std::ranges::next_permutation(order).found; ++i) {
    if (GetParam().gl && i % (GetParam().slow() ? 23 : 8) != 7) continue;  // three of the 24 orders, or one
    ASSERT_EQ(tileHashesInOrder(GetParam(), made_, order), expected);
  }
}

TEST_P(DeterminismOfBackends, ASessionTakenUpFromASnapshotGoesOnTheSame) {
  for (const std::size_t cut : {std::size_t(0), std::size_t(1), std::size_t(7), std::size_t(21)}) {
    if (cut > made_.ticks.size()) continue;
    Simulation before = world_.simulateOn(GetParam());
    for (std::size_t i = 0; i < cut; ++i) ASSERT_TRUE(before.step(made_.ticks[i]));
    auto state = decodeSnapshot(encodeSnapshot(before.state(), world_.base), world_.id, world_.base);
    ASSERT_TRUE(state) << state.error();
    Simulation after(world_.base, std::move(*state), borrowBackend(GetParam()));
    for (std::size_t i = cut; i < made_.ticks.size(); ++i) {
      const auto result = after.step(made_.ticks[i]);
      ASSERT_TRUE(result);
      ASSERT_EQ(result->update.state_hash, expected_[i]) << "cut at " << cut << ", tick " << i + 1;
    }
  }
}

TEST_P(DeterminismOfBackends, AMirrorOnNativeFollowsAServer) {
  Simulation server = world_.simulateOn(GetParam()), mirror = world_.simulate({.thread_count = 1});
  for (const auto& poses : made_.ticks) {
    const auto published = server.step(poses);
    ASSERT_TRUE(published);
    const auto result = mirror.step(published->update.poses);
    ASSERT_TRUE(result);
    ASSERT_EQ(result->update.state_hash, published->update.state_hash);
    ASSERT_EQ(result->update.tiles, published->update.tiles) << "changes have one encoding";
  }
}

TEST_P(DeterminismOfBackends, ADomainSharedOutBetweenThreadsOrGroupsHasTheSameHashes) {
  // Two wide bodies side by side: every stage hands parts of their domains to different threads.
  ScenePack pack = noisePack(500, 400, 6, -4000, 4000, 30000);
  addBody(pack, wedgeMesh(200000, 300000, 20000), 120000, 200000, 3000);
  addBody(pack, tetrahedronMesh(120000), 380000, 200000, 20000);
  const World world(std::move(pack));
  std::vector<std::vector<Pose>> ticks;
  std::vector<Pose> poses = initialState(world.id, world.base).poses;
  for (int tick = 0; tick < (GetParam().slow() ? 2 : 4); ++tick) {
    poses = {moved(poses[0], 900, 0, -100), moved(poses[1], -800, 300, -300, 20)};
    ticks.push_back(poses);
  }
  const Hashes expected = hashesOf(world, ticks, {.thread_count = 1});
  if (GetParam().gl) {
    EXPECT_EQ(hashesOn(GetParam(), world, ticks), expected);
    return;
  }
  for (const int threads : {2, 3, 8}) {
    BackendCase backend_case = GetParam();
    backend_case.thread_count = threads;
    EXPECT_EQ(hashesOn(backend_case, world, ticks), expected) << threads;
  }
}

TEST_P(DeterminismOfBackends, BodiesThatShareATileButNoDomainDoNotRace) {
  // Long boxes side by side along y, every other one high above the ground: what the domains note about the rows of
  // the tile that they share must not get lost.
  ScenePack pack = noisePack(64, 128, 5, -3000, 3000, 30000);
  for (int i = 0; i < 12; ++i)
    addBody(pack, boxMesh(1500, 110000, 3000), 3500 + i * 5000, 64000, i % 2 == 0 ? 1800 : -90000);
  const World world(std::move(pack));
  std::vector<std::vector<Pose>> ticks;
  std::vector<Pose> poses = initialState(world.id, world.base).poses;
  for (int tick = 0; tick < (GetParam().slow() ? 12 : 60); ++tick) {
    for (std::size_t i = 0; i < poses.size(); ++i)
      poses[i] = moved(poses[i], tick % 2 == 0 ? 900 : -900, 0, tick % 2 == 0 ? -300 : 290);
    ticks.push_back(poses);
  }
  const Hashes expected = hashesOf(world, ticks, {.thread_count = 1});
  if (GetParam().gl) {
    EXPECT_EQ(hashesOn(GetParam(), world, ticks), expected);
    return;
  }
  for (const int threads : {2, 4, 8})
    for (int run = 0; run < 3; ++run) {
      BackendCase backend_case = GetParam();
      backend_case.thread_count = threads;
      ASSERT_EQ(hashesOn(backend_case, world, ticks), expected) << threads << " threads";
    }
}

TEST(DeterminismOfMaterials, ThreadsKernelsAndSkippingDoNotShowWhereBodiesPushAndSnowFalls) {
  for (const SlopeRule rule : {SlopeRule::drift, SlopeRule::exchange})
    for (const Displacement displacement : {Displacement::direct, Displacement::none}) {
      RandomWorld made = meeting();
      made.craters.resize(made.ticks.size());
      made.snowfalls.resize(made.ticks.size());
      ScenePack& pack = made.pack;
      addMaterials(pack, 3, 2);
      pack.parameters.materials.resize(3, pack.parameters.materials[0]);
      pack.parameters.slopes = rule;
      pack.parameters.displacement = displacement;
      for (int i = 0; i < 3; ++i) {
        MaterialRules& own = pack.parameters.materials[std::size_t(i)];
        own.slope_threshold_q = 100 + 300 * i;
        own.diagonal_threshold_q = 140 + 420 * i;
        own.compression_q16 = i * kOneQ16 / 5;
        own.friction_inverse_q32 = 1 << (20 + 2 * i);
      }
      for (Body& body : pack.bodies) body.force_n = 30000;
      for (auto& poses : made.ticks)
        for (Pose& pose : poses) pose.scale_q16 = kFullScale - 700 * int(&poses - made.ticks.data());
      pack.snowfalls = {{{0, 0, 250, 170}, std::int64_t(40) << 32, 1, 100, 3}};
      const World world(made.pack);
      const Hashes expected = hashesOf(world, made.ticks, {.thread_count = 1}, &made);
      for (const Kernels* set : availableKernels())
        EXPECT_EQ(hashesOf(world, made.ticks, {.thread_count = 2, .kernels = set}, &made), expected) << set->name;
      EXPECT_EQ(hashesOf(world, made.ticks, {.thread_count = 7}, &made), expected);
      EXPECT_EQ(hashesOf(world, made.ticks, {.thread_count = 3, .skip_settled = false}, &made), expected);
    }
}

TEST(DeterminismOfRandomWorlds, ThreadsKernelsAndSkippingDoNotShow) {
  for (std::uint32_t seed = 1000; seed < 1030; ++seed) {
    RandomWorld random = randomWorld(seed, 12);
    SCOPED_TRACE(random.description);
    const World world(random.pack);
    const Hashes expected = hashesOf(world, random.ticks, {.thread_count = 1}, &random);
    const auto sets = availableKernels();
    const NativeOptions threads{.thread_count = 3, .kernels = sets[seed % sets.size()]};
    const NativeOptions every_pair{.thread_count = 2, .kernels = sets[0], .skip_settled = false};
    EXPECT_EQ(hashesOf(world, random.ticks, threads, &random), expected);
    EXPECT_EQ(hashesOf(world, random.ticks, every_pair, &random), expected);
  }
}

TEST_P(DeterminismOfBackends, PosesThatCannotBeAreRefusedAndTheStateStaysAsItWas) {
  const RandomWorld& made = made_;
  Simulation simulation = world_.simulateOn(GetParam());
  ASSERT_TRUE(simulation.step(made.ticks[0]));
  const std::uint64_t before = stateHash(simulation.state());
  std::vector<Pose> poses = made.ticks[1];
  poses.pop_back();
  EXPECT_NE(simulation.step(poses).error().find("3 poses for 4 bodies"), std::string::npos);
  for (std::int32_t Pose::*axis : {&Pose::x_q, &Pose::y_q, &Pose::z_q})
    for (const std::int32_t far : {INT32_MAX, INT32_MIN}) {
      poses = made.ticks[1];
      poses[2].*axis = far;
      const auto result = simulation.step(poses);
      ASSERT_FALSE(result);
      EXPECT_NE(result.error().find("body 2"), std::string::npos) << result.error();
    }
  EXPECT_EQ(stateHash(simulation.state()), before);
  EXPECT_TRUE(simulation.step(made.ticks[1]));
}

SPOOR_ON_EVERY_BACKEND(DeterminismOfBackends);

}  // namespace
}  // namespace spoor::test
