// Fixed-point maths against the C library's doubles.
#include "shared/base/fixed.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "shaders/rules/language.h"
#include "shared/world/pose.h"

namespace spoor::test {
namespace {

constexpr double kOne = double(1 << 30);
double radians(int turn) { return turn * std::numbers::pi / 32768; }

TEST(Fixed, SineAndCosineAreWithinTwoUnits) {
  for (int turn = 0; turn < 65536; ++turn) {
    ASSERT_NEAR(sineQ30(std::uint16_t(turn)), std::sin(radians(turn)) * kOne, 2.0) << "turn " << turn;
    ASSERT_NEAR(cosineQ30(std::uint16_t(turn)), std::cos(radians(turn)) * kOne, 2.0) << "turn " << turn;
  }
}

TEST(Fixed, SineOfQuarterTurnsIsExact) {
  EXPECT_EQ(sineQ30(0), 0);
  EXPECT_EQ(sineQ30(16384), 1 << 30);
  EXPECT_EQ(sineQ30(32768), 0);
  EXPECT_EQ(sineQ30(49152), -(1 << 30));
}

TEST(Fixed, TurnOfIsTheNearestTurnToTheDirection) {
  std::mt19937_64 engine(41);
  for (int round = 0; round < 200000; ++round) {
    const int range = 1 << (1 + round % 28);
    const auto x = std::int64_t(engine() % std::uint64_t(2 * range)) - range;
    const auto y = std::int64_t(engine() % std::uint64_t(2 * range)) - range;
    if (x == 0 && y == 0) continue;
    double off = turnOf(x, y) - std::atan2(double(y), double(x)) / (2 * std::numbers::pi) * 65536;
    off -= 65536 * std::round(off / 65536);
    ASSERT_LE(std::abs(off), 0.51) << x << ", " << y;
  }
}

TEST(Fixed, TurnOfTheEightCompassPointsIsExact) {
  const std::pair<int, int> points[] = {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}};
  for (int i = 0; i < 8; ++i)
    for (const std::int64_t length : {std::int64_t(1), std::int64_t(12345), std::int64_t(1) << 40})
      EXPECT_EQ(turnOf(points[i].first * length, points[i].second * length), i * 8192) << i << ", " << length;
  EXPECT_EQ(turnOf(0, 0), 0);
}

TEST(Fixed, IsqrtIsTheRootRoundedDown) {
  for (std::uint64_t value = 0; value < 70000; ++value) {
    const std::uint64_t root = isqrt(value);
    ASSERT_TRUE(root * root <= value && value < (root + 1) * (root + 1)) << value;
  }
  for (std::uint64_t root = 1; root <= 0xffffffffu; root = root * 3 + 1) {
    ASSERT_EQ(isqrt(root * root), root);
    ASSERT_EQ(isqrt(root * root - 1), root - 1);
  }
  EXPECT_EQ(isqrt(~std::uint64_t(0)), 0xffffffffu);
}

TEST(Fixed, DivisionsRoundDownOnBothSidesOfZero) {
  for (int a = -50; a <= 50; ++a)
    for (int b = 1; b <= 13; ++b) {
      const int expected = int(std::floor(double(a) / b));
      ASSERT_EQ(floorDiv(a, b), expected) << a << " / " << b;
      ASSERT_EQ(rules::floorDiv(a, b), expected) << a << " / " << b;
      ASSERT_EQ(rules::wideFloorDiv(a, b), expected) << a << " / " << b;
    }
  EXPECT_EQ(mulShift(3, 1, 1), 2);
  EXPECT_EQ(mulShift(-3, 1, 1), -1);
}

TEST(Pose, RotationsKeepLengthsAndRightAngles) {
  std::mt19937 engine(42);
  for (int round = 0; round < 20000; ++round) {
    const Pose pose{0, 0, 0, Turn(engine()), Turn(engine()), Turn(engine()), Turn(engine())};
    const auto& m = rotationOf(pose).m_q30;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        double dot = 0;
        for (int k = 0; k < 3; ++k) dot += (m[std::size_t(i * 3 + k)] / kOne) * (m[std::size_t(j * 3 + k)] / kOne);
        ASSERT_NEAR(dot, i == j ? 1 : 0, 3e-8) << "rows " << i << " and " << j;
      }
  }
}

TEST(Pose, EachTurnGoesItsOwnWay) {
  const auto turned = [](Pose pose, std::array<std::int32_t, 3> point) { return rotate(rotationOf(pose), point); };
  using Point = std::array<std::int32_t, 3>;
  EXPECT_EQ(turned({.yaw = 16384}, {100, 0, 7}), (Point{0, 100, 7})) << "yaw goes from east to north";
  EXPECT_EQ(turned({.pitch = 16384}, {100, 7, 0}), (Point{0, 7, 100})) << "pitch lifts the nose";
  EXPECT_EQ(turned({.roll = 16384}, {7, 100, 0}), (Point{7, 0, 100})) << "roll lifts the left side";
  EXPECT_EQ(turned({.spin = 16384}, {0, 7, 100}), (Point{100, 7, 0})) << "a wheel's top rolls forward";
  EXPECT_EQ(turned({.yaw = 32768}, {1 << 24, -(1 << 24), 3}), (Point{-(1 << 24), 1 << 24, 3}));
}

TEST(Pose, InterpolationEndsAtBothPosesAndTurnsTheShortWay) {
  const Pose from{-1000, 5, 2000000000, 65000, 100, 0, 32768}, to{1000, 6, -2000000000, 500, 65500, 7, 0};
  EXPECT_EQ(interpolate(from, to, 0, 7), from);
  EXPECT_EQ(interpolate(from, to, 7, 7), to);
  const Pose half = interpolate(from, to, 1, 2);
  EXPECT_EQ(half.x_q, 0);
  EXPECT_EQ(half.y_q, 5);
  EXPECT_EQ(half.z_q, 0);
  EXPECT_EQ(half.yaw, 65518);  // 1036 from 65000 to 500 across zero
  EXPECT_EQ(half.pitch, 32);   // 136 backwards across zero
}

}  // namespace
}  // namespace spoor::test
