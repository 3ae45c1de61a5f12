#include "shared/world/base_terrain.h"

#include <algorithm>

#include "shared/base/assert.h"
#include "shared/base/fixed.h"
#include "shared/world/noise.h"

namespace spoor {
namespace {

constexpr int kWeightBits = 24;
constexpr int kRowBits = 6;  // what rows keep below the unit until the columns are blended

/// Where a cell's centre lies among samples: the sample before it, and Catmull-Rom weights in Q24 that sum to one.
struct Cubic {
  std::int64_t first;  // sample of weight[1]
  std::int64_t weight[4];
};

Cubic cubicAt(std::int32_t cell, std::int64_t step_q32) {
  const std::int64_t position = cell * step_q32 + step_q32 / 2 - (std::int64_t(1) << 31);
  const std::int64_t t = (position >> (32 - kWeightBits)) & ((1 << kWeightBits) - 1);
  const std::int64_t t2 = (t * t) >> kWeightBits;
  const std::int64_t t3 = (t2 * t) >> kWeightBits;
  Cubic cubic{position >> 32, {(2 * t2 - t3 - t) >> 1, 0, (4 * t2 - 3 * t3 + t) >> 1, (t3 - t2) >> 1}};
  cubic.weight[1] = (1 << kWeightBits) - cubic.weight[0] - cubic.weight[2] - cubic.weight[3];
  return cubic;
}

/// Bicubic (Catmull-Rom) height of samples at a cell's centre; the border samples repeat outwards.
std::int32_t sampleHeight(const SampleBase& samples, const Cubic& along_x, const Cubic& along_y) {
  std::int64_t sum = 0;
  for (int j = 0; j < 4; ++j) {
    const std::int64_t row = std::clamp<std::int64_t>(along_y.first + j - 1, 0, samples.row_count - 1);
    const std::int32_t* heights = samples.height_q.data() + row * samples.column_count;
    std::int64_t row_sum = 0;
    for (int i = 0; i < 4; ++i) {
      const std::int64_t column = std::clamp<std::int64_t>(along_x.first + i - 1, 0, samples.column_count - 1);
      row_sum += heights[column] * along_x.weight[i];
    }
    sum += (row_sum >> (kWeightBits - kRowBits)) * along_y.weight[j];
  }
  constexpr int shift = kWeightBits + kRowBits;
  const std::int64_t height = (sum + (std::int64_t(1) << (shift - 1))) >> shift;
  constexpr std::int64_t limit = 3 << 28;  // overshoot of a cubic stays within the height limit
  return std::int32_t(std::clamp<std::int64_t>(height, -limit, limit));
}

std::int32_t sampleMaterial(const MaterialImage& image, std::int32_t x, std::int32_t y) {
  const auto sampleAt = [](std::int32_t cell, std::int64_t step_q32, std::int32_t count) {
    return std::min<std::int64_t>((cell * step_q32 + step_q32 / 2) >> 32, count - 1);
  };
  return image.material[std::size_t(sampleAt(y, image.step_y_q32, image.row_count) * image.column_count +
                                    sampleAt(x, image.step_x_q32, image.column_count))];
}

/// The slope is that of the base by central differences, one-sided at the world's border.
std::int32_t materialByRules(const BaseTerrain& base, const std::vector<MaterialRule>& rules, std::int32_t x,
                             std::int32_t y) {
  const auto difference = [&](std::int32_t dx, std::int32_t dy) {
    const std::int32_t x0 = std::max(x - dx, 0), x1 = std::min(x + dx, base.pack().width_cells - 1);
    const std::int32_t y0 = std::max(y - dy, 0), y1 = std::min(y + dy, base.pack().height_cells - 1);
    const std::int32_t cells = x1 - x0 + y1 - y0;
    // Twice the difference from one cell to the next.
    return cells == 0 ? 0 : (std::int64_t(base.height(x1, y1)) - base.height(x0, y0)) * 2 / cells;
  };
  // Beyond what a rule can name, so that squares fit.
  const auto bounded = [](std::int64_t value) { return std::clamp<std::int64_t>(value, -INT32_MAX, INT32_MAX); };
  const std::int64_t along_x = bounded(difference(1, 0)), along_y = bounded(difference(0, 1));
  const auto square = std::uint64_t(along_x * along_x) + std::uint64_t(along_y * along_y);
  const std::int64_t height = base.height(x, y);
  for (const MaterialRule& rule : rules) {
    const std::uint64_t gentlest = 2 * std::uint64_t(rule.gentlest_q), steepest = 2 * std::uint64_t(rule.steepest_q);
    if (height >= rule.lowest_q && height <= rule.highest_q && square >= gentlest * gentlest &&
        square <= steepest * steepest)
      return rule.material;
  }
  return 0;
}

}  // namespace

void BaseTerrain::fillHeights(TileCoordinate tile, std::span<std::int32_t, rules::kTileCells> height) const {
  fillArea(tile.x * rules::kTileSize, tile.y * rules::kTileSize, 1, rules::kTileSize, rules::kTileSize, height);
}

void BaseTerrain::fillArea(std::int32_t x, std::int32_t y, std::int32_t stride, std::int32_t columns, std::int32_t rows,
                           std::span<std::int32_t> height) const {
  SPOOR_ASSERT(height.size() == std::size_t(columns) * std::size_t(rows));
  const bool noise = pack_->base_kind == BaseKind::noise;
  for (std::int32_t row = 0; row < rows; ++row) {
    const std::int64_t cell_y = y + std::int64_t(row) * stride;
    std::int32_t* out = height.data() + std::size_t(row) * std::size_t(columns);
    if (cell_y < 0 || cell_y >= pack_->height_cells) {
      std::fill_n(out, columns, 0);
      continue;
    }
    const Cubic along_y = noise ? Cubic{} : cubicAt(std::int32_t(cell_y), pack_->samples.step_y_q32);
    for (std::int32_t column = 0; column < columns; ++column) {
      const std::int64_t cell_x = x + std::int64_t(column) * stride;
      if (cell_x < 0 || cell_x >= pack_->width_cells) {
        out[column] = 0;
      } else {
        out[column] =
            pack_->soil_depth_q +
            (noise ? noiseHeight(pack_->noise, std::int32_t(cell_x), std::int32_t(cell_y))
                   : sampleHeight(pack_->samples, cubicAt(std::int32_t(cell_x), pack_->samples.step_x_q32), along_y));
      }
    }
  }
}

std::int32_t BaseTerrain::height(std::int32_t x, std::int32_t y) const {
  std::int32_t result;
  fillArea(x, y, 1, 1, 1, {&result, 1});
  return result;
}

void BaseTerrain::fillMaterials(std::int32_t x, std::int32_t y, std::int32_t stride, std::int32_t columns,
                                std::int32_t rows, std::span<std::int32_t> material) const {
  SPOOR_ASSERT(material.size() == std::size_t(columns) * std::size_t(rows));
  const MaterialMap& map = pack_->material_map;
  std::ranges::fill(material, 0);
  if (map.kind == MaterialMapKind::one || (map.kind == MaterialMapKind::rules && map.rules.empty())) return;
  const auto find = [&](std::int32_t cell_x, std::int32_t cell_y) {
    return map.kind == MaterialMapKind::image ? sampleMaterial(map.image, cell_x, cell_y)
                                              : materialByRules(*this, map.rules, cell_x, cell_y);
  };
  for (std::int32_t row = 0; row < rows; ++row) {
    const std::int64_t cell_y = y + std::int64_t(row) * stride;
    if (cell_y < 0 || cell_y >= pack_->height_cells) continue;
    for (std::int32_t column = 0; column < columns; ++column) {
      const std::int64_t cell_x = x + std::int64_t(column) * stride;
      if (cell_x < 0 || cell_x >= pack_->width_cells) continue;
      material[std::size_t(row) * std::size_t(columns) + std::size_t(column)] =
          find(std::int32_t(cell_x), std::int32_t(cell_y));
    }
  }
}

std::int32_t BaseTerrain::heightAt(std::int32_t x_q, std::int32_t y_q) const {
  // In 1/256 cells from the centre of cell (0, 0), kept between the outermost centres.
  const auto position = [this](std::int64_t at_q, std::int32_t cells) {
    const std::int64_t at = floorDiv(at_q * 256, pack_->cell_q) - 128;
    return std::clamp<std::int64_t>(at, 0, (std::int64_t(cells) - 1) * 256);
  };
  const std::int64_t px = position(x_q, pack_->width_cells);
  const std::int64_t py = position(y_q, pack_->height_cells);
  const auto x0 = std::int32_t(px >> 8), y0 = std::int32_t(py >> 8);
  const std::int32_t x1 = std::min(x0 + 1, pack_->width_cells - 1), y1 = std::min(y0 + 1, pack_->height_cells - 1);
  const std::int64_t fx = px & 255, fy = py & 255;
  const std::int64_t south = height(x0, y0) * (256 - fx) + height(x1, y0) * fx;
  const std::int64_t north = height(x0, y1) * (256 - fx) + height(x1, y1) * fx;
  return std::int32_t((south * (256 - fy) + north * fy) >> 16);
}

}  // namespace spoor
