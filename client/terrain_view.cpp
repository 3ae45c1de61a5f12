#include "client/terrain_view.h"

#include <algorithm>

#include "shaders/render/frame.h"
#include "shared/base/assert.h"

namespace spoor {

namespace {

/// A coordinate brought into 0 .. size - 1 by mirroring at both borders.
std::int32_t mirrored(std::int32_t at, std::int32_t size) {
  const std::int64_t period = std::int64_t(2) * size;
  std::int64_t rest = at % period;
  if (rest < 0) rest += period;
  return std::int32_t(rest < size ? rest : period - 1 - rest);
}

void fillBase(const BaseTerrain& base, glm::ivec2 first_cell, int stride, glm::ivec2 count,
              std::span<std::int32_t> out) {
  const glm::ivec2 last = first_cell + (count - 1) * stride;
  const glm::ivec2 size(base.pack().width_cells, base.pack().height_cells);
  if (first_cell.x >= 0 && first_cell.y >= 0 && last.x < size.x && last.y < size.y) {
    base.fillArea(first_cell.x, first_cell.y, stride, count.x, count.y, out);
    return;
  }
  for (int y = 0; y < count.y; ++y)
    for (int x = 0; x < count.x; ++x)
      out[std::size_t(y * count.x + x)] =
          base.height(mirrored(first_cell.x + x * stride, size.x), mirrored(first_cell.y + y * stride, size.y));
}

/// Mean of what a block of a tile's cells gained since the tile was dormant; cells outside the world do not count.
std::int32_t meanGain(const Tile& tile, const ScenePack& pack, glm::ivec2 first, int side) {
  const glm::ivec2 inside(pack.width_cells - tile.at.x * rules::kTileSize,
                          pack.height_cells - tile.at.y * rules::kTileSize);
  const glm::ivec2 end = glm::min(first + side, inside);
  if (end.x <= first.x || end.y <= first.y) return 0;
  std::int64_t sum = 0;
  for (int y = first.y; y < end.y; ++y) {
    for (int x = first.x; x < end.x; ++x) {
      const auto i = std::size_t(y * rules::kTileSize + x);
      sum += std::int64_t(tile.height()[i]) - (*tile.bedrock)[i] - pack.soil_depth_q;
    }
  }
  return std::int32_t(sum / ((end.x - first.x) * (end.y - first.y)));
}

/// Copies a live tile's cells over the base's; what lies outside the world keeps mirroring.
void copyTile(const Tile& tile, const ScenePack& pack, std::span<std::int32_t> out, int row_samples) {
  const glm::ivec2 inside(pack.width_cells - tile.at.x * rules::kTileSize,
                          pack.height_cells - tile.at.y * rules::kTileSize);
  const glm::ivec2 end = glm::min(inside, glm::ivec2(rules::kTileSize));
  for (int y = 0; y < end.y; ++y)
    std::copy_n(tile.height().begin() + y * rules::kTileSize, end.x, out.begin() + y * row_samples);
}

}  // namespace

void fillSamples(const TerrainView& view, int level, const SampleBox& box, std::span<std::int32_t> height_q) {
  SPOOR_ASSERT(height_q.size() == std::size_t(box.count.x) * std::size_t(box.count.y));
  const int shift = level * render::kLevelShift;
  const int stride = 1 << shift;
  const int middle = level == 0 ? 0 : stride / 2;
  fillBase(*view.base, box.first * stride + middle, stride, box.count, height_q);
  if (stride > rules::kTileSize) return;

  const int side = rules::kTileSize >> shift;  // samples along a tile
  for (int y = 0; y < box.count.y; y += side) {
    for (int x = 0; x < box.count.x; x += side) {
      const glm::ivec2 first = box.first + glm::ivec2(x, y);
      if (first.x < 0 || first.y < 0) continue;
      const Tile* tile = view.state->tiles.find({first.x / side, first.y / side});
      if (tile == nullptr) continue;
      const auto out = height_q.subspan(std::size_t(y * box.count.x + x));
      if (level == 0) {
        copyTile(*tile, view.base->pack(), out, box.count.x);
        continue;
      }
      for (int j = 0; j < side; ++j)
        for (int i = 0; i < side; ++i)
          out[std::size_t(j * box.count.x + i)] += meanGain(*tile, view.base->pack(), {i * stride, j * stride}, stride);
    }
  }
}

}  // namespace spoor
