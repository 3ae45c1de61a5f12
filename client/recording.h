#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <set>
#include <span>
#include <vector>

#include "shared/world/state.h"

namespace spoor {

/// Remembers what a session looked like while it is followed, so that pictures of it can be drawn afterwards and
/// drawing never delays the session. Nobody knows how long a session will be: it keeps every tick first, and every time
/// it holds twice as many moments as wanted it keeps every other one. Only tiles that changed are copied.
class Recording {
 public:
  explicit Recording(int wanted_moments) : wanted_(wanted_moments) {}

  /// Call after every update with the tiles that it changed.
  void add(const WorldState& state, std::span<const TileCoordinate> changed);

  /// Call once, at the end: the last state is always a moment.
  void finish(const WorldState& state);

  /// Shows `wanted_moments` states, evenly spread, in order: the last is the session's last.
  /// Where fewer ticks were seen than wanted, some are shown again. `show(index, state, changed)` returns false to
  /// stop.
  void replay(const BaseTerrain& base,
              const std::function<bool(int, const WorldState&, std::span<const TileCoordinate>)>& show) const;

 private:
  struct SavedTile {
    std::unique_ptr<PlaneCells> height;
    std::int64_t ground = 0;
    std::int64_t initial = 0;
  };
  struct Moment {
    std::int32_t tick = 0;
    std::vector<Pose> poses, previous_poses;
    std::size_t crater_count = 0;                             // of craters_
    std::size_t snowfall_count = 0;                           // of snowfalls_
    std::vector<std::pair<TileCoordinate, SavedTile>> tiles;  // in order; changed since the moment before
  };
  void save(const WorldState& state);
  void thinOut();

  int wanted_;
  std::int32_t spacing_ticks_ = 1;
  std::vector<Moment> moments_;
  std::vector<Crater> craters_;       // of the newest state: those of every moment come first
  std::vector<Snowfall> snowfalls_;   // the same
  std::set<TileCoordinate> changed_;  // since the last moment
  std::size_t saved_tiles_ = 0;
};

}  // namespace spoor
