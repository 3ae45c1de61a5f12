#include "shared/world/noise.h"

#include "shared/base/hash.h"

namespace spoor {
namespace {

constexpr int kFractionBits = 20;
constexpr std::int64_t kOne = std::int64_t(1) << kFractionBits;

/// Offset from a lattice point times its gradient: one of eight unit directions, Q20.
std::int64_t gradientDot(std::uint64_t seed, std::int64_t lattice_x, std::int64_t lattice_y, std::int64_t dx,
                         std::int64_t dy) {
  constexpr std::int64_t kDiagonal = 741455;  // 2^20 / sqrt 2
  const std::uint64_t hash = mix64(mix64(seed ^ std::uint64_t(lattice_x)) + std::uint64_t(lattice_y));
  switch (hash >> 61) {
    case 0:
      return dx;
    case 1:
      return -dx;
    case 2:
      return dy;
    case 3:
      return -dy;
    case 4:
      return ((dx + dy) * kDiagonal) >> kFractionBits;
    case 5:
      return ((dx - dy) * kDiagonal) >> kFractionBits;
    case 6:
      return ((dy - dx) * kDiagonal) >> kFractionBits;
    default:
      return ((-dx - dy) * kDiagonal) >> kFractionBits;
  }
}

std::int64_t fade(std::int64_t t) {
  const std::int64_t t3 = (((t * t) >> kFractionBits) * t) >> kFractionBits;
  return (t3 * (((t * (6 * t - 15 * kOne)) >> kFractionBits) + 10 * kOne)) >> kFractionBits;
}

std::int64_t blend(std::int64_t a, std::int64_t b, std::int64_t t) { return a + (((b - a) * t) >> kFractionBits); }

/// One octave at a lattice position in Q32, about -kOne..kOne.
std::int64_t octaveAt(std::uint64_t seed, std::int64_t x_q32, std::int64_t y_q32) {
  const std::int64_t lattice_x = x_q32 >> 32;
  const std::int64_t lattice_y = y_q32 >> 32;
  const std::int64_t dx = (x_q32 >> (32 - kFractionBits)) & (kOne - 1);
  const std::int64_t dy = (y_q32 >> (32 - kFractionBits)) & (kOne - 1);
  const std::int64_t fade_x = fade(dx);
  const std::int64_t south = blend(gradientDot(seed, lattice_x, lattice_y, dx, dy),
                                   gradientDot(seed, lattice_x + 1, lattice_y, dx - kOne, dy), fade_x);
  const std::int64_t north = blend(gradientDot(seed, lattice_x, lattice_y + 1, dx, dy - kOne),
                                   gradientDot(seed, lattice_x + 1, lattice_y + 1, dx - kOne, dy - kOne), fade_x);
  constexpr std::int64_t kSqrt2 = 1482910;  // gradient noise with unit gradients reaches 1 / sqrt 2
  return (blend(south, north, fade(dy)) * kSqrt2) >> kFractionBits;
}

}  // namespace

std::int32_t noiseHeight(const NoiseBase& noise, std::int32_t x, std::int32_t y) {
  std::int64_t sum = 0;
  std::int64_t weight_sum = 0;
  for (int octave = 0; octave < noise.octaves; ++octave) {
    const std::int64_t weight = std::int64_t(1) << (noise.octaves - 1 - octave);
    const std::int64_t step = noise.lattice_step_q32 << octave;
    sum += weight * octaveAt(noise.seed + std::uint64_t(octave), x * step, y * step);
    weight_sum += weight;
  }
  std::int64_t share = (sum / weight_sum + kOne) / 2;  // 0..kOne
  share = share < 0 ? 0 : share > kOne ? kOne : share;
  return std::int32_t(noise.lowest_q + (((std::int64_t(noise.highest_q) - noise.lowest_q) * share) >> kFractionBits));
}

}  // namespace spoor
