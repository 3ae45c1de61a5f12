#include "shared/world/tile_snow.h"

#include <algorithm>

#include "shaders/rules/exchange.h"
#include "shared/base/kernels.h"

namespace spoor {
namespace {

constexpr int kSize = rules::kTileSize;
constexpr int kSide = kSize + 2;

/// A tile's cells and one more on every side. Cells that do not matter have no soil and take none.
struct Surroundings {
  std::array<std::int32_t, kSide * kSide> height{}, bedrock{}, underside, side{}, diagonal{};

  Surroundings() { underside.fill(-rules::kHeightLimit); }
  ExchangeCells cellsAt(std::size_t i, bool is_diagonal, std::int32_t* heights) const {
    return {heights, &bedrock[i], &underside[i], is_diagonal ? &diagonal[i] : &side[i]};
  }
};

/// Height differences that rest, by the material of the higher cell.
struct Thresholds {
  std::int32_t side = 0, diagonal = 0;
};

Thresholds thresholdsOf(const Parameters& parameters, const MaterialRules& material, std::int32_t cell_q) {
  switch (parameters.slopes) {
    case SlopeRule::exchange:
    case SlopeRule::flux:
      return {material.slope_threshold_q, material.diagonal_threshold_q};
    case SlopeRule::interleaved:
    case SlopeRule::scatter:
      return {material.slope_threshold_q, material.slope_threshold_q};
    case SlopeRule::drift:
      break;
  }
  if (parameters.drift_weights == DriftWeights::slope) return {material.slope_threshold_q, kNeverSteep};
  if (parameters.drift_weights == DriftWeights::none) return {0, kNeverSteep};
  const std::int64_t arc_q = std::int64_t(quarterArc(cell_q)) * material.repose_q16;
  const std::int64_t rests = arc_q / std::max(material.diffusion_q16, 1);
  return {std::int32_t(std::min<std::int64_t>(rests, kNeverSteep)), kNeverSteep};
}

void addCells(const Tile& tile, int dx, int dy, const ScenePack& pack, const std::vector<Thresholds>& thresholds,
              Surroundings& around) {
  for (int y = std::max(-1, dy * kSize); y < std::min(kSize + 1, (dy + 1) * kSize); ++y)
    for (int x = std::max(-1, dx * kSize); x < std::min(kSize + 1, (dx + 1) * kSize); ++x) {
      const int column = x - dx * kSize, row = y - dy * kSize;
      if (tile.at.x * kSize + column >= pack.width_cells || tile.at.y * kSize + row >= pack.height_cells) continue;
      const auto from = std::size_t(row * kSize + column);
      const auto to = std::size_t((y + 1) * kSide + x + 1);
      const Thresholds& own = thresholds[tile.material() == nullptr ? 0 : std::size_t((*tile.material())[from])];
      around.height[to] = tile.height()[from];
      around.bedrock[to] = (*tile.bedrock)[from];
      around.underside[to] = rules::kNoUnderside;
      around.side[to] = rules::exchangeThreshold(own.side);
      around.diagonal[to] = rules::exchangeThreshold(own.diagonal);
    }
}

/// Does soil flow over any of the `count` edges from cells in a row, the first at `a`, to those from `b` on?
bool flows(const Surroundings& around, std::size_t a, std::size_t b, int count, bool is_diagonal) {
  std::int32_t height_a[kSide], height_b[kSide];
  std::copy_n(&around.height[a], count, height_a);
  std::copy_n(&around.height[b], count, height_b);
  return kernels().exchangeRows(around.cellsAt(a, is_diagonal, height_a), around.cellsAt(b, is_diagonal, height_b),
                                count, {1, 0});
}

int tileOf(int cell) { return cell < 0 ? -1 : cell < kSize ? 0 : 1; }
WakeMask bitOf(int dx, int dy) { return WakeMask(1 << ((dy + 1) * 3 + dx + 1)); }

/// The tile and its neighbours that have an end of an edge over which soil would flow; 0: all rests.
WakeMask unstable(const Surroundings& around) {
  constexpr int kSteps[4][2] = {{1, 0}, {0, 1}, {1, 1}, {-1, 1}};
  WakeMask mask = 0;
  for (int y = -1; y < kSize; ++y)
    for (const auto& [dx, dy] : kSteps) {
      const bool is_diagonal = dx != 0 && dy != 0;
      const int first = dx < 0 ? 0 : -1, count = kSide - std::abs(dx);
      const auto a = std::size_t((y + 1) * kSide + first + 1);
      const auto b = std::size_t(int(a) + dy * kSide + dx);
      if (!flows(around, a, b, count, is_diagonal)) continue;
      for (int i = 0; i < count; ++i) {
        const WakeMask ends =
            WakeMask(bitOf(tileOf(first + i), tileOf(y)) | bitOf(tileOf(first + i + dx), tileOf(y + dy)));
        if ((ends & kWakeSelf) != 0 && flows(around, a + std::size_t(i), b + std::size_t(i), 1, is_diagonal))
          mask = WakeMask(mask | ends);
      }
    }
  return mask;
}

void setWake(Tile& tile, WakeMask mask, WorldState& state) {
  state.tiles_hash -= tileStateHash(tile);
  state.tiles.setWake(tile, mask);
  state.tiles_hash += tileStateHash(tile);
}

/// Tiles that are all asleep and have their snow.
void wakeUnstable(std::span<Tile* const> tiles, const ScenePack& pack, WorldState& state) {
  std::vector<Thresholds> thresholds;
  for (const MaterialRules& material : state.parameters.materials)
    thresholds.push_back(thresholdsOf(state.parameters, material, pack.cell_q));
  std::vector<WakeMask> masks;
  for (const Tile* tile : tiles) {
    Surroundings around;
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        const Tile* near = state.tiles.find({tile->at.x + dx, tile->at.y + dy});
        if (near != nullptr && near->wake_mask == 0) addCells(*near, dx, dy, pack, thresholds, around);
      }
    masks.push_back(unstable(around));
  }
  for (std::size_t i = 0; i < tiles.size(); ++i) setWake(*tiles[i], masks[i], state);
}

}  // namespace

std::vector<Tile*> tilesInSnow(const WorldState& state, std::int32_t tick, SnowTiles which) {
  std::vector<Tile*> tiles;
  if (state.snowfalls.empty()) return tiles;
  for (Tile* tile : state.tiles.atBeat(tick))
    if ((which == SnowTiles::all || (tile->wake_mask == 0) == (which == SnowTiles::asleep)) &&
        snowDue(tile->at, state.snowfalls, tick))
      tiles.push_back(tile);
  std::ranges::sort(tiles, {}, &Tile::at);
  return tiles;
}

void snowOnTile(Tile& tile, const ScenePack& pack, std::int32_t tick, WorldState& state) {
  const std::int64_t gained = addSnow(pack, tile.at, state.snowfalls, tick, tile.height());
  if (gained != 0) commitSnow(tile, gained, tileHash(tile), state);
}

void commitSnow(Tile& tile, std::int64_t gained, std::uint64_t hash, WorldState& state) {
  state.tiles_hash -= tileStateHash(tile);
  tile.hash = hash;
  tile.ground += gained;
  state.tiles_hash += tileStateHash(tile);
  state.ledger.ground += gained;
  state.ledger.events += gained;
}

SnowOfTick::SnowOfTick(WorldState& state, const ScenePack& pack, std::int32_t tick, SnowTiles which) {
  std::vector<Tile*> asleep;
  for (Tile* tile : tilesInSnow(state, tick, which)) {
    before_.push_back({tile, tile->height(), tile->hash, tile->ground, tile->wake_mask});
    snowOnTile(*tile, pack, tick, state);
    if (tile->wake_mask == 0) asleep.push_back(tile);
  }
  wakeUnstable(asleep, pack, state);
}

std::vector<Tile*> SnowOfTick::tiles() const {
  std::vector<Tile*> tiles;
  for (const Before& before : before_) tiles.push_back(before.tile);
  return tiles;
}

void SnowOfTick::takeBack(WorldState& state) {
  for (const Before& before : before_) {
    Tile& tile = *before.tile;
    commitSnow(tile, before.ground - tile.ground, before.hash, state);
    tile.height() = before.height;
    setWake(tile, before.wake_mask, state);
  }
}

}  // namespace spoor
