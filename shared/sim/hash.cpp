// Stage hash: what the tick changed goes back to the tiles, and their hashes and sums are found.
#include <cstring>

#include "shared/sim/native_stages.h"

namespace spoor {
namespace {

constexpr int kSize = rules::kTileSize;

/// Copies a plane of the area's cells to the tile's; false where none changed. `before` then holds the old cells.
bool fetchPlane(const Run& run, TileCoordinate at, const std::vector<std::int32_t>& plane, PlaneCells& cells,
                PlaneCells& before) {
  const std::size_t column = std::size_t(at.x - run.first.x) * kSize;
  const auto rowOf = [&](int row) { return plane.data() + run.rowOffset(row) + column; };
  int row = 0;
  while (row < kSize && std::memcmp(rowOf(row), cells.data() + row * kSize, kSize * sizeof(std::int32_t)) == 0) ++row;
  if (row == kSize) return false;
  before = cells;
  for (; row < kSize; ++row) std::memcpy(cells.data() + row * kSize, rowOf(row), kSize * sizeof(std::int32_t));
  return true;
}

/// The same for compacted soil, whose plane is only made for a tile that has some.
bool fetchCompacted(const WorkArea& area, const Run& run, Tile& tile, PlaneCells& before) {
  if (area.compacted.empty()) return false;
  if (tile.compacted() != nullptr) return fetchPlane(run, tile.at, area.compacted, *tile.compacted(), before);
  auto cells = std::make_unique<PlaneCells>();
  if (!fetchPlane(run, tile.at, area.compacted, *cells, before)) return false;
  tile.planes[int(Plane::compacted)] = std::move(cells);
  return true;
}

}  // namespace

std::vector<TileOutcome> runHash(const NativeContext& context) {
  WorkArea& area = context.area;
  std::vector<TileOutcome> outcomes(area.tiles.size());
  context.pool.forEach(int(area.tiles.size()), [&](int i, int) {
    Tile& tile = *area.tiles[i];
    const Run& run = area.runs[area.run_of_tile[i]];
    PlaneCells before, compacted_before;
    const bool moved = fetchPlane(run, tile.at, area.height, tile.height(), before);
    const bool compacted = fetchCompacted(area, run, tile, compacted_before);
    if (!moved && !compacted) return;
    TilePlanes old = planesOf(tile);
    if (moved) old[int(Plane::height)] = &before;
    if (compacted) old[int(Plane::compacted)] = &compacted_before;
    outcomes[i].change = differenceOf(tile, old, tile.version_tick);
    outcomes[i].hash = tileHash(tile);
    outcomes[i].ground = context.kernels.sum(tile.height().data(), rules::kTileCells);
    if (tile.compacted() != nullptr)
      outcomes[i].compacted = context.kernels.sum(tile.compacted()->data(), rules::kTileCells);
  });
  return outcomes;
}

}  // namespace spoor
