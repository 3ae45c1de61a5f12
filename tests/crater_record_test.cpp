// Records of craters from outside: what is refused and in what words, limits of a pack, bytes.
#include <gtest/gtest.h>

#include <functional>
#include <random>

#include "tests/scenes.h"

namespace spoor::test {
namespace {

constexpr std::int32_t kReach = 80000;

/// 100 x 50 m that allow craters of 8 m.
ScenePack craterPack() {
  ScenePack pack = flatPack(1000, 500);
  pack.crater_limits.radius_q = kReach;
  return pack;
}

Crater goodCrater() {
  return {.x_q = 500000,
          .y_q = 250000,
          .inner_radius_q = 20000,
          .crest_radius_q = 50000,
          .rim_height_q = 6000,
          .depth_q = 20000,
          .noise_seed = 9,
          .noise_q16 = 20000};
}

std::string errorOf(const Crater& crater) {
  const ScenePack pack = craterPack();
  const Status status = validateCrater(pack, crater);
  return status ? "" : status.error();
}

std::string errorWith(std::int32_t Crater::*field, std::int32_t value) {
  Crater crater = goodCrater();
  crater.*field = value;
  return errorOf(crater);
}

TEST(CraterRecord, OfOrdinarySizeIsValid) { EXPECT_EQ(errorOf(goodCrater()), ""); }

TEST(CraterRecord, SizesThatCannotBeAreNamedWithWhatIsAllowed) {
  EXPECT_EQ(errorWith(&Crater::crest_radius_q, 0), "crater: R2 is 0 m, not above 0");
  EXPECT_EQ(errorWith(&Crater::crest_radius_q, -10000), "crater: R2 is -1 m, not above 0");
  EXPECT_EQ(errorWith(&Crater::crest_radius_q, INT32_MIN), "crater: R2 is -214748.3648 m, not above 0");
  EXPECT_EQ(errorWith(&Crater::inner_radius_q, -1), "crater: R1 is -0.0001 m, below 0");
  EXPECT_EQ(errorWith(&Crater::inner_radius_q, 50001), "crater: R1 5.0001 m is more than R2 5 m");
  EXPECT_EQ(errorWith(&Crater::inner_radius_q, INT32_MAX), "crater: R1 214748.3647 m is more than R2 5 m");
  EXPECT_EQ(errorWith(&Crater::inner_radius_q, 19999), "crater: R3 = 2 R2 - R1 is 8.0001 m, the scene allows 8 m");
  EXPECT_EQ(errorWith(&Crater::crest_radius_q, INT32_MAX),
            "crater: R3 = 2 R2 - R1 is 429494.7294 m, the scene allows 8 m");
  EXPECT_EQ(errorWith(&Crater::rim_height_q, -1), "crater: H4 is -0.0001 m, want 0 .. 104.8576 m");
  EXPECT_EQ(errorWith(&Crater::rim_height_q, (1 << 20) + 1), "crater: H4 is 104.8577 m, want 0 .. 104.8576 m");
  EXPECT_EQ(errorWith(&Crater::depth_q, -1), "crater: D5 is -0.0001 m, want 0 .. 104.8576 m");
  EXPECT_EQ(errorWith(&Crater::depth_q, INT32_MAX), "crater: D5 is 214748.3647 m, want 0 .. 104.8576 m");
}

TEST(CraterRecord, SizesAtTheEndsOfWhatIsAllowedAreValid) {
  EXPECT_EQ(errorWith(&Crater::inner_radius_q, 50000), "") << "R1 = R2";
  EXPECT_EQ(errorWith(&Crater::rim_height_q, 0), "");
  EXPECT_EQ(errorWith(&Crater::rim_height_q, 1 << 20), "");
  EXPECT_EQ(errorWith(&Crater::depth_q, 0), "");
  EXPECT_EQ(errorWith(&Crater::depth_q, 1 << 20), "");
  Crater tiny = goodCrater();
  tiny.crest_radius_q = 1;
  tiny.inner_radius_q = 0;
  EXPECT_EQ(errorOf(tiny), "");
  tiny.crest_radius_q = kReach / 2;
  EXPECT_EQ(errorOf(tiny), "") << "R3 is the largest allowed";
}

TEST(CraterRecord, MayLieOffTheMapWhereItTouchesIt) {
  constexpr std::int32_t kWidth = 1000000, kHeight = 500000;
  EXPECT_EQ(errorWith(&Crater::x_q, -kReach), "");
  EXPECT_EQ(errorWith(&Crater::x_q, kWidth - 1 + kReach), "");
  EXPECT_EQ(errorWith(&Crater::y_q, -kReach), "");
  EXPECT_EQ(errorWith(&Crater::y_q, kHeight - 1 + kReach), "");
  EXPECT_EQ(errorWith(&Crater::x_q, -kReach - 1),
            "crater: all of it lies off the map (centre -8.0001 m, 25 m, R3 8 m)");
  EXPECT_EQ(errorWith(&Crater::x_q, kWidth + kReach),
            "crater: all of it lies off the map (centre 108 m, 25 m, R3 8 m)");
  EXPECT_EQ(errorWith(&Crater::y_q, -kReach - 1),
            "crater: all of it lies off the map (centre 50 m, -8.0001 m, R3 8 m)");
  EXPECT_EQ(errorWith(&Crater::y_q, INT32_MIN),
            "crater: all of it lies off the map (centre 50 m, -214748.3648 m, R3 8 m)");
  EXPECT_EQ(errorWith(&Crater::y_q, INT32_MAX),
            "crater: all of it lies off the map (centre 50 m, 214748.3647 m, R3 8 m)");
}

TEST(CraterRecord, InASceneWithoutCratersIsRefused) {
  ScenePack pack = craterPack();
  pack.crater_limits.radius_q = 0;
  EXPECT_EQ(validateCrater(pack, goodCrater()).error(), "crater: this scene has none");
}

TEST(CraterRecord, OfAnyNumbersIsRefusedOrCanBeUsed) {
  // Under the sanitizers this shows that nothing overflows before, or after, a record has been accepted.
  constexpr std::int32_t kEnds[] = {INT32_MIN, INT32_MIN + 1, -kReach, -1, 0, 1, kReach, 1 << 20, 1 << 23, INT32_MAX};
  std::mt19937 engine(4);
  std::int32_t Crater::*const fields[] = {
      &Crater::x_q,          &Crater::y_q,    &Crater::inner_radius_q, &Crater::crest_radius_q,
      &Crater::rim_height_q, &Crater::depth_q};
  ScenePack pack = craterPack();
  pack.width_cells = 2147483;  // as wide as a map can be
  pack.crater_limits = {.radius_q = rules::kCraterReachLimit, .hash_cell_q = 1 << 20};
  const BaseTerrain base(pack);
  int accepted = 0;
  for (int i = 0; i < 300000; ++i) {
    Crater crater = goodCrater();
    for (const auto field : fields)
      if (engine() % 3 == 0) crater.*field = kEnds[engine() % std::size(kEnds)];
    if (engine() % 4 == 0) crater.x_q = 2147483000 - 1 - std::int32_t(engine() % 5);
    if (!validateCrater(pack, crater)) continue;
    ++accepted;
    if (accepted % 20 != 0) continue;
    CraterSet set(pack);
    set.add({&crater, 1});
    const DormantGround ground{&base, &set};
    const CellBox box = craterBox(pack, crater);
    ASSERT_FALSE(box.empty());
    ASSERT_EQ(set.meeting(box).size(), 1u);
    for (const auto& [x, y] : {std::pair{box.x0, box.y0}, {box.x1 - 1, box.y1 - 1}, {box.x0, box.y1 - 1}})
      ASSERT_GE(ground.height(x, y), base.height(x, y) - pack.soil_depth_q);
  }
  EXPECT_GT(accepted, 1000);
}

TEST(CraterRecord, TooManyInATickOrASessionAreRefused) {
  const ScenePack pack = craterPack();
  const std::vector<Crater> craters(kTickCratersLimit + 1, goodCrater());
  EXPECT_EQ(validateNewCraters(pack, craters, 0).error(), "65537 craters in one tick, the limit is 65536");
  const std::span most = std::span(craters).first(kTickCratersLimit);
  EXPECT_TRUE(validateNewCraters(pack, most, 0));
  EXPECT_TRUE(validateNewCraters(pack, most, kCratersLimit - kTickCratersLimit));
  EXPECT_EQ(validateNewCraters(pack, most, kCratersLimit - kTickCratersLimit + 1).error(),
            "craters: 2031617 and 65536 more, the limit of a session is 2097152");
  EXPECT_FALSE(validateNewCraters(pack, most, SIZE_MAX));
  EXPECT_TRUE(validateNewCraters(pack, {}, SIZE_MAX));
  const std::int64_t cells = hashCellsOf(pack, goodCrater());
  EXPECT_GT(cells, 0);
  EXPECT_TRUE(validateNewCraters(pack, most.first(1), 0, kCraterHashCellsLimit - cells));
  EXPECT_NE(
      validateNewCraters(pack, most.first(1), 0, kCraterHashCellsLimit - cells + 1).error().find("larger cells help"),
      std::string::npos);
}

TEST(CraterRecord, IsThirtySixBytesThatComeBack) {
  std::mt19937 engine(5);
  for (int i = 0; i < 1000; ++i) {
    Crater crater{.x_q = std::int32_t(engine()),
                  .y_q = std::int32_t(engine()),
                  .inner_radius_q = std::int32_t(engine()),
                  .crest_radius_q = std::int32_t(engine()),
                  .rim_height_q = std::int32_t(engine()),
                  .depth_q = std::int32_t(engine()),
                  .noise_seed = std::uint16_t(engine()),
                  .noise_q16 = std::uint16_t(engine()),
                  .tick = std::int32_t(engine()),
                  .id = std::uint32_t(engine())};
    ByteWriter writer;
    putCrater(writer, crater);
    ASSERT_EQ(writer.bytes.size(), 36u);
    ByteReader reader(writer.bytes);
    ASSERT_EQ(getCrater(reader), crater);
    ASSERT_EQ(reader.left(), 0u);
  }
}

TEST(CraterLimitsOfAPack, AreNamedWhereTheyCannotBe) {
  const auto errorOfLimits = [](std::int32_t CraterLimits::*field, std::int32_t value) {
    CraterLimits limits{.radius_q = kReach, .request_radius_q = 100};
    limits.*field = value;
    const Status status = validateCraterLimits(limits);
    return status ? std::string() : status.error();
  };
  EXPECT_EQ(errorOfLimits(&CraterLimits::radius_q, kReach), "");
  EXPECT_EQ(errorOfLimits(&CraterLimits::radius_q, -1), "craters.radius_q -1: want 0 .. 8388607");
  EXPECT_EQ(errorOfLimits(&CraterLimits::radius_q, 1 << 23), "craters.radius_q 8388608: want 0 .. 8388607");
  EXPECT_EQ(errorOfLimits(&CraterLimits::hash_cell_q, 5000), "");
  EXPECT_EQ(errorOfLimits(&CraterLimits::hash_cell_q, 4999), "craters.hash_cell_q 4999: want 5000 .. 1073741824");
  EXPECT_EQ(errorOfLimits(&CraterLimits::hash_cell_q, INT32_MIN),
            "craters.hash_cell_q -2147483648: want 5000 .. 1073741824");
  EXPECT_EQ(errorOfLimits(&CraterLimits::hash_cell_q, (1 << 30) + 1),
            "craters.hash_cell_q 1073741825: want 5000 .. 1073741824");
  EXPECT_EQ(errorOfLimits(&CraterLimits::request_radius_q, kReach + 1),
            "craters.request_radius_q 80001: want 0 .. 80000");
  EXPECT_EQ(errorOfLimits(&CraterLimits::request_height_q, (1 << 20) + 1),
            "craters.request_height_q 1048577: want 0 .. 1048576");
  EXPECT_EQ(errorOfLimits(&CraterLimits::request_distance_q, -7),
            "craters.request_distance_q -7: want 0 .. 2147483647");
  EXPECT_EQ(errorOfLimits(&CraterLimits::requests_per_minute, 60001),
            "craters.requests_per_minute 60001: want 0 .. 60000");
  EXPECT_TRUE(validateCraterLimits({})) << "no craters";
  EXPECT_TRUE(validateCraterLimits({.radius_q = rules::kCraterReachLimit, .hash_cell_q = 524288}));
}

/// Three that the scene times, two of them in one tick.
ScenePack timedPack() {
  ScenePack pack = craterPack();
  pack.crater_limits = {.radius_q = kReach,
                        .hash_cell_q = 7777,
                        .request_radius_q = 333,
                        .request_height_q = 444,
                        .request_distance_q = 555,
                        .requests_per_minute = 66};
  for (const std::int32_t tick : {1, 5, 5}) {
    pack.craters.push_back(goodCrater());
    pack.craters.back().tick = tick;
    pack.craters.back().id = std::uint32_t(pack.craters.size() - 1);
    pack.craters.back().x_q += tick * 1000;
  }
  return pack;
}

TEST(PackWithCraters, DecodesToWhatWasEncoded) {
  const ScenePack pack = timedPack();
  const auto bytes = encodePack(pack);
  const auto decoded = decodePack(bytes);
  ASSERT_TRUE(decoded) << decoded.error();
  EXPECT_EQ(decoded->craters, pack.craters);
  EXPECT_EQ(decoded->crater_limits, pack.crater_limits);
  EXPECT_EQ(encodePack(*decoded), bytes);
  for (std::size_t size = 0; size < bytes.size(); ++size) ASSERT_FALSE(decodePack(std::span(bytes).first(size)));
}

TEST(PackWithCraters, EveryFieldOfThemIsInTheId) {
  const PackId original = packId(encodePack(timedPack()));
  const std::function<void(ScenePack&)> changes[] = {[](ScenePack& p) { ++p.crater_limits.radius_q; },
                                                     [](ScenePack& p) { ++p.crater_limits.hash_cell_q; },
                                                     [](ScenePack& p) { ++p.crater_limits.request_radius_q; },
                                                     [](ScenePack& p) { ++p.crater_limits.request_height_q; },
                                                     [](ScenePack& p) { ++p.crater_limits.request_distance_q; },
                                                     [](ScenePack& p) { ++p.crater_limits.requests_per_minute; },
                                                     [](ScenePack& p) { p.craters.pop_back(); },
                                                     [](ScenePack& p) { ++p.craters[0].x_q; },
                                                     [](ScenePack& p) { ++p.craters[0].y_q; },
                                                     [](ScenePack& p) { ++p.craters[0].inner_radius_q; },
                                                     [](ScenePack& p) { --p.craters[0].crest_radius_q; },
                                                     [](ScenePack& p) { ++p.craters[0].rim_height_q; },
                                                     [](ScenePack& p) { ++p.craters[0].depth_q; },
                                                     [](ScenePack& p) { ++p.craters[0].noise_seed; },
                                                     [](ScenePack& p) { ++p.craters[0].noise_q16; },
                                                     [](ScenePack& p) { ++p.craters[0].tick; }};
  for (std::size_t i = 0; i < std::size(changes); ++i) {
    ScenePack pack = timedPack();
    changes[i](pack);
    ASSERT_TRUE(validatePack(pack)) << i << ": " << validatePack(pack).error();
    EXPECT_NE(packId(encodePack(pack)), original) << i;
  }
}

TEST(PackWithCraters, IsRefusedWhereTheyAreOutOfOrderOrCannotBe) {
  const auto errorAfter = [](const std::function<void(ScenePack&)>& change) {
    ScenePack pack = timedPack();
    change(pack);
    const Status status = validatePack(pack);
    return status ? std::string() : status.error();
  };
  EXPECT_EQ(errorAfter([](ScenePack&) {}), "");
  EXPECT_EQ(errorAfter([](ScenePack& p) { p.craters[1].id = 2; }), "pack: crater 1: its id is 2");
  EXPECT_EQ(errorAfter([](ScenePack& p) { std::swap(p.craters[1], p.craters[2]); }), "pack: crater 1: its id is 2");
  EXPECT_EQ(errorAfter([](ScenePack& p) { p.craters[2].tick = 4; }), "pack: crater 2: its tick is 4, before 5");
  EXPECT_EQ(errorAfter([](ScenePack& p) { p.craters[0].tick = 0; }), "pack: crater 0: its tick is 0, before 1");
  EXPECT_EQ(errorAfter([](ScenePack& p) { p.craters[0].tick = INT32_MIN; }),
            "pack: crater 0: its tick is -2147483648, before 1");
  EXPECT_EQ(errorAfter([](ScenePack& p) { p.craters[1].crest_radius_q = 0; }),
            "pack: crater 1: crater: R2 is 0 m, not above 0");
  EXPECT_EQ(errorAfter([](ScenePack& p) { p.crater_limits.radius_q = 0; }),
            "pack: craters.request_radius_q 333: want 0 .. 0");
  EXPECT_EQ(errorAfter([](ScenePack& p) { p.crater_limits = {}; }), "pack: crater 0: crater: this scene has none");
}

TEST(PackWithCraters, IsRefusedWithMoreInATickThanThereMayBe) {
  ScenePack pack = timedPack();
  pack.craters.clear();
  for (std::size_t i = 0; i <= kTickCratersLimit; ++i) {
    pack.craters.push_back(goodCrater());
    pack.craters.back().tick = 3;
    pack.craters.back().id = std::uint32_t(i);
  }
  pack.crater_limits.hash_cell_q = 1 << 30;
  EXPECT_NE(validatePack(pack).error().find("more than 65536 in one tick"), std::string::npos);
  pack.craters.back().tick = 4;
  EXPECT_TRUE(validatePack(pack)) << validatePack(pack).error();
}

TEST(PackWithCraters, IsRefusedWithMoreHashCellsThanASessionMayHave) {
  ScenePack pack = timedPack();
  const std::int64_t cells = hashCellsOf(pack, goodCrater());
  pack.craters.clear();
  for (std::int64_t i = 0; i <= kCraterHashCellsLimit / cells; ++i) {
    pack.craters.push_back(goodCrater());
    pack.craters.back().tick = std::int32_t(1 + i);
    pack.craters.back().id = std::uint32_t(i);
  }
  EXPECT_NE(validatePack(pack).error().find("larger cells help"), std::string::npos);
  pack.craters.pop_back();
  EXPECT_TRUE(validatePack(pack)) << validatePack(pack).error();
}

}  // namespace
}  // namespace spoor::test
