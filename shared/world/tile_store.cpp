#include "shared/world/tile_store.h"

#include <algorithm>

#include "shared/base/assert.h"
#include "shared/base/hash.h"
#include "shared/base/kernels.h"

namespace spoor {
namespace {

std::uint64_t keyOf(TileCoordinate at) { return std::uint64_t(std::uint32_t(at.y)) << 32 | std::uint32_t(at.x); }

void fillBedrock(const ScenePack& pack, TileCoordinate at, const PlaneCells& height, PlaneCells& bedrock) {
  for (int y = 0; y < rules::kTileSize; ++y)
    for (int x = 0; x < rules::kTileSize; ++x) {
      const bool inside =
          at.x * rules::kTileSize + x < pack.width_cells && at.y * rules::kTileSize + y < pack.height_cells;
      const int i = y * rules::kTileSize + x;
      bedrock[i] = height[i] - (inside ? pack.soil_depth_q : 0);
    }
}

}  // namespace

std::unique_ptr<Tile> makeTile(TileCoordinate at, const BaseTerrain& base, std::int32_t tick) {
  const TileCoordinate extent = tileExtent(base.pack());
  SPOOR_ASSERT(at.x >= 0 && at.y >= 0 && at.x < extent.x && at.y < extent.y);
  auto tile = std::make_unique<Tile>();
  tile->at = at;
  tile->version_tick = tick;
  tile->planes[int(Plane::height)] = std::make_unique<PlaneCells>();
  tile->bedrock = std::make_unique<PlaneCells>();
  base.fillHeights(at, tile->height());
  fillBedrock(base.pack(), at, tile->height(), *tile->bedrock);
  tile->initial = kernels().sum(tile->height().data(), rules::kTileCells);
  tile->ground = tile->initial;
  tile->hash = tileHash(*tile);
  return tile;
}

Tile* TileStore::find(TileCoordinate at) {
  const auto found = tiles_.find(keyOf(at));
  return found == tiles_.end() ? nullptr : found->second.get();
}

const Tile* TileStore::find(TileCoordinate at) const { return const_cast<TileStore*>(this)->find(at); }

Tile& TileStore::insert(std::unique_ptr<Tile> tile) {
  std::unique_ptr<Tile>& slot = tiles_[keyOf(tile->at)];
  SPOOR_ASSERT(slot == nullptr);
  slot = std::move(tile);
  return *slot;
}

void TileStore::setWake(Tile& tile, WakeMask mask) {
  if (mask != 0 && tile.awake_index < 0) {
    tile.awake_index = std::int32_t(awake_.size());
    awake_.push_back(&tile);
  } else if (mask == 0 && tile.awake_index >= 0) {
    awake_[std::size_t(tile.awake_index)] = awake_.back();
    awake_.back()->awake_index = tile.awake_index;
    awake_.pop_back();
    tile.awake_index = -1;
  }
  tile.wake_mask = mask;
}

std::vector<Tile*> TileStore::sorted() {
  std::vector<Tile*> result;
  result.reserve(tiles_.size());
  for (const auto& [key, tile] : tiles_) result.push_back(tile.get());
  std::ranges::sort(result, {}, &Tile::at);
  return result;
}

std::vector<const Tile*> TileStore::sorted() const {
  const auto tiles = const_cast<TileStore*>(this)->sorted();
  return {tiles.begin(), tiles.end()};
}

std::size_t TileStore::memoryBytes() const {
  std::size_t compacted = 0;
  for (const auto& [key, tile] : tiles_) compacted += tile->compacted() != nullptr ? 1 : 0;
  return tiles_.size() * (sizeof(Tile) + 2 * sizeof(PlaneCells) + 4 * sizeof(void*)) + compacted * sizeof(PlaneCells) +
         tiles_.bucket_count() * sizeof(void*);
}

PlaneCells& Tile::makeCompacted() {
  auto& plane = planes[int(Plane::compacted)];
  if (plane == nullptr) plane = std::make_unique<PlaneCells>();
  return *plane;
}

std::uint64_t planeHash(TileCoordinate at, Plane plane, const PlaneCells* cells) {
  if (cells == nullptr) return 0;
  const auto hash = plane == Plane::height ? kernels().hashTile : kernels().hashSparseTile;
  return hash(cells->data(), at.x * rules::kTileSize, at.y * rules::kTileSize, int(plane));
}

std::uint64_t tileHash(const Tile& tile) {
  return planeHash(tile.at, Plane::height, &tile.height()) + planeHash(tile.at, Plane::compacted, tile.compacted());
}

std::uint64_t tileStateHash(const Tile& tile) {
  return tile.hash + mix64(mix64(keyOf(tile.at) ^ 0x7f4a7c159e3779b9u) + tile.wake_mask);
}

TileCoordinate tileExtent(const ScenePack& pack) {
  return {(pack.width_cells + rules::kTileSize - 1) / rules::kTileSize,
          (pack.height_cells + rules::kTileSize - 1) / rules::kTileSize};
}

}  // namespace spoor
