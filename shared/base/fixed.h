#pragma once

#include <cstdint>

namespace spoor {

/// floor(a / b), b > 0.
constexpr std::int64_t floorDiv(std::int64_t a, std::int64_t b) { return a / b - (a % b < 0 ? 1 : 0); }

/// a * b / 2^shift, rounded to nearest (halves up). The product must fit 63 bits.
constexpr std::int64_t mulShift(std::int64_t a, std::int64_t b, int shift) {
  return (a * b + (std::int64_t(1) << (shift - 1))) >> shift;
}

/// floor(sqrt(value)).
std::uint32_t isqrt(std::uint64_t value);

/// Sine and cosine in Q30 of a 16-bit turn; within 2 units of Q30 of the exact value.
std::int32_t sineQ30(std::uint16_t turn);
std::int32_t cosineQ30(std::uint16_t turn);

/// The direction of (x, y) as a 16-bit turn from +x towards +y, rounded to nearest; 0 for (0, 0).
std::uint16_t turnOf(std::int64_t x, std::int64_t y);

}  // namespace spoor
