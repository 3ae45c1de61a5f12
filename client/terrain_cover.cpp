#include "client/terrain_cover.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <vector>

#include "shaders/render/frame.h"
#include "shared/base/assert.h"

namespace spoor {

namespace {

std::uint8_t whiteness(std::int32_t depth_q) {
  return std::uint8_t(std::clamp(depth_q, 0, kWhiteSnow_q) * 255 / kWhiteSnow_q);
}

/// How much of each cell of a live tile snow hides.
std::array<std::uint8_t, rules::kTileCells> snowOnCells(const Tile& tile, const TerrainView& view) {
  const WorldState& state = *view.state;
  std::array<std::int32_t, rules::kTileCells> untouched, fallen;
  dormantGround(state, *view.base).fillHeights(tile.at, untouched);
  fillSnow(view.base->pack(), state.snowfalls, state.tick, tile.at.x * rules::kTileSize, tile.at.y * rules::kTileSize,
           1, rules::kTileSize, rules::kTileSize, fallen);
  std::array<std::uint8_t, rules::kTileCells> snow;
  for (std::size_t i = 0; i < snow.size(); ++i)
    snow[i] = whiteness(fallen[i] - std::abs(tile.height()[i] - untouched[i]));
  return snow;
}

/// The samples of a live tile: `side` by `side` of them.
void fillLiveTile(const Tile& tile, const TerrainView& view, int side, std::span<CoverSample> out, int row_samples) {
  const int stride = rules::kTileSize / side, middle = stride == 1 ? 0 : stride / 2;
  const ScenePack& pack = view.base->pack();
  const glm::ivec2 inside(pack.width_cells - tile.at.x * rules::kTileSize,
                          pack.height_cells - tile.at.y * rules::kTileSize);
  const bool snowed = !view.state->snowfalls.empty();
  std::array<std::uint8_t, rules::kTileCells> snow{};
  if (snowed) snow = snowOnCells(tile, view);
  for (int y = 0; y < side && y * stride + middle < inside.y; ++y) {
    for (int x = 0; x < side && x * stride + middle < inside.x; ++x) {
      CoverSample& sample = out[std::size_t(y * row_samples + x)];
      const auto cell = std::size_t((y * stride + middle) * rules::kTileSize + x * stride + middle);
      sample.material = tile.material() == nullptr ? 0 : std::uint8_t((*tile.material())[cell]);
      if (!snowed) continue;
      int sum = 0;
      for (int j = 0; j < stride; ++j)
        for (int i = 0; i < stride; ++i) sum += snow[std::size_t((y * stride + j) * rules::kTileSize + x * stride + i)];
      sample.snow = std::uint8_t(sum / (stride * stride));
    }
  }
}

}  // namespace

void fillCover(const TerrainView& view, int level, const SampleBox& box, std::span<CoverSample> cover) {
  SPOOR_ASSERT(cover.size() == std::size_t(box.count.x) * std::size_t(box.count.y));
  const ScenePack& pack = view.base->pack();
  const WorldState& state = *view.state;
  const int shift = level * render::kLevelShift, stride = 1 << shift, middle = level == 0 ? 0 : stride / 2;
  const glm::ivec2 size(pack.width_cells, pack.height_cells), first_cell = box.first * stride + middle;
  std::ranges::fill(cover, CoverSample{});
  std::vector<std::int32_t> values(cover.size());
  if (pack.material_map.kind != MaterialMapKind::one) {
    fillMirrored(size, first_cell, stride, box.count, values, [&](glm::ivec2 at, glm::ivec2 count, auto out) {
      view.base->fillMaterials(at.x, at.y, stride, count.x, count.y, out);
    });
    for (std::size_t i = 0; i < cover.size(); ++i) cover[i].material = std::uint8_t(values[i]);
  }
  if (!state.snowfalls.empty()) {
    fillMirrored(size, first_cell, stride, box.count, values, [&](glm::ivec2 at, glm::ivec2 count, auto out) {
      fillSnow(pack, state.snowfalls, state.tick, at.x, at.y, stride, count.x, count.y, out);
    });
    for (std::size_t i = 0; i < cover.size(); ++i) cover[i].snow = whiteness(values[i]);
  }
  forEachLiveTile(view, level, box, [&](const Tile& tile, glm::ivec2, int side, std::size_t at) {
    fillLiveTile(tile, view, side, cover.subspan(at), box.count.x);
  });
}

}  // namespace spoor
