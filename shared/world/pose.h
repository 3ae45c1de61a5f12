#pragma once

#include <array>
#include <cstdint>

namespace spoor {

/// Angle as a 16-bit share of a full turn: 65536 = one turn; it wraps by itself.
using Turn = std::uint16_t;

inline constexpr std::int32_t kFullScale = 1 << 16;

/// Where a body is: all integers, so that it travels and hashes the same everywhere.
/// Axes of the world: x east (columns), y north (rows), z up. A mesh point p (0.1 mm) lies at
/// position + scale * yaw * pitch * roll * spin * p. All turns are right-handed but pitch, which lifts the nose.
struct Pose {
  std::int32_t x_q = 0;  // 0.1 mm from the world's south-west corner
  std::int32_t y_q = 0;
  std::int32_t z_q = 0;                 // 0.1 mm
  Turn yaw = 0;                         // about z, from east towards north
  Turn pitch = 0;                       // nose up
  Turn roll = 0;                        // about the forward axis
  Turn spin = 0;                        // about the axle (y), as a wheel that rolls forward
  std::int32_t scale_q16 = kFullScale;  // size of the mesh, 1 .. kFullScale: a body can only be smaller than its mesh
  bool operator==(const Pose&) const = default;
};

/// Rotation and scale in Q30, row-major: world = matrix * local.
struct Rotation {
  std::array<std::int32_t, 9> m_q30;
};
Rotation rotationOf(const Pose& pose);

/// matrix * point, rounded to nearest. Range: |point| < 2^30.
std::array<std::int32_t, 3> rotate(const Rotation& rotation, const std::array<std::int32_t, 3>& point);

/// The turn `part` / `whole` of the way from one to another, the short way round. whole > 0.
Turn blendTurn(Turn from, Turn to, std::int64_t part, std::int64_t whole);

/// The pose `step` / `step_count` of the way from one pose to the next; turns go the short way round.
Pose interpolate(const Pose& from, const Pose& to, int step, int step_count);

}  // namespace spoor
