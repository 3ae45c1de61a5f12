// Where a tick's tiles come from and how they leave it, the same for every backend.
#include <algorithm>

#include "shared/base/thread_pool.h"
#include "shared/sim/backend.h"

namespace spoor {
namespace {

constexpr int kSize = rules::kTileSize;

/// The tile and those neighbours whose common border lies within `reach` cells of a changed cell.
WakeMask wakeMaskOf(const CellBox& changed, int reach) {
  if (changed.empty()) return 0;
  const bool side[3][2] = {
      {changed.x0 < reach, changed.y0 < reach}, {true, true}, {changed.x1 > kSize - reach, changed.y1 > kSize - reach}};
  WakeMask mask = 0;
  for (int bit = 0; bit < 9; ++bit)
    if (side[bit % 3][0] && side[bit / 3][1]) mask = WakeMask(mask | 1 << bit);
  return mask;
}

/// Tiles that a tile keeps active and that wait for a later tick: it goes on keeping them.
WakeMask stillWaiting(const Tile& tile, const TickPlan& plan) {
  if (plan.waiting.empty()) return 0;
  WakeMask mask = 0;
  for (int bit = 0; bit < 9; ++bit) {
    const TileCoordinate at{tile.at.x + bit % 3 - 1, tile.at.y + bit / 3 - 1};
    if ((tile.wake_mask >> bit & 1) != 0 && std::ranges::binary_search(plan.waiting, at))
      mask = WakeMask(mask | 1 << bit | kWakeSelf);
  }
  return mask;
}

}  // namespace

ActiveTiles takeTiles(const TickPlan& plan, const BaseTerrain& base, const WorldState& state, ThreadPool& pool) {
  ActiveTiles active;
  std::vector<std::size_t> missing;
  const auto met = state.tiles.meeting(base.pack(), state.craters.records().subspan(plan.first_new_crater));
  for (const TileCoordinate at : plan.active) {
    active.snowed.push_back(std::ranges::binary_search(plan.in_snow, at) ? 1 : 0);
    active.tiles.push_back(const_cast<Tile*>(state.tiles.find(at)));
    active.cratered.emplace_back();
    if (active.tiles.back() == nullptr)
      missing.push_back(active.tiles.size() - 1);
    else if (std::ranges::binary_search(met, at, {}, &Tile::at))
      active.cratered.back() = cratersWithin(at, base.pack(), state.craters, plan.first_new_crater);
  }
  DormantGround dormant = dormantGround(state, base);
  dormant.tick = plan.tick;
  active.fresh.resize(missing.size());
  pool.forEach(int(missing.size()), [&](int i, int) {
    active.fresh[i] = makeTile(plan.active[missing[i]], dormant, plan.tick);
    active.tiles[missing[i]] = active.fresh[i].get();
  });
  return active;
}

void commitCraters(Tile& tile, std::int64_t gained, std::uint64_t hash, WorldState& state) {
  state.tiles_hash -= tileStateHash(tile);
  tile.hash = hash;
  tile.ground += gained;
  state.tiles_hash += tileStateHash(tile);
  state.ledger.ground += gained;
  state.ledger.craters += gained;
}

std::vector<TileChange> commitTick(const TickPlan& plan, ActiveTiles active, std::vector<TileOutcome> outcomes,
                                   WorldState& state) {
  const int reach = std::clamp(sweepsOf(plan.parameters), 1, kSize);
  std::vector<TileChange> changes;
  auto next_fresh = active.fresh.begin();
  for (std::size_t i = 0; i < active.tiles.size(); ++i) {
    Tile& tile = *active.tiles[i];
    TileChange& change = outcomes[i].change;
    const bool is_new = next_fresh != active.fresh.end() && next_fresh->get() == &tile;
    if (is_new) state.tiles.insert(std::move(*next_fresh++));
    const bool changed = change.width > 0;
    const CellBox& cratered = active.cratered[i];
    if (!changed && !is_new && tile.wake_mask == 0 && cratered.empty()) continue;
    if (is_new) {
      state.ledger.initial += tile.initial;
      state.ledger.craters += tile.first_craters;
      state.ledger.events += tile.first_snow;
    }
    const std::uint64_t hash_before = is_new ? 0 : tileStateHash(tile);
    const std::int64_t ground_before = is_new ? 0 : tile.ground;
    const std::int64_t compacted_before = tile.compacted_sum;
    change.at = tile.at;
    change.base_version = is_new ? kDormantVersion : tile.version_tick;
    change.new_version = tile.version_tick = plan.tick;
    if (changed) {
      tile.hash = outcomes[i].hash;
      tile.ground = outcomes[i].ground;
      tile.compacted_sum = outcomes[i].compacted;
    }
    change.hash = tile.hash;
    const CellBox box{change.x, change.y, change.x + change.width, change.y + change.height};
    change.wake_mask = WakeMask(wakeMaskOf(box, reach) | wakeMaskOf(cratered, reach) | stillWaiting(tile, plan));
    state.tiles.setWake(tile, change.wake_mask);
    state.tiles_hash += tileStateHash(tile) - hash_before;
    state.ledger.ground += tile.ground - ground_before;
    state.ledger.compacted += tile.compacted_sum - compacted_before;
    changes.push_back(std::move(change));
  }
  return changes;
}

}  // namespace spoor
