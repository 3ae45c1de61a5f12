// The crater's profile, its noise and how craters add up: fixed point against the same formulas in real numbers.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

#include "shared/world/crater.h"

namespace spoor::test {
namespace {

using Real = long double;
using rules::CraterShape;

const Real kPi = std::acos(-1.0L);

class Dice {
 public:
  explicit Dice(std::uint32_t seed) : engine_(seed) {}
  int number(std::int64_t low, std::int64_t high) {
    return int(low + std::int64_t(engine_() % std::uint64_t(high - low + 1)));
  }
  /// As often small as near `most`.
  int amount(int most) { return number(0, most) >> number(0, 26); }
  /// 0 .. 1
  Real fraction() { return Real(number(0, 1 << 30)) / Real(1 << 30); }
  std::uint32_t bits() { return std::uint32_t(engine_()); }

 private:
  std::mt19937_64 engine_;
};

Real smoothStep(Real t) { return t * t * (3 - 2 * t); }
Real blend(Real a, Real b, Real t) { return a + (b - a) * t; }

/// A lattice point's gradient times an offset from it. The point draws its gradient as the rule does.
Real realSlope(std::uint32_t seed, int spoke, int ring, Real du, Real dv) {
  const std::uint32_t drawn =
      rules::mix32(seed + std::uint32_t(spoke) * 0x9e3779b1u + std::uint32_t(ring) * 0x85ebca77u) >> 29;
  const Real u = (drawn & 1u) != 0 ? -du : du, v = (drawn & 2u) != 0 ? -dv : dv;
  return (drawn & 4u) != 0 ? u + v / 2 : u / 2 + v;
}

/// @param around  lattice cells round the centre, 0 .. spokes: where it meets its beginning again
Real realOctave(std::uint32_t seed, int spokes, Real around, Real out) {
  const int spoke = int(std::floor(around)) % spokes, next = (spoke + 1) % spokes, ring = int(std::floor(out));
  const Real u = around - std::floor(around), v = out - ring;
  return blend(
      blend(realSlope(seed, spoke, ring, u, v), realSlope(seed, next, ring, u - 1, v), smoothStep(u)),
      blend(realSlope(seed, spoke, ring + 1, u, v - 1), realSlope(seed, next, ring + 1, u - 1, v - 1), smoothStep(u)),
      smoothStep(v));
}

/// @param turn    0 .. 1
/// @param radius  distance from the centre by R2
Real realNoise(std::uint32_t seed, Real turn, Real radius) {
  const Real sum =
      realOctave(seed, rules::kNoiseSpokes, turn * rules::kNoiseSpokes, radius * 4) +
      realOctave(seed + 0x68bc21ebu, 2 * rules::kNoiseSpokes, turn * 2 * rules::kNoiseSpokes, radius * 8) / 2;
  return std::clamp(sum, Real(-1), Real(1));
}

/// Algorithm 1 in real numbers.
Real realDisplacement(const Crater& crater, std::uint32_t noise_seed, int dx, int dy) {
  const Real distance = std::sqrt(Real(dx) * dx + Real(dy) * dy);
  const Real crest = crater.crest_radius_q, outer = Real(crater.outerRadius());
  if (distance > outer) return 0;
  const bool cavity = distance < crest;
  const Real x = cavity ? distance / crest : outer > crest ? (distance - crest) / (outer - crest) : 0;
  const Real step = smoothStep(cavity ? x : std::sqrt(std::max(Real(0), 1 - x * x)));
  Real height = crater.rim_height_q + (cavity ? crater.depth_q : 0);
  if (crater.noise_q16 > 0) {
    const Real angle = std::atan2(Real(dy), Real(dx)) / (2 * kPi);
    height += crater.noise_q16 / Real(65536) * (Real(crater.rim_height_q) + crater.depth_q) *
              realNoise(noise_seed, angle < 0 ? angle + 1 : angle, distance / crest);
  }
  return step * height - (cavity ? crater.depth_q : 0);
}

/// A crater of any size that the rule allows, often an extreme one.
Crater drawnCrater(Dice& dice, bool noisy) {
  Crater crater;
  crater.crest_radius_q = dice.number(0, 9) == 0 ? 2 : 1 + dice.amount(rules::kCraterReachLimit - 1);
  const int crest = crater.crest_radius_q;
  const int inner[] = {0, crest, dice.number(0, crest), crest - std::min(crest, dice.amount(crest))};
  crater.inner_radius_q = std::max(inner[dice.number(0, 3)], 2 * crest - rules::kCraterReachLimit);
  crater.rim_height_q = dice.number(0, 1) == 0 ? rules::kCraterHeightLimit : dice.amount(rules::kCraterHeightLimit);
  crater.depth_q = dice.number(0, 1) == 0 ? rules::kCraterHeightLimit : dice.amount(rules::kCraterHeightLimit);
  crater.noise_seed = std::uint16_t(dice.number(0, 65535));
  if (noisy) crater.noise_q16 = std::uint16_t(dice.number(0, 1) == 0 ? 65535 : dice.number(1, 65535));
  return crater;
}

/// A point as likely near as far from the centre, often within a few units of R2 or R3, or beside the seam.
std::pair<int, int> drawnPoint(Dice& dice, const Crater& crater) {
  const auto outer = int(crater.outerRadius());
  const int distances[] = {crater.crest_radius_q + dice.number(-3, 3), outer - dice.number(0, 3), dice.amount(outer)};
  const int kind = dice.number(0, 7);
  const Real distance = kind < 3 ? Real(distances[kind]) : outer * std::sqrt(dice.fraction());
  const Real angle = 2 * kPi * dice.fraction();
  const int dy = int(std::lround(distance * std::sin(angle)));
  return {int(std::lround(distance * std::cos(angle))), dice.number(0, 9) == 0 ? dice.number(-1, 1) : dy};
}

/// The largest error of a million samples, 0.1 mm.
double worstError(std::uint32_t seed, bool noisy) {
  Dice dice(seed);
  Real worst = 0;
  for (int i = 0; i < 1'000'000; ++i) {
    const Crater crater = drawnCrater(dice, noisy);
    const CraterShape shape = shapeOf(crater);
    const auto [dx, dy] = drawnPoint(dice, crater);
    const Real error =
        std::abs(rules::craterDisplacement(shape, dx, dy) - realDisplacement(crater, shape.seed, dx, dy));
    if (error >= 1)
      ADD_FAILURE() << "off by " << error << " at (" << dx << ", " << dy << "), R1 " << crater.inner_radius_q << ", R2 "
                    << crater.crest_radius_q << ", H4 " << crater.rim_height_q << ", D5 " << crater.depth_q
                    << ", noise " << crater.noise_q16;
    worst = std::max(worst, error);
    if (::testing::Test::HasFailure()) break;
  }
  return double(worst);
}

TEST(CraterRule, IsLessThanAUnitFromRealNumbersOverAMillionSamples) {
  const double worst = worstError(1, false);
  EXPECT_LT(worst, 1);
  std::printf("worst error %.4f units\n", worst);
  RecordProperty("worst_error", std::to_string(worst));
}

TEST(CraterRule, WithNoiseToo) {
  const double worst = worstError(2, true);
  EXPECT_LT(worst, 1);
  std::printf("worst error %.4f units\n", worst);
  RecordProperty("worst_error", std::to_string(worst));
}

TEST(CraterRule, AKnownCraterHasItsHeightsAtTheCentreTheCrestAndTheEnd) {
  const CraterShape shape =
      shapeOf({.inner_radius_q = 20000, .crest_radius_q = 50000, .rim_height_q = 7000, .depth_q = 30000});
  EXPECT_EQ(shape.outer, 80000);
  EXPECT_EQ(rules::craterDisplacement(shape, 0, 0), -30000);
  EXPECT_EQ(rules::craterDisplacement(shape, 25000, 0), -30000 + 37000 / 2) << "smooth step of a half";
  EXPECT_EQ(rules::craterDisplacement(shape, 50000, 0), 7000);
  EXPECT_EQ(rules::craterDisplacement(shape, 30000, -40000), 7000);
  EXPECT_EQ(rules::craterDisplacement(shape, 0, 80000), 0);
  EXPECT_EQ(rules::craterDisplacement(shape, 80001, 0), 0);
  EXPECT_EQ(rules::craterDisplacement(shape, INT32_MIN, INT32_MAX), 0);
}

TEST(CraterRule, WithoutNoiseAllEightDirectionsAreAlikeAndTheSeedDoesNotCount) {
  Dice dice(3);
  for (int i = 0; i < 20000; ++i) {
    Crater crater = drawnCrater(dice, false);
    const CraterShape shape = shapeOf(crater);
    crater.noise_seed = std::uint16_t(crater.noise_seed + 1);
    const CraterShape other_seed = shapeOf(crater);
    const auto [dx, dy] = drawnPoint(dice, crater);
    const int expected = rules::craterDisplacement(shape, dx, dy);
    for (const auto& [x, y] : {std::pair{-dx, dy}, {dx, -dy}, {-dx, -dy}, {dy, dx}, {-dy, dx}, {dy, -dx}, {-dy, -dx}})
      ASSERT_EQ(rules::craterDisplacement(shape, x, y), expected);
    ASSERT_EQ(rules::craterDisplacement(other_seed, dx, dy), expected);
  }
}

TEST(CraterRule, RisesToTheCrestAndFallsFromThereWithoutAJump) {
  for (const auto& [inner, crest] : {std::pair{0, 3000}, {1000, 3000}, {2900, 3000}, {100, 700}}) {
    const Crater crater{.inner_radius_q = inner, .crest_radius_q = crest, .rim_height_q = 900, .depth_q = 1600};
    const CraterShape shape = shapeOf(crater);
    // The profile's steepest slopes, of its cavity and of its outer side: 1.5 (H4 + D5) / R2 and 6 H4 / m near R3.
    const int cavity_step = 1 + int(std::ceil(1.5 * 2500 / crest));
    const int outer_step = 1 + int(std::ceil(6.0 * 900 / (crest - inner)));
    int before = rules::craterDisplacement(shape, 0, 0);
    for (int x = 1; x <= shape.outer + 1; ++x) {
      const int height = rules::craterDisplacement(shape, x, 0);
      ASSERT_LE(std::abs(height - before), x <= crest ? cavity_step : outer_step) << "at " << x << " of " << crest;
      ASSERT_TRUE(x <= crest ? height >= before : height <= before) << "at " << x << " of " << crest;
      before = height;
    }
    EXPECT_EQ(before, 0);
  }
}

/// What an octave's value changes by across the beginning of a spoke, from the last place before it.
int jumpAt(std::uint32_t seed, int spokes, int spoke, std::uint32_t out) {
  const std::uint32_t at = std::uint32_t(spoke) << rules::kNoiseBits;
  const std::uint32_t end = std::uint32_t(spokes) << rules::kNoiseBits;
  return std::abs(rules::noiseOctave(seed, spokes, at, out) -
                  rules::noiseOctave(seed, spokes, at == 0 ? end - 1 : at - 1, out));
}

TEST(CraterNoise, HasNoSeamAtTheFullTurn) {
  // At the full turn the lattice is at its beginning again: no more than a step of 2^-27 of a cell is left, as across
  // any other line of the lattice.
  Dice dice(4);
  int seam = 0, elsewhere = 0;
  for (int i = 0; i < 200000; ++i) {
    const std::uint32_t seed = dice.bits(), out = dice.bits() >> 2;
    for (const int spokes : {rules::kNoiseSpokes, 2 * rules::kNoiseSpokes}) {
      seam = std::max(seam, jumpAt(seed, spokes, 0, out));
      elsewhere = std::max(elsewhere, jumpAt(seed, spokes, dice.number(1, spokes - 1), out));
    }
  }
  EXPECT_LE(seam, elsewhere);
  EXPECT_LE(seam, 4) << "of 2^27";
  int whole = 0;
  for (int i = 0; i < 200000; ++i) {
    const std::uint32_t seed = dice.bits(), radius = dice.bits() >> 1;
    whole =
        std::max(whole, std::abs(rules::craterNoise(seed, 0, radius) - rules::craterNoise(seed, 0xffffffffu, radius)));
  }
  EXPECT_LE(whole, 8) << "of 2^27";
  std::printf("seam %d, other lines %d; both octaves %d of 2^27\n", seam, elsewhere, whole);
}

TEST(CraterNoise, OfTheLargestCraterIsTheSameOnBothSidesOfTheSeam) {
  // The largest noise there is, so far out that neighbours across the seam lie 2^-25 of a turn apart: equal to the
  // unit but for rounding, and no farther apart than neighbours along any other ray.
  Dice dice(5);
  int across = 0, elsewhere = 0;
  for (int i = 0; i < 100000; ++i) {
    const Crater crater{.inner_radius_q = dice.number(1, 4194303),
                        .crest_radius_q = 4194303,
                        .rim_height_q = rules::kCraterHeightLimit,
                        .depth_q = rules::kCraterHeightLimit,
                        .noise_seed = std::uint16_t(i),
                        .noise_q16 = 65535};
    const CraterShape shape = shapeOf(crater);
    const int dx = dice.number(3000000, shape.outer);
    const auto jump = [&](int x, int y, int step_x, int step_y) {
      return std::abs(rules::craterDisplacement(shape, x, y) -
                      rules::craterDisplacement(shape, x + step_x, y + step_y));
    };
    across = std::max({across, jump(dx, 0, 0, -1), jump(dx, 0, 0, 1)});
    elsewhere = std::max({elsewhere, jump(0, dx, 1, 0), jump(-dx, 0, 0, 1), jump(dx, 0, 0, 1), jump(0, -dx, 1, 0)});
  }
  EXPECT_LE(across, elsewhere);
  EXPECT_LE(across, 6);
  std::printf("across the seam %d units, elsewhere %d\n", across, elsewhere);
}

TEST(CraterNoise, IsWithinOneAndDiffersBySeed) {
  Dice dice(6);
  int lowest = 0, highest = 0, alike = 0;
  for (int i = 0; i < 200000; ++i) {
    const std::uint32_t seed = dice.bits(), turn = dice.bits(), radius = dice.bits() >> 1;
    const int noise = rules::craterNoise(seed, turn, radius);
    lowest = std::min(lowest, noise);
    highest = std::max(highest, noise);
    alike += noise == rules::craterNoise(seed + 1, turn, radius) ? 1 : 0;
  }
  EXPECT_GE(lowest, -rules::kNoiseOne);
  EXPECT_LE(highest, rules::kNoiseOne);
  EXPECT_LT(lowest, -rules::kNoiseOne / 2);
  EXPECT_GT(highest, rules::kNoiseOne / 2);
  EXPECT_LT(alike, 20);
}

TEST(CraterNoise, LeavesTheCentreAndTheEndAsTheyAre) {
  Dice dice(7);
  for (int i = 0; i < 5000; ++i) {
    Crater crater = drawnCrater(dice, true);
    const CraterShape shape = shapeOf(crater);
    EXPECT_EQ(rules::craterDisplacement(shape, 0, 0), -crater.depth_q);
    if (crater.inner_radius_q < crater.crest_radius_q) {
      EXPECT_EQ(rules::craterDisplacement(shape, shape.outer, 0), 0);
    }
  }
}

int totalOf(std::span<const std::pair<int, int>> craters) {
  rules::CraterSum sum = rules::craterSumOfNone();
  for (const auto& [displacement, rim] : craters) sum = rules::withCrater(sum, displacement, rim);
  return rules::craterTotal(sum);
}

TEST(CraterSum, OneCraterDoesWhatItDoes) {
  EXPECT_EQ(totalOf({}), 0);
  Dice dice(8);
  for (int i = 0; i < 10000; ++i) {
    const std::pair<int, int> crater{dice.number(-3000000, 3000000), dice.number(0, rules::kCraterHeightLimit)};
    ASSERT_EQ(totalOf({&crater, 1}), crater.first) << "even where noise lifts it above its rim " << crater.second;
  }
}

TEST(CraterSum, DepthsAddUpAndRimsAsFarAsTheHighest) {
  const std::pair<int, int> depths[] = {{-100, 50}, {-30, 50}, {0, 900}};
  EXPECT_EQ(totalOf(depths), -130);
  const std::pair<int, int> low_rims[] = {{10, 50}, {30, 70}};
  EXPECT_EQ(totalOf(low_rims), 40) << "less than the highest rim";
  const std::pair<int, int> rims[] = {{40, 50}, {30, 70}, {60, 60}};
  EXPECT_EQ(totalOf(rims), 70);
  const std::pair<int, int> noisy[] = {{40, 50}, {90, 70}};
  EXPECT_EQ(totalOf(noisy), 90) << "noise reaches above the rim";
  const std::pair<int, int> both[] = {{40, 50}, {-100, 10000}, {45, 50}};
  EXPECT_EQ(totalOf(both), 50 - 100) << "the rim of a crater that is a cavity here does not count";
}

TEST(CraterSum, IsAFunctionOfTheSet) {
  Dice dice(9);
  for (int i = 0; i < 20000; ++i) {
    std::vector<std::pair<int, int>> craters;
    const int reach = 1 << dice.number(0, 29);  // with large ones sums reach their limits
    for (int count = dice.number(1, 12); count > 0; --count)
      craters.emplace_back(dice.number(-reach, reach), dice.amount(rules::kCraterHeightLimit));
    const int expected = totalOf(craters);
    for (int shuffle = 0; shuffle < 4; ++shuffle) {
      for (std::size_t j = craters.size(); j > 1; --j)
        std::swap(craters[j - 1], craters[std::size_t(dice.number(0, std::int64_t(j) - 1))]);
      ASSERT_EQ(totalOf(craters), expected);
    }
  }
}

TEST(CraterSum, SaturatesUnderTwoMillionCraters) {
  rules::CraterSum deep = rules::craterSumOfNone(), high = deep;
  for (std::size_t i = 0; i < kCratersLimit; ++i) {
    deep = rules::withCrater(deep, -rules::kCraterHeightLimit, 0);
    high = rules::withCrater(high, 2 * rules::kCraterHeightLimit, rules::kCraterHeightLimit);
  }
  EXPECT_EQ(rules::craterTotal(deep), -rules::kCraterSumLimit);
  EXPECT_EQ(high.rims, rules::kCraterSumLimit);
  EXPECT_EQ(rules::craterTotal(high), 2 * rules::kCraterHeightLimit);
  EXPECT_EQ(rules::craterGround(rules::kHeightLimit, 5, rules::craterTotal(high)), rules::kHeightLimit);
  EXPECT_EQ(rules::craterGround(-rules::kHeightLimit, -rules::kHeightLimit, rules::craterTotal(deep)),
            -rules::kHeightLimit);
  EXPECT_EQ(rules::craterGround(100, 30, -50), 50);
  EXPECT_EQ(rules::craterGround(100, 30, -71), 30);
}

/// Integral of the profile over the plane, by Simpson's rule on both sides of the crest.
double volumeOf(const Crater& crater) {
  constexpr int kParts = 2000;
  double sum = 0;
  const double ends[] = {0, double(crater.crest_radius_q), double(crater.outerRadius())};
  for (int side = 0; side < 2; ++side) {
    // t = x^2 at the centre of both ends' square roots: the outer side falls like a root, so sample it evenly in angle.
    const double width = ends[side + 1] - ends[side];
    for (int i = 0; i <= kParts; ++i) {
      const double angle = 0.5 * double(kPi) * i / kParts, x = std::sin(angle);
      const double radius = ends[side] + width * x;
      const double step = double(smoothStep(side == 0 ? x : std::cos(angle)));
      const double height = side == 0 ? step * (double(crater.rim_height_q) + crater.depth_q) - crater.depth_q
                                      : step * crater.rim_height_q;
      const double weight = i == 0 || i == kParts ? 1 : i % 2 == 1 ? 4 : 2;
      sum += weight * height * 2 * double(kPi) * radius * width * std::cos(angle) * 0.5 * double(kPi) / kParts / 3;
    }
  }
  return sum;
}

TEST(BalancedCrater, HasNoVolumeToTheRoundingOfItsRim) {
  Dice dice(10);
  double worst = 0;
  for (int i = 0; i < 3000; ++i) {
    Crater crater = drawnCrater(dice, false);
    crater.rim_height_q = balancedRimHeight(crater.inner_radius_q, crater.crest_radius_q, crater.depth_q);
    ASSERT_GE(crater.rim_height_q, 0);
    ASSERT_LE(crater.rim_height_q, rules::kCraterHeightLimit);
    Crater higher = crater;
    ++higher.rim_height_q;
    const double unit = volumeOf(higher) - volumeOf(crater);
    const double off = std::abs(volumeOf(crater)) / unit;  // in units of H4
    ASSERT_LE(off, 0.51) << "R1 " << crater.inner_radius_q << ", R2 " << crater.crest_radius_q << ", D5 "
                         << crater.depth_q << ", H4 " << crater.rim_height_q;
    worst = std::max(worst, off);
  }
  std::printf("off by at most %.4f units of H4\n", worst);
}

TEST(BalancedCrater, OfThePaperLeavesNextToNothingOnCells) {
  Dice dice(11);
  for (const auto& [inner, crest] : {std::pair{30000, 60000}, {0, 45000}, {90000, 100000}})
    for (int i = 0; i < 4; ++i) {
      Crater crater{.x_q = dice.number(0, 999),
                    .y_q = dice.number(0, 999),
                    .inner_radius_q = inner,
                    .crest_radius_q = crest,
                    .depth_q = 20000};
      crater.rim_height_q = balancedRimHeight(inner, crest, crater.depth_q);
      const CraterShape shape = shapeOf(crater);
      std::int64_t given = 0, taken = 0;
      for (int y = -160000; y <= 160000; y += 1000)
        for (int x = -160000; x <= 160000; x += 1000) {
          const int change = rules::craterDisplacement(shape, x - crater.x_q, y - crater.y_q);
          (change > 0 ? given : taken) += change;
        }
      EXPECT_LT(std::abs(double(given + taken)), 0.005 * double(-taken)) << given << " given, " << taken << " taken";
    }
}

}  // namespace
}  // namespace spoor::test
