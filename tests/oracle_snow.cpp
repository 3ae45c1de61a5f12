// Snowfall layer by layer, tick by tick, from the description in rules/snowfall.h; and the map of materials.
#include <algorithm>

#include "shaders/rules/mix.h"
#include "tests/oracle.h"

namespace spoor::test {
namespace {

constexpr int kSize = rules::kTileSize;

/// When in the fall of a layer a cell gets its unit: a share of the layer in 2^-32.
std::uint32_t orderOf(const Snowfall& snowfall, int x, int y, std::int64_t layer) {
  const rules::uint of_row =
      rules::mix32(rules::uint(y) * 0x85ebca77u + rules::mix32(rules::uint(layer) + snowfall.seed));
  return rules::mix32(rules::uint(x) * 0x9e3779b1u + of_row);
}

/// Does a tile take snow in a tick? Neighbours along x one tick earlier, along y four.
bool isBeat(TileCoordinate at, std::int32_t tick) { return (tick + at.x + 4 * at.y) % rules::kSnowBeat == 0; }

/// Slopes that rest between two cells, by the material of the higher.
std::int64_t restsUnder(const Parameters& parameters, const MaterialRules& material, bool diagonal, int cell_q) {
  switch (parameters.slopes) {
    case SlopeRule::exchange:
    case SlopeRule::flux:
      return diagonal ? material.diagonal_threshold_q : material.slope_threshold_q;
    case SlopeRule::interleaved:
    case SlopeRule::scatter:
      return material.slope_threshold_q;
    case SlopeRule::drift:
      break;
  }
  if (diagonal) return kNeverSteep;
  if (parameters.drift_weights == DriftWeights::slope) return material.slope_threshold_q;
  if (parameters.drift_weights == DriftWeights::none) return 1;
  // tan(slope) = alpha / D
  return std::int64_t(quarterArc(cell_q)) * material.repose_q16 / std::max(material.diffusion_q16, 1);
}

}  // namespace

std::int32_t oracleMaterial(const BaseTerrain& base, int x, int y) {
  const ScenePack& pack = base.pack();
  const MaterialMap& map = pack.material_map;
  if (map.kind == MaterialMapKind::image) {
    // The sample that the cell's centre lies in, or the last one.
    const auto sample = [](int cell, std::int64_t step_q32, int count) {
      return int(std::min<std::int64_t>(std::int64_t(__int128(2 * cell + 1) * step_q32 >> 33), count - 1));
    };
    return map.image.material[std::size_t(sample(y, map.image.step_y_q32, map.image.row_count)) *
                                  std::size_t(map.image.column_count) +
                              std::size_t(sample(x, map.image.step_x_q32, map.image.column_count))];
  }
  const auto height = [&](int cell_x, int cell_y) {
    return double(
        base.height(std::clamp(cell_x, 0, pack.width_cells - 1), std::clamp(cell_y, 0, pack.height_cells - 1)));
  };
  const auto over = [](int first, int last, int count) { return std::min(last, count - 1) - std::max(first, 0); };
  const double run_x = over(x - 1, x + 1, pack.width_cells), run_y = over(y - 1, y + 1, pack.height_cells);
  const double slope_x = run_x == 0 ? 0 : (height(x + 1, y) - height(x - 1, y)) / run_x;
  const double slope_y = run_y == 0 ? 0 : (height(x, y + 1) - height(x, y - 1)) / run_y;
  const double square = slope_x * slope_x + slope_y * slope_y;  // exact: far below 2^52 quarters
  for (const MaterialRule& rule : map.rules)
    if (height(x, y) >= rule.lowest_q && height(x, y) <= rule.highest_q &&
        square >= double(rule.gentlest_q) * rule.gentlest_q && square <= double(rule.steepest_q) * rule.steepest_q)
      return rule.material;
  return 0;
}

/// Lets tiles whose beat it is take what fell until now, live and dormant ones.
void Oracle::addSnow(std::int32_t tick) {
  std::ranges::fill(snowed_, std::uint8_t(0));
  for (std::size_t n = 0; n < snowfalls_.size(); ++n) {
    const Snowfall& snowfall = snowfalls_[n].record;
    const std::int64_t ticks = std::clamp<std::int64_t>(std::int64_t(tick) - snowfall.first_tick + 1, 0,
                                                        std::int64_t(snowfall.last_tick) - snowfall.first_tick + 1);
    for (int y = snowfall.area.y0; y < snowfall.area.y1; ++y)
      for (int x = snowfall.area.x0; x < snowfall.area.x1; ++x) {
        const TileCoordinate tile{x / kSize, y / kSize};
        if (!isBeat(tile, tick)) continue;
        const bool fell = snowfall.last_tick > tick - rules::kSnowBeat && snowfall.first_tick <= tick;
        if (fell && isLive(tile)) snowed_[tileIndex(tile)] = 1;
        const std::size_t i = world_.at(x, y);
        // A unit of every layer whose fall has come to this cell.
        std::int32_t& layers = snowfalls_[n].layers[i];
        while ((std::int64_t(layers) << 32) + orderOf(snowfall, x, y, layers) < ticks * snowfall.rate_q32) {
          ++layers;
          ++snow_[i];
          if (isLive(tile) && world_.height[i] < rules::kHeightLimit) ++world_.height[i], ++event_budget_;
        }
      }
  }
}

/// Is there an edge between two cells, of which one at least is a tile's, over which soil would slide? Only live tiles
/// that are asleep count.
WakeMask Oracle::unstableMask(TileCoordinate tile, const std::vector<WakeMask>& wake) const {
  const auto counts = [&](int x, int y) {
    return world_.inside(x, y) && isLive({x / kSize, y / kSize}) && wake[tileIndex({x / kSize, y / kSize})] == 0;
  };
  const auto bitOf = [&](int x, int y) { return 1 << ((y / kSize - tile.y + 1) * 3 + x / kSize - tile.x + 1); };
  int mask = 0;
  for (int y = tile.y * kSize; y < (tile.y + 1) * kSize; ++y)
    for (int x = tile.x * kSize; x < (tile.x + 1) * kSize; ++x)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          if (!counts(x, y) || !counts(x + dx, y + dy)) continue;
          const std::size_t here = world_.at(x, y), there = world_.at(x + dx, y + dy);
          const std::size_t higher = world_.height[here] > world_.height[there] ? here : there;
          const std::int64_t rests = std::max<std::int64_t>(
              restsUnder(parameters_, world_.rulesOf(parameters_, higher), dx != 0 && dy != 0, world_.cell_q), 1);
          const std::int64_t difference = std::abs(std::int64_t(world_.height[here]) - world_.height[there]);
          if (difference > rests && world_.soil(higher) > 0) mask |= bitOf(x, y) | bitOf(x + dx, y + dy);
        }
  return WakeMask(mask);
}

/// Wakes tiles that took snow asleep, and lie too steep now.
void Oracle::wakeSnowed() {
  const std::vector<WakeMask> before = wake_;
  for (int y = 0; y < extent_.y; ++y)
    for (int x = 0; x < extent_.x; ++x)
      if (snowed_[tileIndex({x, y})] != 0 && before[tileIndex({x, y})] == 0)
        wake_[tileIndex({x, y})] = unstableMask({x, y}, before);
}

}  // namespace spoor::test
