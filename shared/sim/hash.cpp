// Stage hash: what the tick changed goes back to the tiles, with their hashes, sums and wake masks.
#include <algorithm>
#include <cstring>
#include <optional>

#include "shared/sim/native_stages.h"

namespace spoor {
namespace {

constexpr int kSize = rules::kTileSize;

/// The tile and those neighbours whose common border lies within `reach` cells of a changed cell.
WakeMask wakeMaskOf(const TileChange& change, int reach) {
  if (change.width == 0) return 0;
  const bool side[3][2] = {{change.x < reach, change.y < reach},
                           {true, true},
                           {change.x + change.width > kSize - reach, change.y + change.height > kSize - reach}};
  WakeMask mask = 0;
  for (int bit = 0; bit < 9; ++bit)
    if (side[bit % 3][0] && side[bit / 3][1]) mask = WakeMask(mask | 1 << bit);
  return mask;
}

/// Copies the area's cells to the tile; false where none changed. `before` then holds the old cells.
bool fetchCells(const WorkArea& area, const Run& run, Tile& tile, PlaneCells& before) {
  const std::size_t column = std::size_t(tile.at.x - run.first.x) * kSize;
  const auto rowOf = [&](int row) { return area.height.data() + run.rowOffset(row) + column; };
  int row = 0;
  while (row < kSize && std::memcmp(rowOf(row), tile.height().data() + row * kSize, kSize * sizeof(std::int32_t)) == 0)
    ++row;
  if (row == kSize) return false;
  before = tile.height();
  for (; row < kSize; ++row) std::memcpy(tile.height().data() + row * kSize, rowOf(row), kSize * sizeof(std::int32_t));
  return true;
}

}  // namespace

std::vector<TileChange> runHash(const NativeContext& context, const TickPlan& plan, const std::vector<Tile*>& made_live,
                                WorldState& state) {
  struct Outcome {
    std::optional<TileChange> change;
    WakeMask wake_mask = 0;
    std::uint64_t hash_before = 0;
    std::int64_t ground_before = 0;
  };
  WorkArea& area = context.area;
  std::vector<Outcome> outcomes(area.tiles.size());
  const int reach = std::clamp(context.pack.sweeps_per_tick, 1, kSize);
  context.pool.forEach(int(area.tiles.size()), [&](int i, int) {
    Tile& tile = *area.tiles[i];
    Outcome& outcome = outcomes[i];
    const bool is_new = std::binary_search(made_live.begin(), made_live.end(), &tile,
                                           [](const Tile* a, const Tile* b) { return a->at < b->at; });
    outcome.hash_before = is_new ? 0 : tileStateHash(tile);
    outcome.ground_before = is_new ? 0 : tile.ground;
    const std::int32_t base_version = is_new ? kDormantVersion : tile.version_tick;
    PlaneCells before;
    const bool changed = fetchCells(area, area.runs[area.run_of_tile[i]], tile, before);
    if (!changed && !is_new && tile.wake_mask == 0) return;
    tile.version_tick = plan.tick;
    if (changed) {
      tile.hash =
          context.kernels.hashTile(tile.height().data(), tile.at.x * kSize, tile.at.y * kSize, int(Plane::height));
      tile.ground = context.kernels.sum(tile.height().data(), rules::kTileCells);
    }
    outcome.change = differenceOf(tile, changed ? before : tile.height(), base_version);
    outcome.wake_mask = wakeMaskOf(*outcome.change, reach);
    outcome.change->wake_mask = outcome.wake_mask;
  });

  std::vector<TileChange> changes;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    if (!outcomes[i].change) continue;
    Tile& tile = *area.tiles[i];
    state.tiles.setWake(tile, outcomes[i].wake_mask);
    state.tiles_hash += tileStateHash(tile) - outcomes[i].hash_before;
    state.ledger.ground += tile.ground - outcomes[i].ground_before;
    if (outcomes[i].change->base_version == kDormantVersion) state.ledger.initial += tile.initial;
    changes.push_back(std::move(*outcomes[i].change));
  }
  return changes;
}

}  // namespace spoor
