#include "shared/sim/work_area.h"

#include <algorithm>
#include <cstring>

#include "shaders/rules/exchange.h"
#include "shared/base/assert.h"

namespace spoor {
namespace {

constexpr int kSize = rules::kTileSize;

/// Cells outside the world hold no soil and take none.
void closeBorder(const ScenePack& pack, WorkArea& area, const Run& run) {
  const int inside_x = std::min(pack.width_cells - run.x0(), run.width());
  const int inside_y = std::min(pack.height_cells - run.first.y * kSize, kSize);
  if (inside_x == run.width() && inside_y == kSize) return;
  for (int row = 0; row < kSize; ++row) {
    const int from = row < inside_y ? inside_x : 0;
    std::int32_t* underside = area.underside.data() + run.rowOffset(row);
    std::fill(underside + from, underside + run.width(), -rules::kHeightLimit);
  }
}

}  // namespace

void WorkArea::gather(const std::vector<Tile*>& active, const Parameters& parameters, ThreadPool& pool) {
  tiles = active;
  const int count = int(tiles.size());
  runs.clear();
  bands.clear();
  run_of_tile.clear();
  std::size_t cells = 0, segments = 0;
  for (int i = 0; i < count; ++i) {
    const TileCoordinate at = tiles[i]->at;
    if (bands.empty() || bands.back().tile_y != at.y) bands.push_back({at.y, int(runs.size()), 0});
    if (bands.back().run_count == 0 || runs.back().first.x + runs.back().tile_count != at.x) {
      runs.push_back({at, 0, cells, segments});
      cells += kSize * Run::kRowPad;
      ++bands.back().run_count;
    }
    ++runs.back().tile_count;
    run_of_tile.push_back(int(runs.size()) - 1);
    cells += rules::kTileCells;
    segments += kSize;
  }

  height.resize(cells);
  bedrock.resize(cells);
  underside.resize(cells);
  underside_before.resize(cells);
  const bool compacts = anyCompression(parameters), mixed = parameters.materials.size() > 1;
  const bool exchanges = mixed && parameters.slopes == SlopeRule::exchange;
  compacted.assign(compacts ? cells : 0, 0);
  material.assign(mixed ? cells : 0, 0);
  threshold.resize(exchanges ? cells : 0);
  diagonal_threshold.resize(exchanges ? cells : 0);
  lowest_underside.resize(segments);
  last_change.assign(segments, 0);
  pool.forEach(count, [&](int i, int) {
    const Run& run = runs[run_of_tile[i]];
    for (int row = 0; row < kSize; ++row) {
      const std::size_t to = run.rowOffset(row) + std::size_t((tiles[i]->at.x - run.first.x) * kSize);
      std::memcpy(height.data() + to, tiles[i]->height().data() + row * kSize, kSize * sizeof(std::int32_t));
      std::memcpy(bedrock.data() + to, tiles[i]->bedrock->data() + row * kSize, kSize * sizeof(std::int32_t));
      if (compacts && tiles[i]->compacted() != nullptr)
        std::memcpy(compacted.data() + to, tiles[i]->compacted()->data() + row * kSize, kSize * sizeof(std::int32_t));
      if (mixed && tiles[i]->material() != nullptr)
        std::memcpy(material.data() + to, tiles[i]->material()->data() + row * kSize, kSize * sizeof(std::int32_t));
      if (!exchanges) continue;
      for (std::size_t cell = to; cell < to + kSize; ++cell) {
        const MaterialRules& own = parameters.materials[std::size_t(material[cell])];
        threshold[cell] = rules::exchangeThreshold(own.slope_threshold_q);
        diagonal_threshold[cell] = rules::exchangeThreshold(own.diagonal_threshold_q);
      }
    }
  });
}

const Run& WorkArea::runAt(std::int32_t x, std::int32_t y) const {
  const int tile_y = y / kSize, tile_x = x / kSize;
  const auto band = std::ranges::lower_bound(bands, tile_y, {}, &Band::tile_y);
  SPOOR_ASSERT(band != bands.end() && band->tile_y == tile_y);
  int found = band->first_run;
  while (found + 1 < band->first_run + band->run_count && runs[found + 1].first.x <= tile_x) ++found;
  SPOOR_ASSERT(runs[found].first.x <= tile_x && tile_x < runs[found].first.x + runs[found].tile_count);
  return runs[found];
}

std::vector<BufferBytes> WorkArea::buffers() const {
  const auto bytes = [](const auto&... planes) {
    return std::int64_t((... + planes.capacity()) * sizeof(std::int32_t));
  };
  return {{"heights", bytes(height)},
          {"heights after a sweep", bytes(next_height)},
          {"bedrock", bytes(bedrock)},
          {"undersides (2)", bytes(underside, underside_before)},
          {"compacted soil", bytes(compacted)},
          {"materials and their thresholds", bytes(material, threshold, diagonal_threshold)},
          {"pushes", bytes(push_x, push_y)},
          {"lowest underside and last change of rows", bytes(lowest_underside, last_change)}};
}

void WorkArea::clearUnderside(const ScenePack& pack, ThreadPool& pool) {
  pool.forEach(int(runs.size()), [&](int i, int) {
    const Run& run = runs[i];
    std::fill_n(underside.begin() + std::ptrdiff_t(run.cell_offset), run.stride() * kSize, rules::kNoUnderside);
    closeBorder(pack, *this, run);
  });
}

}  // namespace spoor
