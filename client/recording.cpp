#include "client/recording.h"

#include <algorithm>

namespace spoor {

namespace {

// A gigabyte of heights: beyond it, moments are thinned out early.
constexpr std::size_t kSavedTilesLimit = (std::size_t(1) << 30) / sizeof(PlaneCells);

}  // namespace

void Recording::add(const WorldState& state, std::span<const TileCoordinate> changed) {
  if (wanted_ == 0) return;
  changed_.insert(changed.begin(), changed.end());
  if (!moments_.empty() && state.tick - moments_.back().tick < spacing_ticks_) return;
  save(state);
  while (moments_.size() >= 2 && (moments_.size() > 2 * std::size_t(wanted_) || saved_tiles_ > kSavedTilesLimit)) {
    const std::size_t before = moments_.size();
    thinOut();
    if (moments_.size() == before) break;
  }
}

void Recording::finish(const WorldState& state) {
  if (wanted_ == 0 || (!moments_.empty() && moments_.back().tick == state.tick && changed_.empty())) return;
  save(state);
}

void Recording::save(const WorldState& state) {
  const std::span<const Crater> craters = state.craters.records();
  if (craters.size() > craters_.size())
    craters_.insert(craters_.end(), craters.begin() + std::ptrdiff_t(craters_.size()), craters.end());
  snowfalls_ = state.snowfalls;
  Moment moment{state.tick, state.poses, state.previous_poses, craters.size(), snowfalls_.size(), {}};
  for (const TileCoordinate at : changed_) {
    const Tile* tile = state.tiles.find(at);
    if (tile == nullptr) continue;
    moment.tiles.emplace_back(at, SavedTile{std::make_unique<PlaneCells>(tile->height()), tile->ground, tile->initial});
  }
  saved_tiles_ += moment.tiles.size();
  changed_.clear();
  moments_.push_back(std::move(moment));
}

/// Drops every other moment but the last; what only the dropped one changed moves to the one after it.
void Recording::thinOut() {
  std::vector<Moment> kept;
  for (std::size_t i = 0; i < moments_.size(); ++i) {
    const bool drop = i % 2 == 0 && i + 1 < moments_.size();
    if (!drop) {
      kept.push_back(std::move(moments_[i]));
      continue;
    }
    auto& next = moments_[i + 1].tiles;
    // Stable order and first wins: a tile of the later moment comes before the same one of the dropped.
    std::move(moments_[i].tiles.begin(), moments_[i].tiles.end(), std::back_inserter(next));
    std::ranges::stable_sort(next, {}, &std::pair<TileCoordinate, SavedTile>::first);
    const auto twice = std::ranges::unique(next, {}, &std::pair<TileCoordinate, SavedTile>::first);
    saved_tiles_ -= twice.size();
    next.erase(twice.begin(), twice.end());
  }
  moments_ = std::move(kept);
  spacing_ticks_ *= 2;
}

void Recording::replay(const BaseTerrain& base,
                       const std::function<bool(int, const WorldState&, std::span<const TileCoordinate>)>& show) const {
  if (moments_.empty()) return;
  WorldState state;
  state.craters = CraterSet(base.pack());
  std::size_t applied = 0;
  for (int index = 0; index < wanted_; ++index) {
    const std::size_t wanted_moments =
        std::max<std::size_t>(1, std::size_t(index + 1) * moments_.size() / std::size_t(wanted_));
    std::set<TileCoordinate> changed;
    for (; applied < wanted_moments; ++applied) {
      const Moment& moment = moments_[applied];
      state.tick = moment.tick;
      state.poses = moment.poses;
      state.previous_poses = moment.previous_poses;
      const std::size_t before = state.craters.size();
      if (moment.crater_count > before)
        state.craters.add(std::span(craters_).subspan(before, moment.crater_count - before));
      state.snowfalls.assign(snowfalls_.begin(), snowfalls_.begin() + std::ptrdiff_t(moment.snowfall_count));
      for (const auto& [at, saved] : moment.tiles) {
        Tile* tile = state.tiles.find(at);
        if (tile == nullptr) tile = &state.tiles.insert(makeTile(at, dormantGround(state, base), moment.tick));
        tile->height() = *saved.height;
        tile->ground = saved.ground;
        tile->initial = saved.initial;
        changed.insert(at);
      }
    }
    const std::vector<TileCoordinate> list(changed.begin(), changed.end());
    if (!show(index, state, list)) return;
  }
}

}  // namespace spoor
