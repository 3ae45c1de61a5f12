// Snowfall in whole sessions: those who follow, what the ledger says of it, and what it costs.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <random>

#include "shared/world/tile_snow.h"
#include "tests/scenes.h"

namespace spoor::test {
namespace {

constexpr std::int64_t kUnit = std::int64_t(1) << 32;

Snowfall everywhere(const ScenePack& pack, std::int64_t rate_q32, std::int32_t first_tick = 1,
                    std::int32_t last_tick = 100000) {
  return {{0, 0, pack.width_cells, pack.height_cells}, rate_q32, first_tick, last_tick, 9};
}

TEST(SnowSession, WhoeverFollowsHoldsTheServersState) {
  for (std::uint32_t seed = 2000; seed < 2040; ++seed) {
    const RandomWorld random = randomWorld(seed, 40);
    SCOPED_TRACE(random.description);
    const World world(random.pack);
    Simulation server = world.simulate();
    WorldState view = initialState(world.id, world.base);
    for (std::size_t i = 0; i < random.ticks.size(); ++i) {
      const auto result = server.step(random.ticks[i], random.changeAt(i), random.cratersAt(i), random.snowfallsAt(i));
      ASSERT_TRUE(result) << result.error();
      const Status status = applyTick(view, world.base, result->update);
      ASSERT_TRUE(status) << status.error();
      ASSERT_EQ(stateHash(view), stateHash(server.state()));
      ASSERT_EQ(view.ledger, server.state().ledger);
    }
    ASSERT_TRUE(recount(view));
    // Whoever joins late, too.
    const auto bytes = encodeSnapshot(server.state(), world.base);
    const auto joined = decodeSnapshot(bytes, world.id, world.base);
    ASSERT_TRUE(joined) << joined.error();
    ASSERT_EQ(stateHash(*joined), stateHash(view));
    ASSERT_EQ(joined->ledger, view.ledger);
    ASSERT_EQ(encodeSnapshot(*joined, world.base), bytes);
  }
}

/// A body that ploughs through ground on which it snows.
ScenePack ploughPack() {
  ScenePack pack = noisePack(150, 130, 4, -2000, 2000, 5000);
  addBody(pack, boxMesh(9000, 6000, 4000), 20000, 60000, 900);
  pack.snowfalls = {everywhere(pack, 30 * kUnit)};
  return pack;
}

TEST(SnowSession, ABadTickLeavesTheStateUntouched) {
  const World world(ploughPack());
  Simulation server = world.simulate();
  WorldState view = initialState(world.id, world.base);
  int refused = 0;
  for (int tick = 1; tick <= 40; ++tick) {
    const std::vector<Snowfall> coming =
        tick % 7 == 0 ? std::vector{everywhere(world.pack, kUnit, tick)} : std::vector<Snowfall>();
    const auto result = server.step(std::vector{moved(server.state().poses[0], 700, 0)}, {}, {}, coming);
    ASSERT_TRUE(result) << result.error();
    ASSERT_FALSE(result->effect.changes.empty());
    const auto before = encodeSnapshot(view, world.base);
    const std::uint64_t hash = stateHash(view);
    TickUpdate bad = result->update;
    auto changes = result->effect.changes;
    changes.back().hash ^= 1;
    bad.tiles = encodeTiles(changes);
    ASSERT_FALSE(applyTick(view, world.base, bad));
    ASSERT_EQ(stateHash(view), hash);
    ASSERT_EQ(encodeSnapshot(view, world.base), before);
    ASSERT_TRUE(recount(view));
    bad = result->update;
    bad.snowfalls.push_back(everywhere(world.pack, kUnit, tick - 1));
    const Status status = applyTick(view, world.base, bad);
    ASSERT_FALSE(status);
    refused += status.error().find("snowfall ") != std::string::npos ? 1 : 0;
    ASSERT_EQ(encodeSnapshot(view, world.base), before);
    const Status good = applyTick(view, world.base, result->update);
    ASSERT_TRUE(good) << good.error();
    ASSERT_EQ(stateHash(view), stateHash(server.state()));
  }
  EXPECT_EQ(refused, 40);
}

TEST(SnowSession, RefusedInputLeavesTheSimulationUntouched) {
  const World world(ploughPack());
  Simulation simulation = world.simulate();
  for (int tick = 0; tick < 20; ++tick)
    ASSERT_TRUE(simulation.step(std::vector{moved(simulation.state().poses[0], 700, 0)}));
  const std::vector<Pose> poses = simulation.state().poses;
  const auto before = encodeSnapshot(simulation.state(), world.base);
  for (int tick = 0; tick < 16; ++tick) {
    const Snowfall late = everywhere(world.pack, kUnit, simulation.state().tick);
    EXPECT_FALSE(simulation.step(poses, {}, {}, {&late, 1}));
    const std::vector<Snowfall> many(kSnowfallsLimit, everywhere(world.pack, kUnit, 1000));
    EXPECT_FALSE(simulation.step(poses, {}, {}, many));
    if (tick == 0) {
      EXPECT_EQ(encodeSnapshot(simulation.state(), world.base), before);
    }
    ASSERT_TRUE(simulation.step(poses));
    EXPECT_TRUE(recount(simulation.state()));
  }
}

TEST(SnowSession, ATickThatCannotBePlannedTakesItsSnowBack) {
  ScenePack pack = flatPack(20000, 100);
  pack.cell_q = 100;
  for (int i = 0; i < 5; ++i) {  // they touch, and together are too long to be searched, unless they are small
    addBody(pack, boxMesh(400000, 2000, 2000), 200000 + i * 400000, 5000, 0);
    pack.bodies.back().first_scale_q16 = pack.bodies.back().last_scale_q16 = kFullScale / 100;
  }
  pack.snowfalls = {everywhere(pack, 30 * kUnit)};
  const World world(std::move(pack));
  Simulation simulation = world.simulate();
  const std::vector<Pose> small = simulation.state().poses;
  std::vector<Pose> large = small;
  for (Pose& pose : large) pose.scale_q16 = kFullScale;
  std::int64_t snowed = 0;
  for (int tick = 1; tick <= 32; ++tick) {
    const auto before = encodeSnapshot(simulation.state(), world.base);
    const Snowfall snowfall = everywhere(world.pack, kUnit, tick);
    ASSERT_FALSE(simulation.step(large, {}, {}, {&snowfall, 1}));
    ASSERT_EQ(encodeSnapshot(simulation.state(), world.base), before);
    const auto result = simulation.step(small);
    ASSERT_TRUE(result) << result.error();
    snowed += result->effect.active_cells == 0 ? 1 : 0;
  }
  EXPECT_GT(snowed, 16) << "tiles are asleep when the snow falls on them";
  EXPECT_TRUE(recount(simulation.state()));
  EXPECT_GT(simulation.state().ledger.events, 0);
}

TEST(SnowSession, TilesThatWaitTakeTheirSnowAllTheSame) {
  ScenePack pack = noisePack(64 * 9, 64 * 7, 6, -30000, 30000, 20000);
  pack.parameters.materials[0].slope_threshold_q = pack.parameters.materials[0].diagonal_threshold_q = 30;
  pack.parameters.sweeps_per_tick = 64;
  pack.snowfalls = {everywhere(pack, 5 * kUnit, 1, 90)};
  addBody(pack, boxMesh(200, 200, 200), 280500, 200500, 10);  // its prick sets a landslide off
  const World world(std::move(pack));
  constexpr std::size_t kTiles = 7;
  Simulation server(world.base, initialState(world.id, world.base), makeNativeBackend({.thread_count = 2}), kTiles);
  WorldState view = initialState(world.id, world.base);
  const std::vector<Pose> poses = view.poses;
  std::size_t waited = 0;
  for (int tick = 1; tick <= 100; ++tick) {
    const auto result = server.step(poses);
    ASSERT_TRUE(result) << result.error();
    for (const Tile* tile : tilesInSnow(view, tick, SnowTiles::awake)) {
      const bool is_active = std::ranges::count(result->effect.changes, tile->at, &TileChange::at) > 0;
      waited += is_active ? 0 : 1;  // an awake tile that is active changes, if only its wake mask
    }
    ASSERT_EQ(result->ledger.error(), 0);
    const Status status = applyTick(view, world.base, result->update);
    ASSERT_TRUE(status) << status.error();
    ASSERT_EQ(view.ledger, server.state().ledger) << "tick " << tick;
    ASSERT_TRUE(recount(view));
  }
  EXPECT_GT(waited, 20u);
  ASSERT_TRUE(recount(server.state()));
}

TEST(SnowSession, ItCostsNothingWhereNothingIsLiveInAWorldOf16MillionCellsASide) {
  ScenePack pack = flatPack(1 << 24, 1 << 13);
  pack.cell_q = 100;
  pack.snowfalls = {everywhere(pack, kUnit / 3), everywhere(pack, 7 * kUnit)};
  const World world(std::move(pack));
  Simulation simulation = world.simulate();
  for (int tick = 1; tick <= 1000; ++tick) {
    const auto result = simulation.step({});
    ASSERT_TRUE(result) << result.error();
    ASSERT_EQ(result->effect.active_cells, 0);
    ASSERT_TRUE(result->effect.changes.empty());
    ASSERT_EQ(simulation.state().tiles.size(), 0u);
  }
  const std::int32_t height = dormantGround(simulation.state(), world.base).height((1 << 24) - 5, 77);
  EXPECT_NEAR(height, 984 * 22 / 3, 16 * 22 / 3 + 2);
}

TEST(SnowSession, OfTilesAtRestOneIn16IsVisitedAndNothingIsSent) {
  ScenePack pack = flatPack(512, 512);
  addBody(pack, boxMesh(400000, 400000, 4000), 256000, 256000, 0);
  const World world(std::move(pack));
  Simulation simulation = world.simulate();
  for (int tick = 0; tick < 3; ++tick) ASSERT_TRUE(simulation.step(simulation.state().poses));
  ASSERT_GT(simulation.state().tiles.size(), 30u);
  const Snowfall snowfall = everywhere(world.pack, 3 * kUnit / 2, simulation.state().tick + 1);
  std::int64_t events = 0;
  int grown = 0;
  for (int tick = 0; tick < 32; ++tick) {
    const auto result = simulation.step(simulation.state().poses, {}, {},
                                        tick == 0 ? std::span(&snowfall, 1) : std::span<const Snowfall>());
    ASSERT_TRUE(result) << result.error();
    EXPECT_EQ(result->effect.active_cells, 0);
    EXPECT_TRUE(result->effect.changes.empty());
    EXPECT_EQ(result->ledger.error(), 0);
    grown += result->ledger.events > std::exchange(events, result->ledger.events) ? 1 : 0;
  }
  EXPECT_GE(grown, 30) << "some take it in every tick";
}

/// Height of a rut that a box leaves, against the ground beside it.
int rutDepth(const WorldState& state) { return heightOf(state, 30, 5) - heightOf(state, 30, 32); }

TEST(SnowSession, ATrailIsSnowedIn) {
  ScenePack pack = flatPack(64, 64);
  pack.parameters.sweeps_per_tick = 2;
  addBody(pack, boxMesh(6000, 20000, 4000), 30000, 32000, 1500);
  const World world(std::move(pack));
  Simulation simulation = world.simulate();
  ASSERT_TRUE(simulation.step(simulation.state().poses));
  ASSERT_TRUE(simulation.step(std::vector{moved(simulation.state().poses[0], 0, 0, 1 << 28)}));
  for (int tick = 0; tick < 60; ++tick) ASSERT_TRUE(simulation.step(simulation.state().poses));
  const int before = rutDepth(simulation.state());
  ASSERT_GT(before, 500);
  // It falls into the rut, so to say: drift takes what lies steep down into it, and slopes of 700 become 100.
  Parameters gentle = world.pack.parameters;
  gentle.materials[0].slope_threshold_q = 50;
  gentle.materials[0].diagonal_threshold_q = 70;
  const std::uint64_t at_rest = simulation.state().tiles_hash;
  ASSERT_TRUE(simulation.step(simulation.state().poses, gentle));
  EXPECT_EQ(simulation.state().tiles_hash, at_rest) << "new parameters wake nothing by themselves";
  const Snowfall snowfall = everywhere(world.pack, 2 * kUnit, simulation.state().tick + 1);
  ASSERT_TRUE(simulation.step(simulation.state().poses, {}, {}, {&snowfall, 1}));
  int depth = before;
  for (int tick = 0; tick < 200; ++tick) {
    ASSERT_TRUE(simulation.step(simulation.state().poses));
    ASSERT_EQ(simulation.state().ledger.error(), 0);
  }
  depth = rutDepth(simulation.state());
  EXPECT_LT(depth, before / 2);
  EXPECT_GT(heightOf(simulation.state(), 5, 5), 300) << "and all has risen";
}

std::int32_t groundBeneath(const WorldState& state, const BaseTerrain& base, const Pose& pose) {
  const int x = pose.x_q / base.pack().cell_q, y = pose.y_q / base.pack().cell_q;
  const bool is_live = state.tiles.find({x / rules::kTileSize, y / rules::kTileSize}) != nullptr;
  return is_live ? heightOf(state, x, y) : dormantGround(state, base).height(x, y);
}

// 10^4 ticks; SPOOR_SOAK_TICKS says another number (./test --soak: 10^6).
TEST(SnowSoak, TheLedgerIsEvenAtEveryTickOfADriveThroughSnowOnNative) {
  const char* asked = std::getenv("SPOOR_SOAK_TICKS");
  const int tick_count = asked == nullptr ? 10000 : std::atoi(asked);
  ASSERT_GT(tick_count, 0);
  ScenePack pack = noisePack(70, 50, 14, -600, 600, 3000);
  addMaterials(pack, 3, 5);
  pack.parameters = randomParameters(1, 3);
  addBody(pack, boxMesh(5000, 3000, 3000), 20000, 20000, 500);
  pack.bodies[0].force_n = 20000;
  pack.snowfalls = {{{0, 0, 70, 50}, kUnit / 20, 1, 1 << 25, 1}, {{10, 10, 40, 50}, kUnit / 7, 100, 1 << 24, 2}};
  const World world(std::move(pack));
  Simulation simulation = world.simulate();
  std::mt19937 engine(16);
  const auto drawn = [&engine](int range) { return int(engine() % std::uint32_t(2 * range + 1)) - range; };
  std::int64_t events = 0;
  for (int tick = 1; tick <= tick_count; ++tick) {
    Pose pose = moved(simulation.state().poses[0], drawn(1500), drawn(1500), 0, drawn(500));
    pose.x_q = std::clamp(pose.x_q, 5000, 65000);
    pose.y_q = std::clamp(pose.y_q, 5000, 45000);
    // On the ground, which rises with the snow.
    pose.z_q = groundBeneath(simulation.state(), world.base, pose) - 200 + drawn(300);
    std::optional<Parameters> parameters;
    if (tick % 250 == 0) parameters = randomParameters(std::uint32_t(tick), 3);
    const auto result = simulation.step(std::vector{pose}, parameters);
    ASSERT_TRUE(result) << result.error();
    ASSERT_EQ(result->ledger.error(), 0) << "tick " << tick;
    if (tick % 1000 == 0) {
      ASSERT_TRUE(recount(simulation.state())) << "tick " << tick;
      ASSERT_GT(result->ledger.events, events) << "it goes on snowing";
      events = result->ledger.events;
    }
  }
}

}  // namespace
}  // namespace spoor::test
