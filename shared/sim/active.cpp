// Stage active: the tiles and bodies of a tick, from nothing but state and input.
#include <algorithm>
#include <set>

#include "shared/base/fixed.h"
#include "shared/sim/plan.h"

namespace spoor {
namespace {

CellBox grown(const CellBox& box, const ScenePack& pack) {
  if (box.empty()) return {};
  return {std::max(box.x0 - 1, 0), std::max(box.y0 - 1, 0), std::min(box.x1 + 1, pack.width_cells),
          std::min(box.y1 + 1, pack.height_cells)};
}

/// How many sub-steps keep every part of a body within one cell of its place a sub-step before. Spin is left out: the
/// rim of a rolling wheel rests where it touches the ground.
int subStepsFor(const ScenePack& pack, int body_index, Pose from, Pose to) {
  from.spin = to.spin = 0;
  const Mesh& mesh = pack.meshes[std::size_t(pack.bodies[std::size_t(body_index)].mesh_index)];
  const Rotation rotation_from = rotationOf(from), rotation_to = rotationOf(to);
  std::int64_t farthest = 0;
  for (const auto& vertex : mesh.vertices) {
    const auto a = rotate(rotation_from, vertex), b = rotate(rotation_to, vertex);
    for (int axis = 0; axis < 2; ++axis) {
      const std::int64_t shift = axis == 0 ? std::int64_t(to.x_q) - from.x_q : std::int64_t(to.y_q) - from.y_q;
      const std::int64_t moved = shift + b[axis] - a[axis];
      farthest = std::max(farthest, moved < 0 ? -moved : moved);
    }
  }
  return int(std::min<std::int64_t>(-floorDiv(-farthest, pack.cell_q), kSubStepLimit + 1));
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
std::vector<Domain> joinedDomains(const ScenePack& pack, const std::vector<PlacedBody>& bodies) {
  std::vector<Domain> domains;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    Domain joined{grown(bodies[i].box, pack), {int(i)}};
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
    domains.push_back(std::move(joined));
  }
  std::ranges::sort(domains, [](const Domain& a, const Domain& b) {
    return a.box.y0 != b.box.y0 ? a.box.y0 < b.box.y0 : a.box.x0 < b.box.x0;
  });
  return domains;
}

}  // namespace

TickPlan planTick(const ScenePack& pack, const WorldState& state, std::span<const Pose> poses) {
  TickPlan plan;
  plan.tick = state.tick + 1;
  const int body_count = int(poses.size());
  // A body that does not move acts only where something else woke the ground; in the first tick all press.
  std::vector<bool> takes_part(poses.size());
  int steps = 1;
  for (int i = 0; i < body_count; ++i) {
    takes_part[i] = state.tick == 0 || poses[i] != state.poses[i];
    if (takes_part[i]) steps = std::max(steps, subStepsFor(pack, i, state.poses[i], poses[i]));
  }
  plan.too_fast = steps > kSubStepLimit;
  steps = std::min(steps, kSubStepLimit);

  std::set<TileCoordinate> tiles;
  addWoken(pack, state, tiles);
  std::vector<std::vector<PlacedBody>> placed(poses.size());
  for (int i = 0; i < body_count; ++i) {
    if (!takes_part[i]) continue;
    // Where it stood, soil that it held up may fall now.
    addTiles(grown(placeBody(pack, i, state.poses[i]).box, pack), tiles);
    for (int step = 1; step <= steps; ++step) {
      placed[i].push_back(placeBody(pack, i, interpolate(state.poses[i], poses[i], step, steps)));
      addTiles(grown(placed[i].back().box, pack), tiles);
    }
  }
  if (tiles.empty()) return plan;
  for (int i = 0; i < body_count; ++i)
    if (!takes_part[i]) placed[i].push_back(placeBody(pack, i, poses[i]));
  // A joined domain may reach tiles that none of its bodies does, and there wake bodies at rest, whose domains join ...
  for (bool grew = true; grew;) {
    plan.sub_steps.clear();
    for (int step = 0; step < steps; ++step) {
      SubStep sub_step;
      for (int i = 0; i < body_count; ++i)
        if (takes_part[i]) sub_step.bodies.push_back(placed[i][placed[i].size() == 1 ? 0 : std::size_t(step)]);
      sub_step.domains = joinedDomains(pack, sub_step.bodies);
      sub_step.sweep_count = (step + 1) * pack.sweeps_per_tick / steps - step * pack.sweeps_per_tick / steps;
      for (const Domain& domain : sub_step.domains) addTiles(domain.box, tiles);
      plan.sub_steps.push_back(std::move(sub_step));
    }
    grew = false;
    for (int i = 0; i < body_count; ++i) {
      if (takes_part[i] || !meetsTiles(grown(placed[i].back().box, pack), tiles)) continue;
      takes_part[i] = grew = true;
    }
  }
  plan.active.assign(tiles.begin(), tiles.end());
  return plan;
}

}  // namespace spoor
