#include "shared/world/dormant_ground.h"

#include <vector>

namespace spoor {

void DormantGround::fillArea(std::int32_t x, std::int32_t y, std::int32_t stride, std::int32_t columns,
                             std::int32_t rows, std::span<std::int32_t> height) const {
  base->fillArea(x, y, stride, columns, rows, height);
  std::vector<std::int32_t> displacement;
  if (craters != nullptr && craters->size() > 0) {
    displacement.resize(height.size());
    craters->fill(x, y, stride, columns, rows, displacement);
    const std::int32_t soil = base->pack().soil_depth_q;
    for (std::size_t i = 0; i < height.size(); ++i)
      if (displacement[i] != 0) height[i] = rules::craterGround(height[i], height[i] - soil, displacement[i]);
  }
  if (snowfalls.empty()) return;
  displacement.resize(height.size());
  fillSnow(base->pack(), snowfalls, tick, x, y, stride, columns, rows, displacement);
  for (std::size_t i = 0; i < height.size(); ++i) height[i] = rules::snowGround(height[i], height[i], displacement[i]);
}

void DormantGround::fillHeights(TileCoordinate tile, std::span<std::int32_t, rules::kTileCells> height) const {
  fillArea(tile.x * rules::kTileSize, tile.y * rules::kTileSize, 1, rules::kTileSize, rules::kTileSize, height);
}

std::int32_t DormantGround::height(std::int32_t x, std::int32_t y) const {
  std::int32_t result;
  fillArea(x, y, 1, 1, 1, {&result, 1});
  return result;
}

}  // namespace spoor
