#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>

#include "protocol/bulk.h"
#include "shared/base/result.h"
#include "shared/codec/tile_codec.h"

namespace spoor {

/// What the clients hold, held here too: the state after the last published tick, followed through the same updates
/// that they get. Snapshots come from it, so that nobody has to ask the simulation.
class WorldMirror {
 public:
  /// `pack` must be valid and outlive this.
  WorldMirror(const ScenePack& pack, const PackId& id);

  /// Follows a published tick. An error is the publisher's fault; the mirror then makes no snapshots any more.
  [[nodiscard]] Status apply(const TickUpdate& update);

  std::int32_t tick() const { return last_tick_; }
  const PackId& packId() const { return state_.pack_id; }
  /// Where the bodies are after tick().
  const std::vector<Pose>& poses() const { return poses_; }
  /// The published hash of a tick; nothing for ticks to come and those more than kHashesKept back.
  std::optional<std::uint64_t> hashAt(std::int32_t tick) const;

  /// The state at tick() for whoever joins now; made once a tick. It stays valid, and where it is, until dropped.
  /// Errors: the mirror is broken; the state is too large for the wire.
  Result<const BulkPackage*> snapshot();
  /// Drops the snapshots for which `is_used` is false.
  template <typename IsUsed>
  void dropSnapshots(IsUsed is_used) {
    std::erase_if(snapshots_, [&](const auto& entry) { return !is_used(&entry.second); });
  }

  static constexpr std::size_t kHashesKept = 65536;

 private:
  BaseTerrain base_;
  WorldState state_;
  std::int32_t last_tick_ = 0;
  std::vector<Pose> poses_;
  std::deque<std::uint64_t> hashes_;  // of the last ticks, newest at the back
  std::map<std::int32_t, BulkPackage> snapshots_;
  std::optional<std::string> broken_;
};

}  // namespace spoor
