#include "client/terrain_view.h"

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

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

/// Samples in a row whose cells, mirrored into the world, follow each other in one direction.
struct MirroredRun {
  int first, count;  // of the samples
  std::int32_t low;  // the lowest of their cells
  bool backwards;
};

std::vector<MirroredRun> mirroredRuns(int first_cell, int stride, int count, std::int32_t size) {
  std::vector<MirroredRun> runs;
  for (int done = 0; done < count;) {
    const std::int32_t cell = mirrored(first_cell + done * stride, size);
    const std::int64_t period = std::int64_t(2) * size;
    const bool backwards = ((first_cell + done * stride) % period + period) % period >= size;
    const int length = std::min((backwards ? cell : size - 1 - cell) / stride + 1, count - done);
    runs.push_back({done, length, backwards ? cell - (length - 1) * stride : cell, backwards});
    done += length;
  }
  return runs;
}

void fillGround(const DormantGround& ground, glm::ivec2 first_cell, int stride, glm::ivec2 count,
                std::span<std::int32_t> out) {
  const glm::ivec2 size(ground.base->pack().width_cells, ground.base->pack().height_cells);
  fillMirrored(size, first_cell, stride, count, out,
               [&](glm::ivec2 at, glm::ivec2 part_count, std::span<std::int32_t> part) {
                 ground.fillArea(at.x, at.y, stride, part_count.x, part_count.y, part);
               });
}

/// Mean of what a block of a tile's cells gained over the base; cells outside the world do not count. Nothing where all
/// lie outside.
std::optional<std::int32_t> meanGain(const Tile& tile, const ScenePack& pack, glm::ivec2 first, int side) {
  const glm::ivec2 inside(pack.width_cells - tile.at.x * rules::kTileSize,
                          pack.height_cells - tile.at.y * rules::kTileSize);
  const glm::ivec2 end = glm::min(first + side, inside);
  if (end.x <= first.x || end.y <= first.y) return std::nullopt;
  std::int64_t sum = 0;
  for (int y = first.y; y < end.y; ++y) {
    for (int x = first.x; x < end.x; ++x) {
      const auto i = std::size_t(y * rules::kTileSize + x);
      sum += std::int64_t(tile.height()[i]) - (*tile.bedrock)[i] - pack.soil_depth_q;
    }
  }
  return std::int32_t(sum / ((end.x - first.x) * (end.y - first.y)));
}

/// Copies a live tile's cells over the dormant ones; what lies outside the world keeps mirroring.
void copyTile(const Tile& tile, const ScenePack& pack, std::span<std::int32_t> out, int row_samples) {
  const glm::ivec2 inside(pack.width_cells - tile.at.x * rules::kTileSize,
                          pack.height_cells - tile.at.y * rules::kTileSize);
  const glm::ivec2 end = glm::min(inside, glm::ivec2(rules::kTileSize));
  for (int y = 0; y < end.y; ++y)
    std::copy_n(tile.height().begin() + y * rules::kTileSize, end.x, out.begin() + y * row_samples);
}

/// The samples of a live tile: the base, without craters, and what its cells gained, craters and all.
/// @param first  sample; `side` samples of `stride` cells make the tile
void fillLiveTile(const Tile& tile, const BaseTerrain& base, glm::ivec2 first, int side, std::span<std::int32_t> out,
                  int row_samples) {
  const int stride = rules::kTileSize / side;
  std::array<std::int32_t, rules::kTileCells> plain;
  const std::span<std::int32_t> samples = std::span(plain).first(std::size_t(side * side));
  fillGround({&base}, first * stride + stride / 2, stride, glm::ivec2(side), samples);
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      if (const auto gain = meanGain(tile, base.pack(), {x * stride, y * stride}, stride))
        out[std::size_t(y * row_samples + x)] = samples[std::size_t(y * side + x)] + *gain;
}

}  // namespace

void fillMirrored(glm::ivec2 size, glm::ivec2 first_cell, int stride, glm::ivec2 count, std::span<std::int32_t> out,
                  const std::function<void(glm::ivec2, glm::ivec2, std::span<std::int32_t>)>& fill) {
  const auto rows = mirroredRuns(first_cell.y, stride, count.y, size.y);
  const auto columns = mirroredRuns(first_cell.x, stride, count.x, size.x);
  if (rows.size() == 1 && columns.size() == 1 && !rows[0].backwards && !columns[0].backwards)
    return fill({columns[0].low, rows[0].low}, count, out);
  std::vector<std::int32_t> part;
  for (const MirroredRun& row : rows) {
    for (const MirroredRun& column : columns) {
      part.resize(std::size_t(row.count) * std::size_t(column.count));
      fill({column.low, row.low}, {column.count, row.count}, part);
      for (int y = 0; y < row.count; ++y) {
        const auto from = part.begin() + (row.backwards ? row.count - 1 - y : y) * column.count;
        const auto to = out.begin() + (row.first + y) * count.x + column.first;
        if (column.backwards)
          std::reverse_copy(from, from + column.count, to);
        else
          std::copy_n(from, column.count, to);
      }
    }
  }
}

void forEachLiveTile(const TerrainView& view, int level, const SampleBox& box,
                     const std::function<void(const Tile&, glm::ivec2, int, std::size_t)>& visit) {
  const int shift = level * render::kLevelShift;
  if (1 << shift > rules::kTileSize) return;
  const int side = rules::kTileSize >> shift;  // samples along a tile
  for (int y = 0; y < box.count.y; y += side) {
    for (int x = 0; x < box.count.x; x += side) {
      const glm::ivec2 first = box.first + glm::ivec2(x, y);
      if (first.x < 0 || first.y < 0) continue;
      const Tile* tile = view.state->tiles.find({first.x / side, first.y / side});
      if (tile != nullptr) visit(*tile, first, side, std::size_t(y * box.count.x + x));
    }
  }
}

void fillSamples(const TerrainView& view, int level, const SampleBox& box, std::span<std::int32_t> height_q) {
  SPOOR_ASSERT(height_q.size() == std::size_t(box.count.x) * std::size_t(box.count.y));
  const int stride = 1 << (level * render::kLevelShift);
  const int middle = level == 0 ? 0 : stride / 2;
  fillGround(dormantGround(*view.state, *view.base), box.first * stride + middle, stride, box.count, height_q);
  forEachLiveTile(view, level, box, [&](const Tile& tile, glm::ivec2 first, int side, std::size_t at) {
    if (level == 0)
      copyTile(tile, view.base->pack(), height_q.subspan(at), box.count.x);
    else
      fillLiveTile(tile, *view.base, first, side, height_q.subspan(at), box.count.x);
  });
}

}  // namespace spoor
