// Stage hash: what the tick changed goes back to the tiles, and their hashes and sums are found.
#include <cstring>

#include "shared/sim/native_stages.h"

namespace spoor {
namespace {

constexpr int kSize = rules::kTileSize;

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

std::vector<TileOutcome> runHash(const NativeContext& context) {
  WorkArea& area = context.area;
  std::vector<TileOutcome> outcomes(area.tiles.size());
  context.pool.forEach(int(area.tiles.size()), [&](int i, int) {
    Tile& tile = *area.tiles[i];
    PlaneCells before;
    if (!fetchCells(area, area.runs[area.run_of_tile[i]], tile, before)) return;
    outcomes[i] = {
        differenceOf(tile, before, tile.version_tick),
        context.kernels.hashTile(tile.height().data(), tile.at.x * kSize, tile.at.y * kSize, int(Plane::height)),
        context.kernels.sum(tile.height().data(), rules::kTileCells)};
  });
  return outcomes;
}

}  // namespace spoor
