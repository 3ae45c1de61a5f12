#include "tests/stage_rig.h"

#include <algorithm>
#include <random>

#include "shaders/rules/mix.h"
#include "shared/base/assert.h"
#ifdef SPOOR_WITH_GL
#include "tests/gl_stage_rig.h"
#endif

namespace spoor::test {
namespace {

constexpr int kSize = rules::kTileSize;

std::vector<TileCoordinate> allTiles(const ScenePack& pack) {
  std::vector<TileCoordinate> tiles;
  const TileCoordinate extent = tileExtent(pack);
  for (int y = 0; y < extent.y; ++y)
    for (int x = 0; x < extent.x; ++x) tiles.push_back({x, y});
  return tiles;
}

}  // namespace

StageRig::StageRig(const World& world, std::vector<TileCoordinate> active) : world_(world) {
  plan_.tick = 1;
  plan_.parameters = world.pack.parameters;
  plan_.active = active.empty() ? allTiles(world.pack) : std::move(active);
  has_domain_ = plan_.active == allTiles(world.pack);
}

void StageRig::moveSoil() {
  penetration();
  if (penetratingCount() == 0) return;
  nearest();
  displace();
}

std::ptrdiff_t StageRig::tileIndex(int x, int y) const {
  const TileCoordinate at{x / kSize, y / kSize};
  const auto found = std::ranges::lower_bound(plan_.active, at);
  return found == plan_.active.end() || *found != at ? -1 : found - plan_.active.begin();
}

Cells StageRig::insideOf(const Cells& tiles) const {
  Cells cells;
  for (int y = 0; y < world_.pack.height_cells; ++y)
    for (int x = 0; x < world_.pack.width_cells; ++x) {
      const std::ptrdiff_t tile = tileIndex(x, y);
      SPOOR_ASSERT(tile >= 0);
      cells.push_back(tiles[std::size_t(tile * rules::kTileCells + y % kSize * kSize + x % kSize)]);
    }
  return cells;
}

Cells StageRig::withInside(Cells tiles, const Cells& cells) const {
  const int width = world_.pack.width_cells;
  SPOOR_ASSERT(cells.size() == std::size_t(width) * std::size_t(world_.pack.height_cells));
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const int x = int(i) % width, y = int(i) / width;
    const std::ptrdiff_t tile = tileIndex(x, y);
    SPOOR_ASSERT(tile >= 0);
    tiles[std::size_t(tile * rules::kTileCells + y % kSize * kSize + x % kSize)] = cells[i];
  }
  return tiles;
}

NativeStageRig::NativeStageRig(const World& made_world, int thread_count, const Kernels& set, bool skip_settled,
                               std::vector<TileCoordinate> active)
    : StageRig(made_world, std::move(active)),
      pool(thread_count),
      tiles(takeTiles(plan_, made_world.base, WorldState{}, pool)),
      context{made_world.pack, plan_.tick, plan_.parameters, set, pool, area},
      skip_settled_(skip_settled) {
  area.gather(tiles.tiles, plan_.parameters, pool);
  area.clearUnderside(made_world.pack, pool);
  area.underside_before = area.underside;
  runDepth(context, {});
  if (hasDomain()) domain.reset(domainBox(), area);
}

void NativeStageRig::press(const std::vector<PlacedBody>& bodies) {
  area.clearUnderside(world_.pack, pool);
  SubStep sub_step{bodies, {{domain.box, {}}}, 0};
  for (std::size_t i = 0; i < bodies.size(); ++i) sub_step.domains[0].bodies.push_back(int(i));
  runDepth(context, sub_step);
}

void NativeStageRig::setTarget(const Cells& cells) {
  domain.target = cells;
  domain.receives.assign(std::size_t(domain.rows()), 0);
  for (std::size_t i = 0; i < cells.size(); ++i)
    if (domain.overlap[i] > 0 && cells[i] != rules::kNoTarget)
      domain.receives[std::size_t(cells[i] / domain.width())] = 1;
}

void NativeStageRig::putTileUndersides(const Cells& cells) {
  putTiles(area.underside, cells);
  std::ranges::fill(area.lowest_underside, -rules::kHeightLimit);  // anything may limit: the careful path everywhere
}

Cells NativeStageRig::tileCompacted() const {
  return area.compacted.empty() ? Cells(plan_.active.size() * rules::kTileCells) : tilesOf(area.compacted);
}

Cells NativeStageRig::tilesOf(const std::vector<std::int32_t>& plane) const {
  Cells cells;
  for (const TileCoordinate tile : plan_.active)
    for (int row = 0; row < kSize; ++row) {
      const auto first = plane.begin() + std::ptrdiff_t(area.offsetAt(tile.x * kSize, tile.y * kSize + row));
      cells.insert(cells.end(), first, first + kSize);
    }
  return cells;
}

void NativeStageRig::putTiles(std::vector<std::int32_t>& plane, const Cells& cells) {
  auto from = cells.begin();
  for (const TileCoordinate tile : plan_.active)
    for (int row = 0; row < kSize; ++row, from += kSize)
      std::copy_n(from, kSize, plane.begin() + std::ptrdiff_t(area.offsetAt(tile.x * kSize, tile.y * kSize + row)));
}

std::unique_ptr<StageRig> makeStageRig(const BackendCase& backend_case, const World& world,
                                       std::vector<TileCoordinate> active) {
#ifdef SPOOR_WITH_GL
  if (backend_case.gl) return makeGlStageRig(backend_case, world, std::move(active));
#endif
  const Kernels& set = backend_case.baseline_kernels ? *availableKernels().front() : kernels();
  return std::make_unique<NativeStageRig>(world, backend_case.thread_count, set, backend_case.skip_settled,
                                          std::move(active));
}

void coverAtRandom(StageRig& rig, std::uint32_t seed) {
  std::mt19937 engine(seed);
  const Cells height = rig.height();
  const int width = rig.world().pack.width_cells;
  const int block = engine() % 2 == 0 ? 1 : 2 + int(engine() % 20);  // cells a side
  const std::uint32_t covered = 1 + std::uint32_t(engine() % 9);     // of ten blocks
  Cells underside, compacted;
  for (int i = 0; i < int(height.size()); ++i) {
    const rules::uint key = rules::mix32(rules::cellKey(i % width / block, i / width / block, 7) ^ seed);
    const bool roof = engine() % 12 == 0;
    const std::int32_t above = height[std::size_t(i)] + (roof ? int(engine() % 600) : int(engine() % 4000) - 3900);
    underside.push_back(roof || key % 10 < covered ? above : rules::kNoUnderside);
    compacted.push_back(engine() % 3 == 0 ? int(engine() % 900) : 0);
  }
  rig.setUnderside(underside);
  if (rig.world().pack.parameters.materials[0].compression_q16 > 0) rig.setCompacted(compacted);
}

DenseWorld denseCopy(const StageRig& rig) {
  DenseWorld dense(rig.world().base);
  const Cells height = rig.height(), underside = rig.underside(), compacted = rig.compacted();
  for (int y = 0; y < dense.inside_rows; ++y)
    for (int x = 0; x < dense.inside_columns; ++x) {
      const auto i = std::size_t(y * dense.inside_columns + x);
      dense.height[dense.at(x, y)] = height[i];
      dense.underside[dense.at(x, y)] = underside[i];
      dense.compacted[dense.at(x, y)] = compacted[i];
    }
  std::ranges::fill(dense.active, std::uint8_t(1));
  return dense;
}

Cells insideCells(const DenseWorld& dense, const std::vector<std::int32_t>& plane) {
  Cells result;
  for (int y = 0; y < dense.inside_rows; ++y)
    for (int x = 0; x < dense.inside_columns; ++x) result.push_back(plane[dense.at(x, y)]);
  return result;
}

}  // namespace spoor::test
