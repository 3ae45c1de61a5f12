// Stage relax by the rules beside pair exchange: the thesis's average rule, in two passes or one, and flux.
#include <gtest/gtest.h>

#include <numeric>
#include <random>

#include "shaders/rules/slope.h"
#include "tests/stage_rig.h"

namespace spoor::test {
namespace {

constexpr int kNone = rules::kNoUnderside;
constexpr SlopeRule kRules[] = {SlopeRule::flux, SlopeRule::interleaved, SlopeRule::scatter};
constexpr SlopeRule kAllRules[] = {SlopeRule::exchange, SlopeRule::flux, SlopeRule::interleaved, SlopeRule::scatter,
                                   SlopeRule::drift};

class SlopeRules : public OnEveryBackend {};

std::int64_t sumOf(const Cells& cells) { return std::accumulate(cells.begin(), cells.end(), std::int64_t(0)); }

Parameters sloping(SlopeRule rule, int threshold, int diagonal_threshold, int roughness_q16) {
  Parameters parameters;
  parameters.slopes = rule;
  parameters.materials[0].roughness_q16 = roughness_q16;
  parameters.materials[0].slope_threshold_q = threshold;
  parameters.materials[0].diagonal_threshold_q = diagonal_threshold;
  return parameters;
}

/// What sweeps make of small ground.
Cells swept(const BackendCase& backend_case, int columns, const Cells& ground, int soil_depth,
            const Parameters& parameters, int sweep_count = 1, const Cells& underside = {}) {
  ScenePack pack = groundPack(columns, int(ground.size()) / columns, ground, soil_depth);
  pack.parameters = parameters;
  const World world(std::move(pack));
  const auto rig = makeStageRig(backend_case, world);
  if (!underside.empty()) rig->setUnderside(underside);
  rig->relax(0, sweep_count);
  return rig->height();
}

Cells columnOnFiveByFiveCells(int height) {
  Cells ground(25, 0);
  ground[12] = height;
  return ground;
}

TEST_P(SlopeRules, FluxMovesAnEighthOfEveryExcessAtOnce) {
  // Sides: 8000 - 100, halved, an eighth: 493. Diagonals: 8000 - 203, halved to 3898, an eighth: 487.
  EXPECT_EQ(swept(GetParam(), 5, columnOnFiveByFiveCells(8000), 100000, sloping(SlopeRule::flux, 100, 203, 32768)),
            (Cells{0,   0,   0,
                   0,   0,  //
                   0,   487, 493,
                   487, 0,  //
                   0,   493, 8000 - 4 * 493 - 4 * 487,
                   493, 0,  //
                   0,   487, 493,
                   487, 0,  //
                   0,   0,   0,
                   0,   0}));
}

TEST_P(SlopeRules, TheAverageRuleGivesEqualPartsOfTheMeanDrop) {
  for (const SlopeRule rule : {SlopeRule::interleaved, SlopeRule::scatter}) {
    // Mean drop 8005, halved to 4002, to each of eight 500. The diagonal threshold does not matter.
    EXPECT_EQ(swept(GetParam(), 5, columnOnFiveByFiveCells(8005), 100000, sloping(rule, 100, 9000, 32768)),
              (Cells{0, 0,   0,    0,   0,  //
                     0, 500, 500,  500, 0,  //
                     0, 500, 4005, 500, 0,  //
                     0, 500, 500,  500, 0,  //
                     0, 0,   0,    0,   0}));
    // In a row: cell 1 drops by 100 and 700, of which 700 is too steep, so that half of it goes to cell 2.
    EXPECT_EQ(swept(GetParam(), 4, {900, 1000, 300, 300}, 100000, sloping(rule, 100, 100, 32768)),
              (Cells{900, 650, 650, 300}));
  }
}

TEST_P(SlopeRules, NoMoreThanThereIsSoil) {
  const Cells ground = {0, 8000, 0};
  // Flux: an eighth of the 40 to either side. Average: all of the 40, in halves.
  EXPECT_EQ(swept(GetParam(), 3, ground, 40, sloping(SlopeRule::flux, 0, 0, 65536)), (Cells{5, 7990, 5}));
  for (const SlopeRule rule : {SlopeRule::interleaved, SlopeRule::scatter})
    EXPECT_EQ(swept(GetParam(), 3, ground, 40, sloping(rule, 0, 0, 65536)), (Cells{20, 7960, 20}));
}

TEST_P(SlopeRules, NoMoreThanAnEighthOfTheRoomBeneathABody) {
  const Cells ground = {0, 8000, 0}, underside = {95, kNone, 0};
  // Cell 0 has room for 95, cell 2 for nothing.
  EXPECT_EQ(swept(GetParam(), 3, ground, 100000, sloping(SlopeRule::flux, 0, 0, 65536), 1, underside),
            (Cells{11, 7989, 0}));
  for (const SlopeRule rule : {SlopeRule::interleaved, SlopeRule::scatter})
    EXPECT_EQ(swept(GetParam(), 3, ground, 100000, sloping(rule, 0, 0, 65536), 1, underside), (Cells{11, 7989, 0}));
  Parameters parameters = sloping(SlopeRule::scatter, 0, 0, 65536);
  parameters.obstacle_threshold_q = 95;
  EXPECT_EQ(swept(GetParam(), 3, ground, 100000, parameters, 1, underside), ground) << "a gap of the threshold is none";
}

TEST_P(SlopeRules, WithoutRoughnessOrSteepnessNothingMoves) {
  const Cells ground = columnOnFiveByFiveCells(1 << 20);
  for (const SlopeRule rule : kRules) {
    EXPECT_EQ(swept(GetParam(), 5, ground, 1 << 21, sloping(rule, 0, 0, 0), 3), ground);
    EXPECT_EQ(swept(GetParam(), 5, ground, 1 << 21, sloping(rule, kNeverSteep, kNeverSteep, 65536), 3), ground);
    EXPECT_NE(swept(GetParam(), 5, ground, 1 << 21, sloping(rule, 0, 0, 65536), 3), ground);
  }
}

/// Random heights, bedrock and undersides, parameters of a seed but for the rule.
void checkRandomWorld(const BackendCase& backend_case, SlopeRule rule, int columns, int rows, std::uint32_t seed) {
  std::mt19937 engine(seed);
  const auto relief = seed % 2 == 0 ? 4000u : 60000u;
  Cells ground;
  for (int i = 0; i < columns * rows; ++i) ground.push_back(int(engine() % relief));
  ScenePack pack = groundPack(columns, rows, ground, seed % 3 == 0 ? 500 : 100000);
  const int material_count = seed % 2 == 0 ? 4 : 1;
  pack.parameters = randomParameters(seed, material_count);
  pack.parameters.slopes = rule;
  if (material_count > 1) addMaterials(pack, material_count, seed);
  const int sweeps = 1 + int(seed % 9);
  SCOPED_TRACE("seed " + std::to_string(seed) + ", " + std::to_string(columns) + " x " + std::to_string(rows) + ", " +
               std::to_string(sweeps) + " sweeps, " + describe(pack.parameters));
  const World world(std::move(pack));
  const auto rig = makeStageRig(backend_case, world);
  coverAtRandom(*rig, seed);
  DenseWorld dense = denseCopy(*rig);
  rig->relax(0, sweeps);
  oracleRelax(dense, world.pack.parameters, sweeps);
  ASSERT_EQ(rig->height(), insideCells(dense, dense.height));
  ASSERT_EQ(sumOf(rig->height()), sumOf(ground));
}

TEST_P(SlopeRules, EqualTheOracleOnWorldsOfAnySizeAndKeepTheSum) {
  constexpr std::pair<int, int> sizes[] = {{77, 131}, {1, 200}, {65, 1}, {129, 66}};
  for (std::uint32_t seed = 0; seed < (GetParam().slow() ? 8u : 24u); ++seed)
    for (const SlopeRule rule : kAllRules) {
      const auto& [columns, rows] = sizes[seed % 4];
      ASSERT_NO_FATAL_FAILURE(checkRandomWorld(GetParam(), rule, columns, rows, seed));
    }
}

TEST_P(SlopeRules, SweepsInPartsEqualSweepsAtOnce) {
  for (const SlopeRule rule : kRules) {
    ScenePack pack = noisePack(150, 140, 5, -9000, 9000, 100000);
    pack.parameters = sloping(rule, 100, 141, 65536);
    const World world(std::move(pack));
    const auto at_once = makeStageRig(GetParam(), world), in_parts = makeStageRig(GetParam(), world);
    at_once->relax(0, 6);
    in_parts->relax(0, 1);
    in_parts->relax(1, 3);
    in_parts->relax(4, 2);
    EXPECT_EQ(at_once->height(), in_parts->height()) << int(rule);
  }
}

TEST_P(SlopeRules, SoilCrossesABorderOnlyBetweenActiveTiles) {
  for (const SlopeRule rule : kRules) {
    ScenePack pack = noisePack(64 * 3 + 9, 64 * 3 + 5, 6, -30000, 30000, 100000);
    pack.parameters = sloping(rule, 100, 141, 65536);
    const World world(std::move(pack));
    for (const std::uint32_t pattern : {0x5a5au, 0x9009u, 0x6ff6u}) {
      DenseWorld dense(world.base);
      std::vector<TileCoordinate> active;
      for (int i = 0; i < 16; ++i)
        if ((pattern >> i & 1) != 0) active.push_back({i % 4, i / 4});
      for (const TileCoordinate tile : active)
        for (int i = 0; i < rules::kTileCells; ++i)
          dense.active[dense.at(tile.x * 64 + i % 64, tile.y * 64 + i / 64)] = 1;
      const auto rig = makeStageRig(GetParam(), world, active);
      rig->relax(0, 3);
      oracleRelax(dense, world.pack.parameters, 3);
      const Cells heights = rig->tileHeights();
      std::size_t next = 0;
      for (const TileCoordinate tile : active)
        for (int i = 0; i < rules::kTileCells; ++i) {
          const int x = tile.x * 64 + i % 64, y = tile.y * 64 + i / 64;
          ASSERT_EQ(heights[next++], dense.height[dense.at(x, y)]) << x << ", " << y << " of " << pattern;
        }
    }
  }
}

SPOOR_ON_EVERY_BACKEND(SlopeRules);

/// A cell's numbers, anywhere in their ranges.
struct Ranges {
  std::mt19937 engine;
  int pick(int low, int high) { return low + int(engine() % std::uint32_t(high - low + 1)); }
  int height() { return engine() % 2 == 0 ? pick(-9000, 9000) : pick(-(1 << 29), 1 << 29) * 2 - 1; }
  int amount() { return engine() % 2 == 0 ? pick(0, 900) : pick(0, rules::kHeightLimit); }
  int threshold() { return engine() % 5 == 0 ? kNeverSteep : engine() % 2 == 0 ? pick(0, 2000) : pick(0, 1 << 29); }
  int roughness() { return engine() % 3 == 0 ? kOneQ16 : pick(0, kOneQ16); }
};

TEST(Slopes, FluxIsOddAndWithinAnEighthOfSoilAndRoom) {
  Ranges r{std::mt19937(61)};
  for (int round = 0; round < 50000; ++round) {
    const int a = rules::clampInt(r.height(), -rules::kHeightLimit, rules::kHeightLimit);
    const int b = round % 2 == 0 ? rules::clampInt(r.height(), -rules::kHeightLimit, rules::kHeightLimit)
                                 : rules::clampInt(a + r.pick(-5000, 5000), -rules::kHeightLimit, rules::kHeightLimit);
    const int threshold_a = r.threshold(), threshold_b = r.threshold();
    const int roughness_a = r.roughness(), roughness_b = r.roughness();
    const int threshold = a > b ? threshold_a : threshold_b, roughness = a > b ? roughness_a : roughness_b;
    const int soil_a = r.amount(), soil_b = r.amount(), room_a = r.amount(), room_b = r.amount();
    const int flow =
        rules::slopeFlux(a, b, threshold_a, threshold_b, roughness_a, roughness_b, soil_a, soil_b, room_a, room_b);
    ASSERT_EQ(
        rules::slopeFlux(b, a, threshold_b, threshold_a, roughness_b, roughness_a, soil_b, soil_a, room_b, room_a),
        -flow);
    const std::int64_t excess = std::max<std::int64_t>(std::abs(std::int64_t(a) - b) - threshold, 0);
    const std::int64_t expected =
        std::min({std::int64_t(__int128(excess) * roughness / 65536), std::int64_t(a > b ? soil_a : soil_b),
                  std::int64_t(a > b ? room_b : room_a)}) /
        8;
    ASSERT_EQ(flow, a > b ? expected : -expected) << a << ", " << b << ", " << threshold;
  }
}

TEST(Slopes, DividingByTheNumberOfNeighboursIsExact) {
  Ranges r{std::mt19937(64)};
  for (int count = 1; count <= 8; ++count)
    for (int round = 0; round < 20000; ++round) {
      const int most = INT32_MAX / count;
      const int quotient = round < 1000 ? round : round < 2000 ? most - (round - 1000) : r.pick(0, most - 1);
      // Where a quotient begins, and just before: what is wrong anywhere is wrong there.
      ASSERT_EQ(rules::dividedByCount(quotient * count, count), quotient) << quotient << " * " << count;
      if (quotient == 0) continue;
      ASSERT_EQ(rules::dividedByCount(quotient * count - 1, count), quotient - 1) << quotient << " * " << count;
    }
  for (int count = 1; count <= 8; ++count) EXPECT_EQ(rules::dividedByCount(INT32_MAX, count), INT32_MAX / count);
}

TEST(Slopes, WhatACellGivesIsWithinItsSoilAndItsMeanDrop) {
  Ranges r{std::mt19937(62)};
  EXPECT_EQ(rules::slopeAmount(0, 0, kOneQ16, 1000), 0);
  EXPECT_LE(std::int64_t(rules::kDifferenceMost) * 8, INT32_MAX);
  for (int round = 0; round < 50000; ++round) {
    const int count = r.pick(1, 8), roughness = r.roughness(), soil = r.amount();
    int drops = 0;
    for (int i = 0; i < count; ++i) drops += std::min(r.amount(), rules::kDifferenceMost);
    const std::int64_t gives = std::int64_t(rules::slopeAmount(drops, count, roughness, soil)) * count;
    ASSERT_GE(gives, 0);
    ASSERT_LE(gives, soil);
    ASSERT_LE(gives, drops / count);
    ASSERT_GT(gives + count, std::min<std::int64_t>(std::int64_t(drops / count) * roughness / kOneQ16, soil));
  }
}

TEST(Slopes, EightNeighboursTogetherGiveNoMoreThanThereIsRoom) {
  Ranges r{std::mt19937(63)};
  for (int round = 0; round < 10000; ++round) {
    const int amount = r.amount(), room = r.amount(), flow = rules::slopeFlow(amount, room);
    ASSERT_LE(flow, amount);
    ASSERT_LE(std::int64_t(flow) * 8, room);
  }
  EXPECT_EQ(rules::slopeFlow(100, 8 * 99), 99);
  EXPECT_EQ(rules::slopeFlow(100, 8 * 101), 100);
}

TEST(Slopes, ACellGivesWhereItIsSteepAndThereIsRoom) {
  EXPECT_TRUE(rules::slopeGives(101, 100, 1));
  EXPECT_FALSE(rules::slopeGives(100, 100, 1));
  EXPECT_FALSE(rules::slopeGives(101, 100, 0));
  EXPECT_FALSE(rules::slopeGives(2 * rules::kHeightLimit, kNeverSteep, 1));
  EXPECT_FALSE(rules::slopeGives(0, 0, 1)) << "level ground rests";
  EXPECT_EQ(rules::exchangeThreshold(0), 1);
  EXPECT_EQ(rules::exchangeThreshold(7), 7);
}

}  // namespace
}  // namespace spoor::test
