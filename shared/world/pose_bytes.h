#pragma once

#include <vector>

#include "shared/base/bytes.h"
#include "shared/world/pose.h"

namespace spoor {

inline constexpr std::size_t kPoseBytes = 4 * 4 + 4 * 2;

inline void putPose(ByteWriter& writer, const Pose& pose) {
  for (const std::int32_t value : {pose.x_q, pose.y_q, pose.z_q}) writer.put(value);
  for (const Turn turn : {pose.yaw, pose.pitch, pose.roll, pose.spin}) writer.put(turn);
  writer.put(pose.scale_q16);
}

inline Pose getPose(ByteReader& reader) {
  Pose pose;
  for (std::int32_t* value : {&pose.x_q, &pose.y_q, &pose.z_q}) *value = reader.get<std::int32_t>();
  for (Turn* turn : {&pose.yaw, &pose.pitch, &pose.roll, &pose.spin}) *turn = reader.get<Turn>();
  pose.scale_q16 = reader.get<std::int32_t>();
  return pose;
}

}  // namespace spoor
