#include "shared/base/fixed.h"

#include <bit>
#include <initializer_list>

namespace spoor {
namespace {

constexpr std::int64_t kOneQ31 = std::int64_t(1) << 31;

/// 1 - s/d0 (1 - s/d1 (1 - s/d2 ...)): the nested form of Taylor's series for sine and cosine. Q31.
std::int64_t nested(std::int64_t square, std::initializer_list<int> divisors_from_last) {
  std::int64_t series = kOneQ31;
  for (const int divisor : divisors_from_last) series = kOneQ31 - mulShift(square, series, 31) / divisor;
  return series;
}

/// Sine of a part of a quarter turn, 0..16384 = 0..90 degrees, Q30: by the series of sine or cosine, whichever is asked
/// for at most an eighth of a turn.
std::int32_t quarterSine(std::int32_t part) {
  constexpr std::int64_t kHalfPiQ31 = 3373259426;
  const bool by_cosine = part > 8192;
  const std::int64_t x = (kHalfPiQ31 * (by_cosine ? 16384 - part : part) + (1 << 13)) >> 14;
  const std::int64_t square = mulShift(x, x, 31);
  const std::int64_t sine =
      by_cosine ? nested(square, {132, 90, 56, 30, 12, 2}) : mulShift(x, nested(square, {110, 72, 42, 20, 6}), 31);
  return std::int32_t((sine + 1) >> 1);
}

}  // namespace

std::uint32_t isqrt(std::uint64_t value) {
  std::uint64_t root = 0;
  for (int bit = (63 - std::countl_zero(value | 1)) / 2; bit >= 0; --bit) {
    const std::uint64_t next = root | (std::uint64_t(1) << bit);
    if (next * next <= value) root = next;
  }
  return std::uint32_t(root);
}

std::int32_t sineQ30(std::uint16_t turn) {
  const std::int32_t part = turn & 16383;
  switch (turn >> 14) {
    case 0:
      return quarterSine(part);
    case 1:
      return quarterSine(16384 - part);
    case 2:
      return -quarterSine(part);
    default:
      return -quarterSine(16384 - part);
  }
}

std::int32_t cosineQ30(std::uint16_t turn) { return sineQ30(std::uint16_t(turn + 16384)); }

std::uint16_t turnOf(std::int64_t x, std::int64_t y) {
  // CORDIC, vectoring: atan(2^-i) as a share of a turn, Q32.
  constexpr std::uint32_t kAtanQ32[] = {536870912, 316933406, 167458907, 85004756, 42667331, 21354465,
                                        10679838,  5340245,   2670163,   1335087,  667544,   333772,
                                        166886,    83443,     41722,     20861,    10430,    5215,
                                        2608,      1304,      652,       326,      163,      81};
  if (x == 0 && y == 0) return 0;
  std::uint32_t angle = 0;
  if (x < 0) {
    x = -x;
    y = -y;
    angle = 1u << 31;
  }
  const std::uint64_t reach = std::uint64_t(x) | std::uint64_t(y < 0 ? -y : y);
  const int shift = std::countl_zero(reach) - 4;  // use the word's precision, keep room for the rotation's growth
  x = shift >= 0 ? x << shift : x >> -shift;
  y = shift >= 0 ? y << shift : y >> -shift;
  for (int i = 0; i < 24; ++i) {
    const std::int64_t x_step = x >> i;
    const std::int64_t y_step = y >> i;
    if (y > 0) {
      x += y_step;
      y -= x_step;
      angle += kAtanQ32[i];
    } else if (y < 0) {
      x -= y_step;
      y += x_step;
      angle -= kAtanQ32[i];
    } else {
      break;
    }
  }
  return std::uint16_t((angle + (1u << 15)) >> 16);
}

}  // namespace spoor
