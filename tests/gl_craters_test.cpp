// Stage craters of the gl backend: cell by cell against addCraters, and sessions against native tick by tick.
#include <gtest/gtest.h>

#include <ctime>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>

#include "shaders/host/shader_loader.h"
#include "shaders/host/tick_tables.h"
#include "tests/gl_sessions.h"

namespace spoor::test {
namespace {

struct Session {
  std::vector<std::vector<Pose>> poses;
  std::vector<std::vector<Crater>> craters;  // [ticks]
  std::map<std::size_t, Parameters> changes;

  std::optional<Parameters> changeAt(std::size_t tick) const {
    const auto found = changes.find(tick);
    return found == changes.end() ? std::nullopt : std::optional(found->second);
  }
};

std::vector<Pose> initialPoses(const World& world) { return initialState(world.id, world.base).poses; }

Crater craterOf(int x_q, int y_q, int inner, int crest, int rim, int depth, int noise_q16 = 0, int seed = 0) {
  Crater crater;
  crater.x_q = x_q;
  crater.y_q = y_q;
  crater.inner_radius_q = inner;
  crater.crest_radius_q = crest;
  crater.rim_height_q = rim;
  crater.depth_q = depth;
  crater.noise_q16 = std::uint16_t(noise_q16);
  crater.noise_seed = std::uint16_t(seed);
  return crater;
}

class Draw {
 public:
  explicit Draw(std::uint32_t seed) : engine_(seed) {}
  int operator()(int low, int high) { return std::uniform_int_distribution<int>(low, high)(engine_); }

  /// Anywhere on the map, over its border too.
  Crater crater(const ScenePack& pack) {
    auto& draw = *this;
    const int outer = draw(2, pack.crater_limits.radius_q), crest = draw(outer / 2 + 1, outer);
    const int width = pack.width_cells * pack.cell_q, height = pack.height_cells * pack.cell_q;
    return craterOf(draw(-outer, width + outer - 1), draw(-outer, height + outer - 1), 2 * crest - outer, crest,
                    draw(0, 6000), draw(0, 9000), draw(0, 2) == 0 ? 0 : draw(0, 65535), draw(0, 65535));
  }
  std::vector<Crater> craters(const ScenePack& pack, int most) {
    std::vector<Crater> drawn;
    for (int count = (*this)(0, most); count > 0; --count) drawn.push_back(crater(pack));
    return drawn;
  }

 private:
  std::mt19937 engine_;
};

/// Ground for craters; soil is so thin that some reach bedrock.
ScenePack craterPack(int width, int height, std::uint64_t seed, int soil_depth = 12000) {
  ScenePack pack = noisePack(width, height, seed, -3000, 3000, soil_depth);
  pack.crater_limits.radius_q = 40000;
  pack.crater_limits.hash_cell_q = 25000;
  pack.parameters.sweeps_per_tick = 3;
  return pack;
}

/// Two bodies that wander for `ticks` ticks, and craters that fall meanwhile.
Session wander(const World& world, std::uint32_t seed, int ticks, int most_craters) {
  Draw draw(seed);
  Session session;
  std::vector<Pose> poses = initialPoses(world);
  for (int tick = 0; tick < ticks; ++tick) {
    for (Pose& pose : poses) pose = moved(pose, draw(-1500, 2500), draw(-1500, 1500), draw(-40, 40), draw(-900, 900));
    session.poses.push_back(poses);
    session.craters.push_back(draw(0, 2) == 0 ? std::vector<Crater>{} : draw.craters(world.pack, most_craters));
  }
  return session;
}

void compareSession(Simulation& simulation, Simulation& native, const Session& session) {
  for (std::size_t i = 0; i < session.poses.size(); ++i) {
    const auto expected = native.step(session.poses[i], session.changeAt(i), session.craters[i]);
    ASSERT_NO_FATAL_FAILURE(
        compareResults(simulation.step(session.poses[i], session.changeAt(i), session.craters[i]), expected));
  }
  ASSERT_TRUE(recount(simulation.state()));
}

/// The same, but every tick begins before the one before it is finished.
void compareOverlapped(Simulation& simulation, Simulation& native, const Session& session) {
  const auto begin = [&](std::size_t i) {
    const Status begun = simulation.begin(session.poses[i], session.changeAt(i), session.craters[i]);
    ASSERT_TRUE(begun) << begun.error();
  };
  ASSERT_NO_FATAL_FAILURE(begin(0));
  for (std::size_t i = 1; i <= session.poses.size(); ++i) {
    if (i < session.poses.size()) {
      ASSERT_NO_FATAL_FAILURE(begin(i));
    }
    const auto expected = native.step(session.poses[i - 1], session.changeAt(i - 1), session.craters[i - 1]);
    ASSERT_NO_FATAL_FAILURE(compareResults(simulation.finish(), expected));
  }
  ASSERT_TRUE(recount(simulation.state()));
  EXPECT_EQ(stateHash(simulation.state()), stateHash(native.state()));
}

class GlCraters : public OnEveryBackend {};

/// A world whose every tile is live and simulated, and where nothing moves.
ScenePack stillPack(int width, int height, std::uint64_t seed) {
  ScenePack pack = craterPack(width, height, seed);
  pack.parameters.active_areas = 0;
  pack.parameters.sweeps_per_tick = 0;
  return pack;
}

/// Steps with batches of craters and compares every live cell with what the host makes of a tile.
void compareCells(const BackendCase& backend_case, const World& world,
                  const std::vector<std::vector<Crater>>& batches) {
  Simulation simulation = world.simulateOn(backend_case);
  const std::vector<Pose> poses = initialPoses(world);
  ASSERT_TRUE(simulation.step(poses));  // all tiles become live
  CraterSet set(world.pack);
  std::vector<std::unique_ptr<Tile>> tiles;
  const TileCoordinate extent = tileExtent(world.pack);
  for (int y = 0; y < extent.y; ++y)
    for (int x = 0; x < extent.x; ++x) tiles.push_back(makeTile({x, y}, {&world.base, nullptr}, 0));
  std::int64_t gained = 0;
  for (const std::vector<Crater>& batch : batches) {
    const auto result = simulation.step(poses, {}, batch);
    ASSERT_TRUE(result) << result.error();
    const std::size_t first_new = set.size();
    set.add(result->update.craters);
    for (const auto& tile : tiles) {
      gained += addCraters(tile->at, tile->height(), *tile->bedrock, set, first_new, tile->craters);
      const Tile* live = simulation.state().tiles.find(tile->at);
      ASSERT_NE(live, nullptr);
      for (int i = 0; i < rules::kTileCells; ++i)
        ASSERT_EQ(live->height()[std::size_t(i)], tile->height()[std::size_t(i)])
            << "tile " << tile->at.x << ", " << tile->at.y << ", cell " << i << ", " << set.size() << " craters";
      ASSERT_EQ(live->hash, tileHash(*tile));
    }
    ASSERT_EQ(result->ledger.craters, gained);
    ASSERT_EQ(result->ledger.error(), 0);
    for (const TileChange& change : result->effect.changes) ASSERT_EQ(change.width, 0) << "nothing but craters";
  }
  ASSERT_TRUE(recount(simulation.state()));
}

TEST_P(GlCraters, EveryCellIsAsAddCratersMakesIt) {
  for (const auto& [width, height, side] : {std::tuple{150, 100, 25000}, {70, 131, 3000}, {65, 63, 1000000}}) {
    SCOPED_TRACE(std::to_string(width) + " x " + std::to_string(height) + ", hash cells of " + std::to_string(side));
    ScenePack pack = stillPack(width, height, 3);
    pack.crater_limits.hash_cell_q = side;
    Draw draw{std::uint32_t(width)};
    std::vector<std::vector<Crater>> batches;
    for (int i = 0; i < (GetParam().slow() ? 4 : 8); ++i) batches.push_back(draw.craters(pack, 9));
    const World world(std::move(pack));
    ASSERT_NO_FATAL_FAILURE(compareCells(GetParam(), world, batches));
  }
}

TEST_P(GlCraters, HashCellsMayBeSmallerThanCells) {
  ScenePack pack = stillPack(70, 66, 4);
  pack.crater_limits.radius_q = 5000;
  pack.crater_limits.hash_cell_q = 313;
  Draw draw(5);
  std::vector<std::vector<Crater>> batches;
  for (int i = 0; i < 4; ++i) batches.push_back(draw.craters(pack, 30));
  const World world(std::move(pack));
  compareCells(GetParam(), world, batches);
}

TEST_P(GlCraters, AThousandOnOneSpot) {
  ScenePack pack = stillPack(80, 70, 5);
  pack.soil_depth_q = 1 << 26;
  pack.noise.lowest_q = pack.noise.highest_q = -(1 << 26);
  const Crater crater = craterOf(40000, 30000, 5000, 9000, 1000, rules::kCraterHeightLimit, 9000, 77);
  const World world(std::move(pack));
  compareCells(GetParam(), world,
               {std::vector<Crater>(1, crater), std::vector<Crater>(998, crater), std::vector<Crater>(1, crater)});
}

TEST(GlCratersOnOneSpot, MoreThanADispatchLooksAt) {
  const BackendCase backend_case = glCases()[0];
  if (const std::string& lack = lackOf(backend_case); !lack.empty()) GTEST_SKIP() << lack;
  // Few cells in the world, as each takes them all. Depths add up to the limit of a sum.
  ScenePack pack = stillPack(3, 3, 5);
  pack.soil_depth_q = 1 << 27;
  pack.noise.lowest_q = pack.noise.highest_q = -(1 << 27);
  const World world(std::move(pack));
  const Crater crater = craterOf(1400, 1200, 500, 9000, 100, 900, 9000, 77);
  const auto some = [&](int count) { return std::vector<Crater>(std::size_t(count), crater); };
  compareCells(backend_case, world, {some(4095), some(1), some(1), some(60000), some(4000), some(9000)});
}

TEST_P(GlCraters, SessionsEqualNative) {
  for (std::uint32_t seed = 1; seed < (GetParam().slow() ? 4 : 9); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    ScenePack pack = craterPack(170, 140, seed);
    addBody(pack, boxMesh(9000, 12000, 5000), 50000, 60000, 800);
    addBody(pack, wedgeMesh(9000, 12000, 9000), 110000, 60000, 2000);
    pack.parameters.slopes = SlopeRule(seed % 4);
    if (seed % 3 == 0) pack.parameters.materials[0].compression_q16 = kOneQ16 / 3;
    const World world(std::move(pack));
    Simulation simulation = world.simulateOn(GetParam()), native = world.simulate();
    ASSERT_NO_FATAL_FAILURE(compareSession(simulation, native, wander(world, seed, 8, 5)));
  }
}

TEST_P(GlCraters, OverlappedTicksEqualTicksOneByOne) {
  for (std::uint32_t seed = 20; seed < (GetParam().slow() ? 22 : 26); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    ScenePack pack = craterPack(170, 140, seed);
    addBody(pack, boxMesh(9000, 12000, 5000), 50000, 60000, 800);
    const World world(std::move(pack));
    Simulation simulation = world.simulateOn(GetParam()), native = world.simulate();
    ASSERT_NO_FATAL_FAILURE(compareOverlapped(simulation, native, wander(world, seed, 8, 4)));
  }
}

TEST_P(GlCraters, CompactionThatBeginsAndEndsAmongCratersInASmallPool) {
  for (const int pool_tiles : {2, 1 << 16}) {
    SCOPED_TRACE(std::to_string(pool_tiles) + " tiles");
    ScenePack pack = craterPack(200, 140, 7);
    addBody(pack, boxMesh(9000, 12000, 5000), 50000, 60000, 800);
    addBody(pack, boxMesh(9000, 12000, 5000), 150000, 60000, 800);
    const World world(std::move(pack));
    Session session = wander(world, 8, 9, 3);
    Parameters compacting = world.pack.parameters;
    compacting.materials[0].compression_q16 = kOneQ16 / 3;
    compacting.materials[0].compaction_limit_q16 = kOneQ16 / 4;
    session.changes = {{1, compacting}, {4, world.pack.parameters}, {6, compacting}};
    GlOptions options = glOptionsOf(GetParam());
    options.pool_tiles = pool_tiles;
    Simulation simulation(world.base, world.id, makeOwnBackend(options)), native = world.simulate();
    ASSERT_NO_FATAL_FAILURE(compareOverlapped(simulation, native, session));
    EXPECT_GT(simulation.state().ledger.compacted, 0);
  }
}

TEST_P(GlCraters, TilesThatLeaveTheirSlotsBetweenCratersComeBackAsTheyWere) {
  ScenePack pack = craterPack(448, 60, 12, 20000);
  pack.parameters.materials[0].slope_threshold_q = pack.parameters.materials[0].diagonal_threshold_q =
      30000;  // all comes to rest at once
  pack.crater_limits.radius_q = 9000;
  addBody(pack, boxMesh(9000, 20000, 5000), 30000, 30000, 800);
  const World world(std::move(pack));
  GlOptions options = glOptionsOf(GetParam());
  options.pool_tiles = 1;
  int said = 0;
  options.say = [&said](const std::string& line) { said += line.find("pool is full") != std::string::npos ? 1 : 0; };
  Simulation simulation(world.base, world.id, makeOwnBackend(options)), native = world.simulate();
  Session session;
  std::vector<Pose> poses = initialPoses(world);
  for (int i = 0; i < 24; ++i) {
    if (i > 0 && i < 7) poses[0] = moved(poses[0], 60000, 100);  // tiles become live, then it stands
    session.poses.push_back(poses);
    session.craters.push_back({craterOf(i * 3 % 7 * 64000 + 32000 + i * 500, 32000, 3000, 5000, 800, 2500, 20000, 3)});
  }
  compareOverlapped(simulation, native, session);
  EXPECT_GT(said, 0);
}

TEST_P(GlCraters, CratersOverTheBorderAndSoilThatMovesAfterwards) {
  ScenePack pack = craterPack(100, 90, 9);
  pack.parameters.materials[0].slope_threshold_q = 300;
  pack.parameters.materials[0].diagonal_threshold_q = 424;
  const World world(std::move(pack));
  Parameters all = world.pack.parameters;
  all.active_areas = 0;
  Session session;
  session.changes = {{0, all}, {1, world.pack.parameters}};
  session.poses.resize(12);
  session.craters.resize(12);
  session.craters[1] = {craterOf(-9000, 20000, 9000, 20000, 4000, 9000, 30000, 4),
                        craterOf(99999, 89999, 4000, 20000, 4000, 9000, 30000, 5)};
  session.craters[3] = {craterOf(50000, 95000, 0, 15000, 6000, 3000), craterOf(50000, 95000, 0, 15000, 6000, 3000)};
  Simulation simulation = world.simulateOn(GetParam()), native = world.simulate();
  ASSERT_NO_FATAL_FAILURE(compareSession(simulation, native, session));
  EXPECT_NE(simulation.state().ledger.craters, 0);
}

TEST_P(GlCraters, RoomEndsAtTheHeightLimitWhereACraterLiftsTheGround) {
  constexpr int kSoil = (1 << 28) - 1, kHighest = (1 << 29) + kSoil;
  for (const int threshold : {0, 500}) {
    SCOPED_TRACE(threshold);
    std::vector<std::int32_t> ground;
    for (int i = 0; i < 64 * 64; ++i) ground.push_back(kHighest - i * 7919 % 1000);
    ScenePack pack = groundPack(64, 64, ground, kSoil);
    pack.parameters.materials[0].slope_threshold_q = pack.parameters.materials[0].diagonal_threshold_q = 1;
    pack.parameters.obstacle_threshold_q = threshold;
    pack.crater_limits.radius_q = 100000;
    const World world(std::move(pack));
    Parameters all = world.pack.parameters;
    all.active_areas = 0;
    Session session;
    session.changes = {{0, all}};
    session.poses.resize(4);
    session.craters.resize(4);
    // A rim of 100 m and noise; hundreds of them would lift no higher.
    session.craters[1] = {craterOf(32000, 32000, 9000, 9000, rules::kCraterHeightLimit, 100, 65535, 9)};
    session.craters[2] = {craterOf(20000, 40000, 9000, 20000, rules::kCraterHeightLimit, 0, 65535, 10)};
    Simulation simulation = world.simulateOn(GetParam()), native = world.simulate();
    ASSERT_NO_FATAL_FAILURE(compareSession(simulation, native, session));
  }
}

TEST_P(GlCraters, SumsOfATileMayBeLargerThan32Bits) {
  ScenePack pack = stillPack(70, 66, 5);
  pack.soil_depth_q = (1 << 28) - 1;
  pack.noise.lowest_q = pack.noise.highest_q = 1 - (1 << 28);
  pack.crater_limits.radius_q = 1 << 20;
  pack.crater_limits.hash_cell_q = 1 << 20;
  const Crater deep = craterOf(35000, 33000, 1 << 18, 1 << 19, 0, rules::kCraterHeightLimit);
  const Crater high = craterOf(-400000, -500000, 1 << 18, 1 << 19, rules::kCraterHeightLimit, 0);
  const World world(std::move(pack));
  ASSERT_NO_FATAL_FAILURE(compareCells(GetParam(), world, {{deep}, std::vector<Crater>(100, deep), {high}}));
}

TEST_P(GlCraters, ASessionGoesFromNativeToGlAndBack) {
  ScenePack pack = craterPack(170, 140, 31);
  pack.parameters.materials[0].compression_q16 = kOneQ16 / 5;
  addBody(pack, boxMesh(9000, 12000, 5000), 50000, 60000, 800);
  const World world(std::move(pack));
  const Session session = wander(world, 6, 12, 4);
  Simulation reference = world.simulate();
  auto simulation = std::make_unique<Simulation>(world.simulate());
  for (std::size_t i = 0; i < session.poses.size(); ++i) {
    if (i % 4 == 0) {
      auto state = decodeSnapshot(encodeSnapshot(simulation->state(), world.base), world.id, world.base);
      ASSERT_TRUE(state) << state.error();
      const bool gl = i / 4 % 2 == 0;
      simulation.reset();
      simulation = std::make_unique<Simulation>(
          world.base, std::move(*state), gl ? borrowBackend(GetParam()) : makeNativeBackend({.thread_count = 1}));
    }
    const auto expected = reference.step(session.poses[i], {}, session.craters[i]);
    ASSERT_NO_FATAL_FAILURE(compareResults(simulation->step(session.poses[i], {}, session.craters[i]), expected));
  }
}

TEST_P(GlCraters, ABackendThatForgetsKnowsNoneOfTheCratersBefore) {
  const World world(stillPack(130, 70, 33));
  const auto compareOne = [&](const std::vector<Crater>& craters) {
    Simulation simulation = world.simulateOn(GetParam()), native = world.simulate();
    const Session session{{{}, {}}, {{}, craters}, {}};
    ASSERT_NO_FATAL_FAILURE(compareSession(simulation, native, session));
    EXPECT_EQ(native.state().craters.table().generation, 1u) << "as that of the other session";
  };
  ASSERT_NO_FATAL_FAILURE(compareOne({craterOf(30000, 30000, 5000, 9000, 1000, 3000)}));
  const Crater other = craterOf(100000, 40000, 3000, 7000, 900, 4000);
  ASSERT_NO_FATAL_FAILURE(compareOne({other, other}));
}

TEST_P(GlCraters, AShaderThatDoesNotCompileFailsTheFirstTick) {
  namespace fs = std::filesystem;
  const fs::path copy = fs::path(::testing::TempDir()) / ("spoor-crater-shaders-" + GetParam().name);
  fs::remove_all(copy);
  fs::copy(shaderFolder(), copy, fs::copy_options::recursive);
  std::ofstream(copy / "sim" / "crater_settle.comp") << "#version 450 core\nvoid main() { nonsense }\n";
  ASSERT_EQ(setenv("SPOOR_SHADERS", copy.c_str(), 1), 0);
  const World world(stillPack(70, 70, 34));
  Simulation simulation(world.base, world.id, makeOwnBackend(glOptionsOf(GetParam())));
  const auto failed = simulation.step({}, {}, std::vector{craterOf(30000, 30000, 5000, 9000, 1000, 3000)});
  unsetenv("SPOOR_SHADERS");
  fs::remove_all(copy);
  ASSERT_FALSE(failed);
  EXPECT_NE(failed.error().find("crater_settle.comp:2"), std::string::npos) << failed.error();
  EXPECT_EQ(simulation.state().craters.size(), 0u);
}

TEST(GlCratersTables, SoilMeetsTheHeightLimitWhereACraterMayLiftTheGroundToIt) {
  const ScenePack pack = stillPack(64, 64, 35);
  TickPlan plan;
  plan.parameters.obstacle_threshold_q = 500;
  plan.active = {{0, 0}};
  const std::vector<int> slots = {0};
  const MeshTable meshes = makeMeshTable(pack);
  const std::vector<CellBox> cratered = {{3, 4, 9, 8}};
  const auto beneath = [&](std::int32_t highest, std::span<const CellBox> boxes) {
    return makeTickTables(pack, meshes, plan, slots, highest, {}, {{}, {}, boxes}).beneath;
  };
  constexpr std::int32_t kRaise = 3 * rules::kCraterHeightLimit;
  EXPECT_FALSE(beneath(rules::kHeightLimit - 501, {}));
  EXPECT_TRUE(beneath(rules::kHeightLimit - 501, cratered));
  EXPECT_TRUE(beneath(rules::kHeightLimit - 500 - kRaise, cratered));
  EXPECT_FALSE(beneath(rules::kHeightLimit - 501 - kRaise, cratered));
  EXPECT_FALSE(beneath(rules::kHeightLimit - 501, std::vector<CellBox>{{}}));
}

TEST_P(GlCraters, WhatIsFarFromLiveGroundCostsTheDeviceNothing) {
  ScenePack pack = craterPack(2000, 200, 32);
  addBody(pack, boxMesh(9000, 12000, 5000), 50000, 60000, 800);
  const World world(std::move(pack));
  const std::vector<Pose> poses = initialPoses(world);
  Simulation simulation = world.simulateOn(GetParam()), other = world.simulateOn(GetParam());
  ASSERT_TRUE(simulation.step(poses));
  ASSERT_TRUE(other.step(poses));
  const std::vector<Crater> far = {craterOf(1900000, 100000, 5000, 9000, 1000, 3000)};
  const auto with = simulation.step(poses, {}, far), without = other.step(poses);
  ASSERT_TRUE(with && without);
  EXPECT_EQ(with->effect.bytes_to_device, without->effect.bytes_to_device);
  EXPECT_EQ(with->effect.bytes_from_device, without->effect.bytes_from_device);
  EXPECT_EQ(with->effect.dispatches, without->effect.dispatches);
  const std::vector<Crater> near = {craterOf(50000, 60000, 5000, 9000, 1000, 3000)};
  const auto changed = simulation.step(poses, {}, near);
  ASSERT_TRUE(changed);
  EXPECT_GE(changed->effect.bytes_to_device, without->effect.bytes_to_device + 2 * 64);
  EXPECT_GT(changed->effect.stage_ms[int(Stage::craters)], 0);
}

INSTANTIATE_TEST_SUITE_P(On, GlCraters, ::testing::ValuesIn(glCases()), caseName);

}  // namespace
}  // namespace spoor::test
