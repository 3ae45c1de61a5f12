#include "shared/world/tile_store.h"

#include <algorithm>
#include <iterator>

#include "shared/base/assert.h"
#include "shared/base/hash.h"
#include "shared/base/kernels.h"

namespace spoor {
namespace {

static_assert(int(Plane::material) + 1 == kPlaneCount);

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

/// All that fell on a tile up to now.
std::int64_t takeSnow(const ScenePack& pack, TileCoordinate at, std::span<const Snowfall> snowfalls, std::int32_t tick,
                      PlaneCells& height) {
  if (snowfalls.empty()) return 0;
  PlaneCells depth;
  fillSnow(pack, snowfalls, tick, at.x * rules::kTileSize, at.y * rules::kTileSize, 1, rules::kTileSize,
           rules::kTileSize, depth);
  std::int64_t gained = 0;
  for (std::size_t i = 0; i < height.size(); ++i) {
    const std::int32_t ground = rules::snowGround(height[i], height[i], depth[i]);
    gained += ground - height[i];
    height[i] = ground;
  }
  return gained;
}

/// nullptr: 0 everywhere.
std::unique_ptr<PlaneCells> materialsOf(const BaseTerrain& base, TileCoordinate at) {
  if (base.pack().material_map.kind == MaterialMapKind::one) return nullptr;
  auto cells = std::make_unique<PlaneCells>();
  base.fillMaterials(at.x * rules::kTileSize, at.y * rules::kTileSize, 1, rules::kTileSize, rules::kTileSize, *cells);
  return std::ranges::any_of(*cells, [](std::int32_t material) { return material != 0; }) ? std::move(cells) : nullptr;
}

}  // namespace

std::unique_ptr<Tile> makeTile(TileCoordinate at, const DormantGround& dormant, std::int32_t tick) {
  const BaseTerrain& base = *dormant.base;
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
  std::unique_ptr<TileCraters> known;
  if (dormant.craters != nullptr)
    tile->first_craters = addCraters(at, tile->height(), *tile->bedrock, *dormant.craters, 0, known);
  tile->first_snow = takeSnow(base.pack(), at, dormant.snowfalls, dormant.tick, tile->height());
  tile->ground += tile->first_craters + tile->first_snow;
  tile->planes[int(Plane::material)] = materialsOf(base, at);
  tile->hash = tileHash(*tile);
  return tile;
}

CellBox cellsOf(TileCoordinate at) {
  const std::int32_t x = at.x * rules::kTileSize, y = at.y * rules::kTileSize;
  return {x, y, x + rules::kTileSize, y + rules::kTileSize};
}

CellBox cratersWithin(TileCoordinate at, const ScenePack& pack, const CraterSet& craters, std::size_t first_new) {
  const CellBox cells = cellsOf(at);
  CellBox all;
  if (first_new >= craters.size()) return all;
  for (const std::uint32_t id : craters.meeting(cells)) {
    if (id < first_new) continue;
    const CellBox box = craterBox(pack, craters.records()[id]);
    const CellBox within{std::max(box.x0, cells.x0) - cells.x0, std::max(box.y0, cells.y0) - cells.y0,
                         std::min(box.x1, cells.x1) - cells.x0, std::min(box.y1, cells.y1) - cells.y0};
    if (within.empty()) continue;
    all = all.empty() ? within
                      : CellBox{std::min(all.x0, within.x0), std::min(all.y0, within.y0), std::max(all.x1, within.x1),
                                std::max(all.y1, within.y1)};
  }
  return all;
}

std::int64_t addCraters(TileCoordinate at, PlaneCells& height, const PlaneCells& bedrock, const CraterSet& craters,
                        std::size_t first_new, std::unique_ptr<TileCraters>& known) {
  const CellBox cells = cellsOf(at);
  const std::vector<std::uint32_t> ids = craters.meeting(cells);
  const auto old_count = std::size_t(std::ranges::lower_bound(ids, first_new) - ids.begin());
  if (old_count == ids.size()) return 0;
  if (known == nullptr || known->count != old_count) {
    known = std::make_unique<TileCraters>();
    for (; known->count < old_count; ++known->count) craters.addTo(known->sums, cells, ids[known->count]);
  }
  const TileCraters before = *known;
  for (; known->count < ids.size(); ++known->count) craters.addTo(known->sums, cells, ids[known->count]);
  std::int64_t gained = 0;
  for (std::size_t i = 0; i < rules::kTileCells; ++i) {
    const std::int32_t change_q = rules::craterTotal(known->sums[i]) - rules::craterTotal(before.sums[i]);
    if (change_q == 0) continue;
    const std::int32_t height_before = height[i];
    height[i] = rules::craterGround(height_before, bedrock[i], change_q);
    gained += height[i] - height_before;
  }
  return gained;
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
  by_beat_[std::size_t(-snowBeat(slot->at, 0))].push_back(slot.get());
  return *slot;
}

std::span<Tile* const> TileStore::atBeat(std::int32_t tick) const {
  return by_beat_[std::size_t(-tick & (rules::kSnowBeat - 1))];
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

std::vector<const Tile*> TileStore::meeting(const ScenePack& pack, std::span<const Crater> craters) const {
  std::vector<const Tile*> found, live;
  for (const Crater& crater : craters) {
    const CellBox box = craterBox(pack, crater);
    if (box.empty()) continue;
    const TileCoordinate first{box.x0 / rules::kTileSize, box.y0 / rules::kTileSize};
    const TileCoordinate last{(box.x1 - 1) / rules::kTileSize, (box.y1 - 1) / rules::kTileSize};
    // The tiles of the box or the live ones: whichever are fewer.
    if ((std::int64_t(last.x) - first.x + 1) * (std::int64_t(last.y) - first.y + 1) > std::int64_t(tiles_.size())) {
      if (live.empty()) live = sorted();
      std::ranges::copy_if(live, std::back_inserter(found), [&](const Tile* tile) {
        return tile->at.x >= first.x && tile->at.x <= last.x && tile->at.y >= first.y && tile->at.y <= last.y;
      });
      continue;
    }
    for (int y = first.y; y <= last.y; ++y)
      for (int x = first.x; x <= last.x; ++x)
        if (const Tile* tile = find({x, y})) found.push_back(tile);
  }
  std::ranges::sort(found, {}, &Tile::at);
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

std::size_t TileStore::memoryBytes() const {
  std::size_t planes = 0, cratered = 0;
  for (const auto& [key, tile] : tiles_) {
    for (const auto& plane : tile->planes) planes += plane != nullptr ? 1 : 0;
    cratered += tile->craters != nullptr ? 1 : 0;
  }
  return tiles_.size() * (sizeof(Tile) + sizeof(PlaneCells) + 4 * sizeof(void*)) + planes * sizeof(PlaneCells) +
         cratered * sizeof(TileCraters) + tiles_.bucket_count() * sizeof(void*);
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
  std::uint64_t hash = 0;
  for (int plane = 0; plane < kPlaneCount; ++plane) hash += planeHash(tile.at, Plane(plane), tile.planes[plane].get());
  return hash;
}

std::uint64_t tileStateHash(const Tile& tile) {
  return tile.hash + mix64(mix64(keyOf(tile.at) ^ 0x7f4a7c159e3779b9u) + tile.wake_mask);
}

TileCoordinate tileExtent(const ScenePack& pack) {
  return {(pack.width_cells + rules::kTileSize - 1) / rules::kTileSize,
          (pack.height_cells + rules::kTileSize - 1) / rules::kTileSize};
}

}  // namespace spoor
