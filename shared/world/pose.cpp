#include "shared/world/pose.h"

#include "shaders/rules/place.h"
#include "shared/base/fixed.h"

namespace spoor {
namespace {

using Matrix = std::array<std::int32_t, 9>;

Matrix product(const Matrix& a, const Matrix& b) {
  Matrix result{};
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) {
      std::int64_t sum = std::int64_t(1) << 29;
      for (int i = 0; i < 3; ++i) sum += std::int64_t(a[row * 3 + i]) * b[i * 3 + column];
      result[row * 3 + column] = std::int32_t(sum >> 30);
    }
  return result;
}

std::int32_t blend(std::int32_t from, std::int32_t to, int step, int step_count) {
  return std::int32_t(from + floorDiv((std::int64_t(to) - from) * step, step_count));
}

}  // namespace

Rotation rotationOf(const Pose& pose) {
  constexpr std::int32_t one = 1 << 30;
  const std::int32_t yaw_s = sineQ30(pose.yaw), yaw_c = cosineQ30(pose.yaw);
  const std::int32_t pitch_s = sineQ30(pose.pitch), pitch_c = cosineQ30(pose.pitch);
  const std::int32_t roll_s = sineQ30(pose.roll), roll_c = cosineQ30(pose.roll);
  const std::int32_t spin_s = sineQ30(pose.spin), spin_c = cosineQ30(pose.spin);
  const Matrix yaw = {yaw_c, -yaw_s, 0, yaw_s, yaw_c, 0, 0, 0, one};
  const Matrix pitch = {pitch_c, 0, -pitch_s, 0, one, 0, pitch_s, 0, pitch_c};
  const Matrix roll = {one, 0, 0, 0, roll_c, -roll_s, 0, roll_s, roll_c};
  const Matrix spin = {spin_c, 0, spin_s, 0, one, 0, -spin_s, 0, spin_c};
  Matrix matrix = product(product(yaw, pitch), product(roll, spin));
  if (pose.scale_q16 != kFullScale)
    for (std::int32_t& entry : matrix) entry = std::int32_t(std::int64_t(entry) * pose.scale_q16 >> 16);
  return {matrix};
}

std::array<std::int32_t, 3> rotate(const Rotation& rotation, const std::array<std::int32_t, 3>& point) {
  const auto& m = rotation.m_q30;
  const auto row = [&](int i) {
    return rules::rotatedCoordinate(m[i], m[i + 1], m[i + 2], point[0], point[1], point[2]);
  };
  return {row(0), row(3), row(6)};
}

Turn blendTurn(Turn from, Turn to, std::int64_t part, std::int64_t whole) {
  return Turn(from + floorDiv(std::int16_t(std::uint16_t(to - from)) * part, whole));
}

Pose interpolate(const Pose& from, const Pose& to, int step, int step_count) {
  if (step == step_count) return to;
  return {blend(from.x_q, to.x_q, step, step_count),         blend(from.y_q, to.y_q, step, step_count),
          blend(from.z_q, to.z_q, step, step_count),         blendTurn(from.yaw, to.yaw, step, step_count),
          blendTurn(from.pitch, to.pitch, step, step_count), blendTurn(from.roll, to.roll, step, step_count),
          blendTurn(from.spin, to.spin, step, step_count),   blend(from.scale_q16, to.scale_q16, step, step_count)};
}

}  // namespace spoor
