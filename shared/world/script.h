#pragma once

#include <span>
#include <vector>

#include "shared/world/base_terrain.h"

namespace spoor {

/// What a pack times itself: poses of its bodies at any tick, and its craters. All integers; the height comes from the
/// base minus the sinkage, never from the deformed ground, so a body that passes twice does not dig deeper.
class Script {
 public:
  /// The base's pack must be valid and outlive this.
  explicit Script(const BaseTerrain& base);

  /// Poses of all bodies after `tick` ticks, in the pack's order. Thread-safe (const).
  std::vector<Pose> poses(std::int32_t tick) const;

  /// The pack's craters of a tick. Thread-safe.
  std::span<const Crater> craters(std::int32_t tick) const;

 private:
  /// A path's segments: start points, directions and the distance from the first waypoint to each start.
  struct Track {
    std::vector<std::int64_t> start_q;  // [segments + 1], 0.1 mm along the path; the last is its length
    std::vector<Turn> direction;        // [segments]
  };
  /// A mesh's box in its own frame, 0.1 mm.
  struct Box {
    std::int32_t lowest[3], highest[3];
  };
  struct Place {
    std::int32_t x_q, y_q;
    Turn heading;
  };

  Place placeAt(int path_index, std::int64_t distance_q) const;
  Turn headingAt(const Path& path, const Track& track, std::size_t segment, std::int64_t along_q) const;
  Pose bodyPose(const Body& body, std::int32_t tick) const;

  const BaseTerrain* base_;
  std::vector<Track> tracks_;
  std::vector<Box> boxes_;
};

}  // namespace spoor
