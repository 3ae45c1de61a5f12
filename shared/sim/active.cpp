// Stage active: the tiles and bodies of a tick, from nothing but state and input.
#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <set>

#include "shared/base/fixed.h"
#include "shared/sim/plan.h"

namespace spoor {
namespace {

/// A box of the world with `margin` cells more on every side.
CellBox grown(const CellBox& box, int margin, const ScenePack& pack) {
  if (box.empty()) return {};
  return {std::max(box.x0 - margin, 0), std::max(box.y0 - margin, 0), std::min(box.x1 + margin, pack.width_cells),
          std::min(box.y1 + margin, pack.height_cells)};
}

/// How many sub-steps keep every part of a body within one cell of its place a sub-step before: its own shift, and its
/// reach times the angle it turns by and the share it grows by. Spin is left out: the rim of a rolling wheel rests
/// where it touches the ground.
int subStepsFor(std::int32_t cell_q, std::int32_t reach_q, const Pose& from, const Pose& to) {
  constexpr std::int64_t kRadiansPerTurnQ32 = 411775;  // 2 pi / 65536
  const auto angle = [](Turn a, Turn b) { return std::abs(std::int64_t(std::int16_t(std::uint16_t(b - a)))); };
  const std::int64_t turned = angle(from.yaw, to.yaw) + angle(from.pitch, to.pitch) + angle(from.roll, to.roll);
  const std::int64_t shift =
      std::max(std::abs(std::int64_t(to.x_q) - from.x_q), std::abs(std::int64_t(to.y_q) - from.y_q));
  const std::int64_t grown = std::abs(std::int64_t(to.scale_q16) - from.scale_q16);
  const std::int64_t farthest = shift + ((reach_q * turned * kRadiansPerTurnQ32) >> 32) + (reach_q * grown >> 16);
  return int(std::clamp<std::int64_t>(-floorDiv(-farthest, cell_q), 1, kSubStepLimit + 1));
}

void addTiles(const CellBox& box, std::set<TileCoordinate>& tiles) {
  if (box.empty()) return;
  for (int y = box.y0 / rules::kTileSize; y <= (box.y1 - 1) / rules::kTileSize; ++y)
    for (int x = box.x0 / rules::kTileSize; x <= (box.x1 - 1) / rules::kTileSize; ++x) tiles.insert({x, y});
}

bool meetsTiles(const CellBox& box, const std::set<TileCoordinate>& tiles) {
  if (box.empty()) return false;
  for (int y = box.y0 / rules::kTileSize; y <= (box.y1 - 1) / rules::kTileSize; ++y) {
    const auto first = tiles.lower_bound({box.x0 / rules::kTileSize, y});
    if (first != tiles.end() && first->y == y && first->x <= (box.x1 - 1) / rules::kTileSize) return true;
  }
  return false;
}

void addWoken(const ScenePack& pack, const WorldState& state, std::set<TileCoordinate>& tiles) {
  const TileCoordinate extent = tileExtent(pack);
  for (const Tile* tile : state.tiles.awake())
    for (int bit = 0; bit < 9; ++bit) {
      const TileCoordinate at{tile->at.x + bit % 3 - 1, tile->at.y + bit / 3 - 1};
      const bool inside = at.x >= 0 && at.y >= 0 && at.x < extent.x && at.y < extent.y;
      if (inside && (tile->wake_mask >> bit & 1) != 0) tiles.insert(at);
    }
}

/// Joins boxes that touch until all are apart: between two domains lies at least the ring of one of them.
Result<std::vector<Domain>> joinedDomains(const std::vector<CellBox>& boxes) {
  std::vector<Domain> domains;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    Domain joined{boxes[i], {int(i)}};
    if (joined.box.empty()) continue;
    for (auto other = domains.begin(); other != domains.end();) {
      if (!other->box.meets(joined.box)) {
        ++other;
        continue;
      }
      joined.box = {std::min(joined.box.x0, other->box.x0), std::min(joined.box.y0, other->box.y0),
                    std::max(joined.box.x1, other->box.x1), std::max(joined.box.y1, other->box.y1)};
      joined.bodies.insert(joined.bodies.end(), other->bodies.begin(), other->bodies.end());
      domains.erase(other);
      other = domains.begin();  // the larger box may meet what the smaller did not
    }
    const std::int64_t width = joined.box.x1 - joined.box.x0, height = joined.box.y1 - joined.box.y0;
    if (width > kDomainSideLimit || height > kDomainSideLimit || width * height > kDomainCellsLimit)
      return Error{std::to_string(joined.bodies.size()) + " touching bodies make a search domain of " +
                   std::to_string(width) + " x " + std::to_string(height) + " cells, the limit is " +
                   std::to_string(kDomainCellsLimit) + " cells, " + std::to_string(kDomainSideLimit) + " a side"};
    domains.push_back(std::move(joined));
  }
  std::ranges::sort(domains, [](const Domain& a, const Domain& b) {
    return a.box.y0 != b.box.y0 ? a.box.y0 < b.box.y0 : a.box.x0 < b.box.x0;
  });
  return domains;
}

/// A tick in the making.
class Planner {
 public:
  Planner(const ScenePack& pack, std::span<const std::int32_t> reach_q, const WorldState& state,
          std::span<const Pose> poses, const Parameters& parameters, std::span<const Crater> craters,
          std::size_t tile_limit)
      : pack_(pack),
        parameters_(parameters),
        reach_q_(reach_q),
        state_(state),
        poses_(poses),
        craters_(craters),
        tile_limit_(tile_limit),
        // A straight walk out of a body's box passes a free cell of the ring around it.
        search_margin_(1 + (parameters.displacement == Displacement::spread ? parameters.spread_cells : 0)),
        placed_(poses.size()) {}

  Result<TickPlan> plan() {
    TickPlan plan;
    plan.tick = state_.tick + 1;
    plan.parameters = parameters_;
    plan.first_new_crater = state_.craters.size();
    if (parameters_.active_areas == 0)
      addTiles(wholeWorld(), tiles_);
    else
      addWoken(pack_, state_, tiles_);
    for (const Tile* tile : state_.tiles.meeting(pack_, craters_)) tiles_.insert(tile->at);
    placeMoving(plan);
    if (tiles_.empty()) return plan;
    std::vector<std::vector<Domain>> domains;
    // A joined domain may reach tiles that none of its bodies does, and there wake bodies at rest, whose domains join
    // ...
    do {
      auto joined = joinAllSteps();
      if (!joined) return Error{joined.error()};
      domains = std::move(*joined);
    } while (placeResting());
    if (tooMany())
      if (Status status = letTilesWait(plan, domains); !status) return Error{status.error()};
    plan.active.assign(tiles_.begin(), tiles_.end());
    for (int step = 0; step < step_count_; ++step)
      plan.sub_steps.push_back(takeSubStep(step, std::move(domains[std::size_t(step)])));
    return plan;
  }

 private:
  CellBox wholeWorld() const { return {0, 0, pack_.width_cells, pack_.height_cells}; }
  int activeMargin() const { return search_margin_ + parameters_.active_margin_cells; }
  CellBox activeBox(const PlacedBody& body) const { return grown(body.box, activeMargin(), pack_); }

  /// More tiles than a tick may simulate, or a world may have live?
  bool tooMany() const {
    return tiles_.size() > tile_limit_ || state_.tiles.size() + tiles_.size() > kSnapshotTilesLimit;
  }

  /// Takes tiles out that are only awake until the rest is within the limits; each tick begins with others. They stay
  /// awake (commitTick).
  Status letTilesWait(TickPlan& plan, const std::vector<std::vector<Domain>>& domains) {
    std::set<TileCoordinate> chosen;
    for (const Tile* tile : state_.tiles.meeting(pack_, craters_)) chosen.insert(tile->at);
    for (const PlacedBody& body : plan.stood.bodies) addTiles(activeBox(body), chosen);
    for (std::size_t i = 0; i < poses_.size(); ++i)
      if (moves(i))
        for (const PlacedBody& body : placed_[i]) addTiles(activeBox(body), chosen);
    for (const std::vector<Domain>& of_step : domains)
      for (const Domain& domain : of_step) addTiles(domain.box, chosen);
    if (parameters_.active_areas == 0) chosen = tiles_;
    const auto isDormant = [this](TileCoordinate at) { return state_.tiles.find(at) == nullptr; };
    std::size_t live = state_.tiles.size() + std::size_t(std::ranges::count_if(chosen, isDormant));
    if (chosen.size() > tile_limit_ || live > kSnapshotTilesLimit)
      return Error{"bodies and craters meet " + std::to_string(chosen.size()) + " tiles and leave " +
                   std::to_string(live) + " live, the limits are " + std::to_string(tile_limit_) + " and " +
                   std::to_string(kSnapshotTilesLimit)};
    std::vector<TileCoordinate> awake;
    std::ranges::set_difference(tiles_, chosen, std::back_inserter(awake));
    const std::size_t first = awake.empty() ? 0 : std::size_t(plan.tick) * (tile_limit_ - chosen.size()) % awake.size();
    for (std::size_t i = 0; i < awake.size() && chosen.size() < tile_limit_; ++i) {
      const TileCoordinate at = awake[(first + i) % awake.size()];
      if (isDormant(at) && live++ >= kSnapshotTilesLimit) continue;
      chosen.insert(at);
    }
    std::ranges::set_difference(tiles_, chosen, std::back_inserter(plan.waiting));
    tiles_ = std::move(chosen);
    return {};
  }

  /// A body that does not move acts only where something else woke the ground; in the first tick all press.
  bool moves(std::size_t body) const { return state_.tick == 0 || poses_[body] != state_.poses[body]; }

  void placeMoving(TickPlan& plan) {
    for (std::size_t i = 0; i < poses_.size(); ++i)
      if (moves(i))
        step_count_ = std::max(step_count_, subStepsFor(pack_.cell_q, reach_q_[i], state_.poses[i], poses_[i]));
    plan.too_fast = step_count_ > kSubStepLimit;
    step_count_ = std::min(step_count_, kSubStepLimit);
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      if (!moves(i)) continue;
      // Where it stood, soil that it held up may fall now.
      addStood(plan.stood, placeBody(pack_, int(i), state_.poses[i]));
      Pose before = state_.poses[i];
      for (int step = 1; step <= step_count_; ++step) {
        const Pose pose = interpolate(state_.poses[i], poses_[i], step, step_count_);
        placed_[i].push_back(placeBody(pack_, int(i), pose));
        aimPush(placed_[i].back(), before, pose);
        before = pose;
      }
      for (const PlacedBody& body : placed_[i]) addTiles(activeBox(body), tiles_);
      taking_part_.push_back(i);
    }
  }

  void aimPush(PlacedBody& body, const Pose& from, const Pose& to) const {
    const std::int64_t x = std::int64_t(to.x_q) - from.x_q, y = std::int64_t(to.y_q) - from.y_q;
    const std::int64_t length = isqrt(std::uint64_t(x * x) + std::uint64_t(y * y));
    if (length == 0) return;
    body.force_cell = std::int64_t(pack_.bodies[std::size_t(body.body_index)].force_n) * pack_.cell_q;
    const auto inQ30 = [length](std::int64_t part) {
      return std::int32_t(std::clamp<std::int64_t>(floorDiv(part << 30, length), -(1 << 30), 1 << 30));
    };
    body.direction_x_q30 = inQ30(x);
    body.direction_y_q30 = inQ30(y);
  }

  void addStood(SubStep& stood, PlacedBody body) {
    addTiles(activeBox(body), tiles_);
    if (body.box.empty()) return;
    stood.domains.push_back({body.box, {int(stood.bodies.size())}});
    stood.bodies.push_back(std::move(body));
  }

  /// Adds bodies at rest that meet active tiles; returns whether there were any.
  bool placeResting() {
    const std::size_t before = taking_part_.size();
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      if (!placed_[i].empty() || !meetsTiles(roughBox(i), tiles_)) continue;
      PlacedBody body = placeBody(pack_, int(i), poses_[i]);
      if (!meetsTiles(activeBox(body), tiles_)) continue;
      placed_[i].push_back(std::move(body));
      taking_part_.push_back(i);
    }
    return taking_part_.size() > before;
  }

  /// A box that holds a body however it is turned, found without looking at its mesh.
  CellBox roughBox(std::size_t body) const {
    const auto cellOf = [this](std::int64_t at_q, std::int32_t limit) {
      return std::int32_t(std::clamp<std::int64_t>(floorDiv(at_q, pack_.cell_q), 0, limit));
    };
    const Pose& pose = poses_[body];
    const std::int64_t reach = reach_q_[body] + std::int64_t(1 + activeMargin()) * pack_.cell_q;
    return {cellOf(pose.x_q - reach, pack_.width_cells), cellOf(pose.y_q - reach, pack_.height_cells),
            cellOf(pose.x_q + reach + pack_.cell_q, pack_.width_cells),
            cellOf(pose.y_q + reach + pack_.cell_q, pack_.height_cells)};
  }

  const PlacedBody& placedAt(std::size_t body, int step) const {
    return placed_[body].size() == 1 ? placed_[body].front() : placed_[body][std::size_t(step)];
  }

  Result<std::vector<std::vector<Domain>>> joinAllSteps() {
    std::ranges::sort(taking_part_);
    std::vector<std::vector<Domain>> domains;
    for (int step = 0; step < step_count_; ++step) {
      std::vector<CellBox> boxes;
      for (const std::size_t body : taking_part_) {
        const CellBox box = grown(placedAt(body, step).box, search_margin_, pack_);
        boxes.push_back(parameters_.active_areas == 0 && !box.empty() ? wholeWorld() : box);
      }
      auto joined = joinedDomains(boxes);
      if (!joined) return Error{joined.error()};
      for (const Domain& domain : *joined) addTiles(domain.box, tiles_);
      domains.push_back(std::move(*joined));
    }
    return domains;
  }

  SubStep takeSubStep(int step, std::vector<Domain> domains) {
    SubStep sub_step;
    for (const std::size_t body : taking_part_)
      sub_step.bodies.push_back(placed_[body].size() == 1 ? placed_[body].front()
                                                          : std::move(placed_[body][std::size_t(step)]));
    sub_step.domains = std::move(domains);
    const int sweeps = sweepsOf(parameters_);
    sub_step.sweep_count = (step + 1) * sweeps / step_count_ - step * sweeps / step_count_;
    return sub_step;
  }

  const ScenePack& pack_;
  const Parameters& parameters_;
  std::span<const std::int32_t> reach_q_;
  const WorldState& state_;
  std::span<const Pose> poses_;
  std::span<const Crater> craters_;
  std::size_t tile_limit_;
  int search_margin_;
  std::set<TileCoordinate> tiles_;
  int step_count_ = 1;
  std::vector<std::vector<PlacedBody>> placed_;  // [bodies][1, or one for each sub-step]; empty: takes no part
  std::vector<std::size_t> taking_part_;         // bodies, in the pack's order
};

}  // namespace

std::vector<std::int32_t> bodyReaches(const ScenePack& pack) {
  std::vector<std::int32_t> mesh_reach;
  for (const Mesh& mesh : pack.meshes) {
    std::uint64_t farthest = 0;
    for (const auto& vertex : mesh.vertices) {
      std::uint64_t square = 0;
      for (const std::int64_t coordinate : vertex) square += std::uint64_t(coordinate * coordinate);
      farthest = std::max(farthest, square);
    }
    mesh_reach.push_back(std::int32_t(isqrt(farthest) + 1));
  }
  std::vector<std::int32_t> result;
  for (const Body& body : pack.bodies) result.push_back(mesh_reach[std::size_t(body.mesh_index)]);
  return result;
}

Result<TickPlan> planTick(const ScenePack& pack, std::span<const std::int32_t> reach_q, const WorldState& state,
                          std::span<const Pose> poses, const Parameters& parameters, std::span<const Crater> craters,
                          std::size_t tile_limit) {
  return Planner(pack, reach_q, state, poses, parameters, craters, tile_limit).plan();
}

}  // namespace spoor
