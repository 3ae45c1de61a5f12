#include "shared/world/script.h"

#include <algorithm>

#include "shared/base/fixed.h"

namespace spoor {
namespace {

constexpr std::int64_t kTurnBlend_q = 5000;  // a corner is turned over half a metre on either side of it

std::int32_t scaleOf(const Body& body, std::int32_t tick) {
  const std::int64_t ticks = std::int64_t(body.last_scale_tick) - body.first_scale_tick;
  const std::int64_t passed = std::clamp<std::int64_t>(std::int64_t(tick) - body.first_scale_tick, 0, ticks);
  if (tick >= body.last_scale_tick) return body.last_scale_q16;
  if (passed == 0) return body.first_scale_q16;
  return std::int32_t(body.first_scale_q16 +
                      floorDiv((std::int64_t(body.last_scale_q16) - body.first_scale_q16) * passed, ticks));
}

}  // namespace

Script::Script(const BaseTerrain& base) : base_(&base) {
  const ScenePack& pack = base.pack();
  for (const Path& path : pack.paths) {
    Track& track = tracks_.emplace_back();
    track.start_q.push_back(0);
    const std::size_t count = path.waypoints.size();
    for (std::size_t i = 0; i + (path.closed != 0 ? 0 : 1) < count; ++i) {
      const Waypoint& from = path.waypoints[i];
      const Waypoint& to = path.waypoints[(i + 1) % count];
      const std::int64_t dx = std::int64_t(to.x_q) - from.x_q;
      const std::int64_t dy = std::int64_t(to.y_q) - from.y_q;
      track.start_q.push_back(track.start_q.back() + isqrt(std::uint64_t(dx * dx) + std::uint64_t(dy * dy)));
      track.direction.push_back(turnOf(dx, dy));
    }
  }
  for (const Mesh& mesh : pack.meshes) {
    Box box{{1 << 30, 1 << 30, 1 << 30}, {-(1 << 30), -(1 << 30), -(1 << 30)}};
    for (const auto& vertex : mesh.vertices)
      for (int axis = 0; axis < 3; ++axis) {
        box.lowest[axis] = std::min(box.lowest[axis], vertex[axis]);
        box.highest[axis] = std::max(box.highest[axis], vertex[axis]);
      }
    boxes_.push_back(box);
  }
}

std::vector<Pose> Script::poses(std::int32_t tick) const {
  std::vector<Pose> result;
  for (const Body& body : base_->pack().bodies) result.push_back(bodyPose(body, tick));
  return result;
}

std::span<const Crater> Script::craters(std::int32_t tick) const {
  const auto found = std::ranges::equal_range(base_->pack().craters, tick, {}, &Crater::tick);
  return {found.begin(), found.end()};
}

Turn Script::headingAt(const Path& path, const Track& track, std::size_t segment, std::int64_t along_q) const {
  const std::size_t count = track.direction.size();
  const auto lengthOf = [&](std::size_t i) { return track.start_q[i + 1] - track.start_q[i]; };
  const Turn here = track.direction[segment];
  const std::int64_t length = lengthOf(segment);
  const bool at_start = along_q * 2 < length;
  if (path.closed == 0 && segment == (at_start ? 0 : count - 1)) return here;
  const std::size_t other = at_start ? (segment + count - 1) % count : (segment + 1) % count;
  const std::int64_t reach = std::min({kTurnBlend_q, length / 2, lengthOf(other) / 2});
  const std::int64_t from_corner = at_start ? along_q : length - along_q;
  if (from_corner >= reach) return here;
  return blendTurn(track.direction[other], here, reach + from_corner, 2 * reach);
}

Script::Place Script::placeAt(int path_index, std::int64_t distance_q) const {
  const Path& path = base_->pack().paths[std::size_t(path_index)];
  const Track& track = tracks_[std::size_t(path_index)];
  const std::int64_t total = track.start_q.back();
  const Waypoint& first = path.waypoints.front();
  if (total == 0) return {first.x_q, first.y_q, Turn(0)};
  distance_q = std::max<std::int64_t>(distance_q, 0);
  distance_q = path.closed != 0 ? distance_q % total : std::min(distance_q, total);
  // The last segment that starts at or before the distance and is not empty.
  auto after = std::upper_bound(track.start_q.begin(), track.start_q.end(), distance_q);
  if (after == track.start_q.end()) after = std::lower_bound(track.start_q.begin(), track.start_q.end(), total);
  const auto segment = std::size_t(after - track.start_q.begin()) - 1;
  const std::int64_t along = distance_q - track.start_q[segment];
  const std::int64_t length = track.start_q[segment + 1] - track.start_q[segment];
  const Waypoint& from = path.waypoints[segment];
  const Waypoint& to = path.waypoints[(segment + 1) % path.waypoints.size()];
  return {std::int32_t(from.x_q + floorDiv((std::int64_t(to.x_q) - from.x_q) * along, length)),
          std::int32_t(from.y_q + floorDiv((std::int64_t(to.y_q) - from.y_q) * along, length)),
          headingAt(path, track, segment, along)};
}

Pose Script::bodyPose(const Body& body, std::int32_t tick) const {
  const Path& path = base_->pack().paths[std::size_t(body.path_index)];
  const std::int64_t total = tracks_[std::size_t(body.path_index)].start_q.back();
  std::int64_t distance = std::int64_t(path.speed_q_per_tick) * std::max(tick - path.first_tick, 0);
  if (path.closed == 0) distance = std::min(distance, total);

  std::int64_t lift = 0;
  std::int64_t travelled = distance;
  if (body.stride_q > 1) {
    // A foot swings forward at twice the pace through the first half of its stride, then stands until the next.
    const std::int64_t half = body.stride_q / 2;
    const std::int64_t phase = (distance + body.phase_q) % body.stride_q;
    const std::int64_t stride_start = distance - phase;
    const std::int64_t swing = std::min(phase, half);
    travelled = stride_start + swing * body.stride_q / half;
    lift = 4 * std::int64_t(body.lift_q) * swing * (half - swing) / (half * half);
  }

  const std::int32_t scale_q16 = scaleOf(body, tick);
  const auto scaled = [scale_q16](std::int32_t length_q) {
    return std::int32_t(std::int64_t(length_q) * scale_q16 >> 16);
  };
  const Place place = placeAt(body.path_index, travelled);
  Box box = boxes_[std::size_t(body.mesh_index)];
  for (int axis = 0; axis < 3; ++axis) {
    box.lowest[axis] = scaled(box.lowest[axis]);
    box.highest[axis] = scaled(box.highest[axis]);
  }
  Pose pose;
  pose.yaw = place.heading;
  const Rotation heading = rotationOf(pose);
  const auto worldOf = [&](std::int32_t forward, std::int32_t left) {
    const auto offset = rotate(heading, {body.offset_q[0] + forward, body.offset_q[1] + left, 0});
    return std::array<std::int32_t, 2>{place.x_q + offset[0], place.y_q + offset[1]};
  };
  const auto groundAt = [&](std::int32_t forward, std::int32_t left) {
    const auto at = worldOf(forward, left);
    return std::int64_t(base_->heightAt(at[0], at[1]));
  };
  pose.scale_q16 = scale_q16;
  pose.x_q = worldOf(0, 0)[0];
  pose.y_q = worldOf(0, 0)[1];
  std::int64_t ground = groundAt(0, 0);
  if (body.follows_slope != 0) {
    const std::int64_t front = groundAt(box.highest[0], 0), back = groundAt(box.lowest[0], 0);
    const std::int64_t left = groundAt(0, box.highest[1]), right = groundAt(0, box.lowest[1]);
    ground = floorDiv(front + back + left + right, 4);
    pose.pitch = turnOf(std::int64_t(box.highest[0]) - box.lowest[0], front - back);
    pose.roll = turnOf(std::int64_t(box.highest[1]) - box.lowest[1], left - right);
  }
  pose.z_q = std::int32_t(ground - body.sinkage_q + body.offset_q[2] - box.lowest[2] + lift);
  if (body.roll_radius_q > 0) {
    constexpr std::int64_t kTurnsPerRadian_milli = 10430378;             // 65536 / 2 pi
    constexpr std::int64_t kDistanceMask = (std::int64_t(1) << 39) - 1;  // 54 975 km, so that the product fits
    pose.spin = Turn((distance & kDistanceMask) * kTurnsPerRadian_milli / (std::int64_t(body.roll_radius_q) * 1000));
  }
  return pose;
}

}  // namespace spoor
