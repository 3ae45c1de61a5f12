// Snowfall: its closed form, tiles that take it beat by beat, and what it wakes.
#include "shared/world/snowfall.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "shared/world/tile_snow.h"
#include "tests/scenes.h"

namespace spoor::test {
namespace {

constexpr std::int64_t kUnit = std::int64_t(1) << 32;  // a unit of 0.1 mm a tick
constexpr int kSize = rules::kTileSize;

Snowfall falling(const ScenePack& pack, std::int64_t rate_q32, std::int32_t first_tick = 1,
                 std::int32_t last_tick = 1000) {
  return {{0, 0, pack.width_cells, pack.height_cells}, rate_q32, first_tick, last_tick, 77};
}

std::vector<std::int32_t> snowOf(const ScenePack& pack, std::span<const Snowfall> snowfalls, std::int32_t tick) {
  std::vector<std::int32_t> depth(std::size_t(pack.width_cells) * std::size_t(pack.height_cells));
  fillSnow(pack, snowfalls, tick, 0, 0, 1, pack.width_cells, pack.height_cells, depth);
  return depth;
}

TEST(Snowfall, EveryCellLiesWithinAUnitOfTheMeanAndTheSumGrowsEvenly) {
  const ScenePack pack = flatPack(64, 64);
  for (const std::int64_t rate : {kUnit / 100, kUnit / 3, kUnit, 7 * kUnit / 5, 1000 * kUnit}) {
    const Snowfall snowfall = falling(pack, rate);
    std::vector<std::int32_t> before(64 * 64, 0);
    for (std::int32_t tick = 16; tick <= 1008; tick += 16) {  // the beats of tile (0, 0)
      const auto depth = snowOf(pack, {&snowfall, 1}, tick);
      const double mean = double(std::min(tick, 1000)) * double(rate) / double(kUnit);
      for (std::size_t i = 0; i < depth.size(); ++i) {
        ASSERT_GE(depth[i], before[i]) << "nothing is taken back";
        ASSERT_LT(std::abs(depth[i] - mean), 1.0) << "tick " << tick;
      }
      const double sum = std::accumulate(depth.begin(), depth.end(), 0.0);
      ASSERT_NEAR(sum / 4096, mean, 5 * 0.5 / 64) << "five times what chance spreads a mean of 4096 cells by";
      before = depth;
    }
  }
}

TEST(Snowfall, OneLayerIsCompleteBeforeTheNextBegins) {
  const ScenePack pack = flatPack(64, 64);
  const Snowfall snowfall = falling(pack, kUnit / 16);
  for (const std::int32_t tick : {16, 160, 992}) {
    const auto depth = snowOf(pack, {&snowfall, 1}, tick);
    EXPECT_EQ(std::ranges::min(depth), tick / 16);
    EXPECT_EQ(std::ranges::max(depth), tick / 16) << "a whole number of layers is level";
  }
}

TEST(Snowfall, ItFallsInItsTicksOnly) {
  const ScenePack pack = flatPack(64, 64);
  const Snowfall snowfall = falling(pack, kUnit, 20, 40);
  EXPECT_EQ(std::ranges::max(snowOf(pack, {&snowfall, 1}, 16)), 0);
  EXPECT_EQ(std::ranges::max(snowOf(pack, {&snowfall, 1}, 31)), 0) << "the tile takes it at its beat";
  EXPECT_EQ(std::ranges::min(snowOf(pack, {&snowfall, 1}, 32)), 13);
  EXPECT_EQ(std::ranges::min(snowOf(pack, {&snowfall, 1}, 47)), 13);
  EXPECT_EQ(std::ranges::max(snowOf(pack, {&snowfall, 1}, 48)), 21);
  EXPECT_EQ(std::ranges::max(snowOf(pack, {&snowfall, 1}, 1 << 29)), 21) << "no more after its last tick";
}

TEST(Snowfall, ItFallsWithinItsAreaOnlyAndSeveralAddUp) {
  const ScenePack pack = flatPack(130, 70);
  const Snowfall snowfalls[] = {{{10, 20, 65, 66}, 3 * kUnit, 1, 100, 1}, {{60, 0, 130, 30}, 5 * kUnit, 1, 100, 2}};
  const auto depth = snowOf(pack, snowfalls, 200);
  for (int y = 0; y < 70; ++y)
    for (int x = 0; x < 130; ++x) {
      const bool in_first = x >= 10 && x < 65 && y >= 20 && y < 66, in_second = x >= 60 && y < 30;
      ASSERT_EQ(depth[std::size_t(y * 130 + x)], (in_first ? 300 : 0) + (in_second ? 500 : 0)) << x << ", " << y;
    }
}

TEST(Snowfall, AViewFromAfarSeesTheSameCells) {
  const ScenePack pack = flatPack(300, 200);
  const Snowfall snowfalls[] = {{{10, 20, 265, 166}, 3 * kUnit / 7, 1, 100, 1},
                                {{60, 0, 300, 30}, kUnit / 5, 3, 90, 2}};
  const auto all = snowOf(pack, snowfalls, 77);
  std::vector<std::int32_t> some(40 * 30);
  fillSnow(pack, snowfalls, 77, -21, -14, 9, 40, 30, some);
  for (int row = 0; row < 30; ++row)
    for (int column = 0; column < 40; ++column) {
      const int x = -21 + 9 * column, y = -14 + 9 * row;
      const bool inside = x >= 0 && y >= 0 && x < 300 && y < 200;
      ASSERT_EQ(some[std::size_t(row * 40 + column)], inside ? all[std::size_t(y * 300 + x)] : 0) << x << ", " << y;
    }
}

TEST(Snowfall, ATileThatTakesItBeatByBeatEqualsOneMadeLate) {
  ScenePack pack = noisePack(200, 150, 3, -900, 900, 500);
  const Snowfall snowfalls[] = {{{0, 0, 200, 150}, 3 * kUnit / 7, 1, 95, 1},
                                {{40, 30, 130, 100}, 20 * kUnit, 30, 61, 2}};
  const BaseTerrain base(pack);
  for (const TileCoordinate at : {TileCoordinate{0, 0}, {1, 1}, {3, 2}}) {
    const auto kept = makeTile(at, {&base, nullptr, snowfalls, 0}, 0);
    EXPECT_EQ(kept->first_snow, 0);
    std::int64_t gained = 0;
    int beats = 0;
    for (std::int32_t tick = 1; tick <= 130; ++tick) {
      if (snowDue(at, snowfalls, tick)) {
        gained += addSnow(pack, at, snowfalls, tick, kept->height());
        ++beats;
      }
      const auto fresh = makeTile(at, {&base, nullptr, snowfalls, tick}, tick);
      ASSERT_EQ(kept->height(), fresh->height()) << "tick " << tick;
      ASSERT_EQ(gained, fresh->first_snow) << "tick " << tick;
      ASSERT_EQ(fresh->ground, fresh->initial + gained);
    }
    EXPECT_TRUE(beats == 6 || beats == 7) << beats << ": none once all has fallen";
  }
}

TEST(Snowfall, ATileTakesItEvery16thTickAndNeighboursInTurn) {
  const ScenePack pack = flatPack(640, 640);
  const Snowfall snowfall = falling(pack, kUnit);
  for (const TileCoordinate at : {TileCoordinate{0, 0}, {5, 0}, {0, 3}, {9, 9}}) {
    std::vector<std::int32_t> beats;
    for (std::int32_t tick = 1; tick <= 64; ++tick) {
      const bool due = snowDue(at, {&snowfall, 1}, tick);
      ASSERT_EQ(due, snowBeat(at, tick) == tick);
      if (due) beats.push_back(tick);
    }
    ASSERT_EQ(beats.size(), 4u);
    for (std::size_t i = 1; i < 4; ++i) EXPECT_EQ(beats[i] - beats[i - 1], rules::kSnowBeat);
  }
  int due = 0;
  for (int y = 0; y < 10; ++y)
    for (int x = 0; x < 10; ++x) due += snowDue({x, y}, {&snowfall, 1}, 33) ? 1 : 0;
  EXPECT_NEAR(due, 100 / 16, 2) << "a tick visits few of the tiles";
}

TEST(Snowfall, WhatCannotBeIsRefused) {
  const ScenePack pack = flatPack(100, 80);
  const Snowfall good{{0, 0, 100, 80}, kUnit, 1, 10, 0};
  EXPECT_TRUE(validateSnowfall(pack, good));
  const auto errorOf = [&](auto change) {
    Snowfall bad = good;
    change(bad);
    const Status status = validateSnowfall(pack, bad);
    return status ? std::string() : status.error();
  };
  const auto begins = [](const std::string& text, const char* with) { return text.rfind(with, 0) == 0; };
  EXPECT_TRUE(begins(errorOf([](Snowfall& s) { s.area.x0 = -1; }), "area: "));
  EXPECT_TRUE(begins(errorOf([](Snowfall& s) { s.area.x1 = 101; }), "area: "));
  EXPECT_TRUE(begins(errorOf([](Snowfall& s) { s.area.y1 = 81; }), "area: "));
  EXPECT_TRUE(begins(errorOf([](Snowfall& s) { s.area.y0 = 80; }), "area: ")) << "empty";
  EXPECT_TRUE(begins(errorOf([](Snowfall& s) { s.rate_q32 = 0; }), "rate: "));
  EXPECT_TRUE(begins(errorOf([](Snowfall& s) { s.rate_q32 = kSnowRateLimit + 1; }), "rate: "));
  EXPECT_TRUE(begins(errorOf([](Snowfall& s) { s.rate_q32 = INT64_MIN; }), "rate: "));
  EXPECT_TRUE(begins(errorOf([](Snowfall& s) { s.first_tick = 0; }), "ticks: "));
  EXPECT_TRUE(begins(errorOf([](Snowfall& s) { s.first_tick = 11; }), "ticks: "));
  EXPECT_TRUE(begins(errorOf([](Snowfall& s) { s.last_tick = INT32_MAX; }), "ticks: "));
  EXPECT_TRUE(begins(errorOf([](Snowfall& s) { s.rate_q32 = kSnowRateLimit, s.last_tick = 2049; }), "rate: too much"));
  EXPECT_EQ(errorOf([](Snowfall& s) { s.rate_q32 = kSnowRateLimit, s.last_tick = 2048; }), "") << "as deep as may be";
  EXPECT_EQ(errorOf([](Snowfall& s) { s.rate_q32 = 1, s.last_tick = 1 << 30; }), "");
}

TEST(Snowfall, NewOnesMayNotBeginEarlierOrBeTooMany) {
  const ScenePack pack = flatPack(100, 80);
  std::vector<Snowfall> snowfalls(3, falling(pack, kUnit, 7));
  EXPECT_TRUE(validateNewSnowfalls(pack, snowfalls, 7, kSnowfallsLimit - 3));
  EXPECT_NE(validateNewSnowfalls(pack, snowfalls, 7, kSnowfallsLimit - 2).error().find("65 snowfalls"),
            std::string::npos);
  EXPECT_NE(validateNewSnowfalls(pack, snowfalls, 8, 0).error().find("snowfall 0: ticks: it begins at 7"),
            std::string::npos);
  snowfalls[2].rate_q32 = 0;
  EXPECT_NE(validateNewSnowfalls(pack, snowfalls, 7, 5).error().find("snowfall 7: rate: "), std::string::npos);
}

TEST(Snowfall, NothingRisesAboveTheHeightLimit) {
  ScenePack pack = flatPack(64, 64);
  const Snowfall snowfalls[] = {falling(pack, kSnowRateLimit, 1, 2048)};
  PlaneCells height;
  height.fill(rules::kHeightLimit - 100);
  height[0] = 0;
  const std::int64_t gained = addSnow(pack, {0, 0}, snowfalls, 16, height);
  EXPECT_EQ(height[1], rules::kHeightLimit);
  EXPECT_EQ(height[0], 16 * 4096);
  EXPECT_EQ(gained, 16 * 4096 + 100 * 4095);
}

/// A world whose tiles are all live and asleep.
struct AsleepWorld {
  explicit AsleepWorld(ScenePack pack) : world(std::move(pack)), state(initialState(world.id, world.base)) {
    const TileCoordinate extent = tileExtent(world.pack);
    for (int y = 0; y < extent.y; ++y)
      for (int x = 0; x < extent.x; ++x) {
        const Tile& tile = state.tiles.insert(makeTile({x, y}, dormantGround(state, world.base), 0));
        state.tiles_hash += tileStateHash(tile);
        state.ledger.initial += tile.initial;
        state.ledger.ground += tile.ground;
      }
  }
  /// What the snow of the ticks up to one wakes: tiles, and when.
  std::vector<std::pair<std::int32_t, TileCoordinate>> wokenUntil(std::int32_t last_tick) {
    std::vector<std::pair<std::int32_t, TileCoordinate>> woken;
    for (std::int32_t tick = 1; tick <= last_tick; ++tick) {
      SnowOfTick snow(state, world.pack, tick, SnowTiles::asleep);
      for (const Tile* tile : snow.tiles())
        if (tile->wake_mask != 0) woken.push_back({tick, tile->at});
      for (Tile* tile : state.tiles.sorted()) {  // as if a tick had found that they rest
        state.tiles_hash -= tileStateHash(*tile);
        state.tiles.setWake(*tile, 0);
        state.tiles_hash += tileStateHash(*tile);
      }
      state.tick = tick;
    }
    EXPECT_TRUE(recount(state));
    return woken;
  }
  World world;
  WorldState state;
};

TEST(SnowOfTick, OnLevelGroundItWakesNothing) {
  ScenePack pack = flatPack(200, 150);  // neither side a whole number of tiles: the world's border wakes nothing either
  pack.snowfalls = {falling(pack, kUnit)};
  AsleepWorld asleep(std::move(pack));
  EXPECT_TRUE(asleep.wokenUntil(64).empty());
  EXPECT_GT(asleep.state.ledger.events, 200 * 150 * 48) << "each has had that of 49 ticks at least";
}

TEST(SnowOfTick, ItWakesTheTileThatIsTooSteepAndNoOther) {
  for (const SlopeRule rule : {SlopeRule::exchange, SlopeRule::flux, SlopeRule::interleaved, SlopeRule::drift}) {
    ScenePack pack = flatPack(256, 192);
    pack.parameters.slopes = rule;
    // Over tile (1, 1) alone there falls a little onto a field that ends in its middle: too steep after some ticks.
    pack.snowfalls = {{{64, 64, 96, 128}, 10 * kUnit, 1, 1000, 5}};
    AsleepWorld asleep(std::move(pack));
    const auto woken = asleep.wokenUntil(200);
    ASSERT_FALSE(woken.empty());
    for (const auto& [tick, at] : woken) EXPECT_EQ(at, (TileCoordinate{1, 1}));
    // A step of 700 rests; it is 10 a tick high, seen at the beats of tile (1, 1).
    std::int32_t first = 0;
    while (!(first > 70 && snowBeat({1, 1}, first) == first)) ++first;
    EXPECT_EQ(woken.front().first, first);
  }
}

TEST(SnowOfTick, SteepTowardsANeighbourWakesBoth) {
  ScenePack pack = flatPack(192, 64);
  pack.snowfalls = {{{64, 0, 128, 64}, 10 * kUnit, 1, 1000, 5}};
  AsleepWorld asleep(std::move(pack));
  WakeMask mask = 0;
  for (std::int32_t tick = 1; tick <= 200 && mask == 0; ++tick) {
    SnowOfTick snow(asleep.state, asleep.world.pack, tick, SnowTiles::asleep);
    mask = asleep.state.tiles.find({1, 0})->wake_mask;
    asleep.state.tick = tick;
  }
  EXPECT_EQ(mask, WakeMask(1 << 3 | 1 << 4 | 1 << 5)) << "it and those to the west and east";
}

TEST(SnowOfTick, ASteeperMaterialMayHoldIt) {
  ScenePack pack = flatPack(64, 64);
  pack.materials.push_back({"rock", {}, {}, 0, 0});
  pack.parameters.materials.push_back(pack.parameters.materials[0]);
  pack.parameters.materials[1].slope_threshold_q = pack.parameters.materials[1].diagonal_threshold_q = kNeverSteep;
  pack.material_map.kind = MaterialMapKind::image;
  pack.material_map.image = {2, 1, kUnit / 32, kUnit / 64, {1, 0}};  // the west is rock
  pack.snowfalls = {{{0, 0, 32, 64}, 10 * kUnit, 1, 1000, 5}};       // the higher ones are of rock
  EXPECT_TRUE(AsleepWorld(pack).wokenUntil(200).empty());
  pack.snowfalls = {{{32, 0, 64, 64}, 10 * kUnit, 1, 1000, 5}};
  EXPECT_FALSE(AsleepWorld(pack).wokenUntil(200).empty());
}

TEST(SnowOfTick, TakenBackNothingHasHappened) {
  ScenePack pack = noisePack(200, 150, 5, -3000, 3000, 900);
  pack.snowfalls = {falling(pack, 50 * kUnit), falling(pack, kUnit / 3)};
  AsleepWorld asleep(std::move(pack));
  WorldState& state = asleep.state;
  std::size_t woken = 0;
  for (std::int32_t tick = 1; tick <= 40; ++tick) {
    const auto before = encodeSnapshot(state, asleep.world.base);
    const Ledger ledger = state.ledger;
    const std::uint64_t hash = stateHash(state);
    const std::size_t awake = state.tiles.awake().size();
    SnowOfTick snow(state, asleep.world.pack, tick, SnowTiles::all);
    woken += state.tiles.awake().size() - awake;
    if (!snow.tiles().empty()) {
      EXPECT_NE(stateHash(state), hash);
    }
    EXPECT_EQ(state.ledger.error(), 0);
    snow.takeBack(state);
    ASSERT_EQ(stateHash(state), hash);
    ASSERT_EQ(state.ledger, ledger);
    ASSERT_EQ(state.tiles.awake().size(), awake);
    ASSERT_EQ(encodeSnapshot(state, asleep.world.base), before);
    ASSERT_TRUE(recount(state));
    SnowOfTick again(state, asleep.world.pack, tick, SnowTiles::all);
    state.tick = tick;
  }
  EXPECT_GT(woken, 5u);
}

}  // namespace
}  // namespace spoor::test
