// How loaded pages of dormant ground keep up with the snow that falls on it: a part of TerrainLevels.
#include <algorithm>
#include <cstdlib>

#include "client/terrain_levels.h"

namespace spoor {

using namespace render;

namespace {

constexpr std::int32_t kSeen_q = 10;     // less is not seen, even where it meets a live tile
constexpr std::int32_t kMissing_q = 40;  // no page lacks more than about this
constexpr std::size_t kPagesPerFrame = 12;

/// Cells of a page, or none where it lies beyond the world's border, where the ground is mirrored.
CellBox pageCells(const ScenePack& pack, int level, glm::ivec2 page) {
  const std::int64_t side = std::int64_t(kPageSamples) << (level * kLevelShift);
  const auto clip = [](std::int64_t value, std::int32_t end) {
    return std::int32_t(std::clamp<std::int64_t>(value, 0, end));
  };
  return {clip(page.x * side, pack.width_cells), clip(page.y * side, pack.height_cells),
          clip((page.x + 1) * side, pack.width_cells), clip((page.y + 1) * side, pack.height_cells)};
}

}  // namespace

/// Snow by which a page differs from the view's, 0.1 mm, 0 only where by none. Coarse pages, with tiles of every beat,
/// go by one tile's, and lack some until a beat after the snowfall's end.
std::int32_t TerrainLevels::snowMissing(const TerrainView& view, int level, const Page& page) const {
  const std::int32_t now = view.state->tick;
  if (page.tick == now) return 0;
  const ScenePack& pack = view.base->pack();
  const CellBox cells = pageCells(pack, level, page.at);
  const TileCoordinate tile = level == 0 && !cells.empty() ? TileCoordinate{page.at.x, page.at.y} : TileCoordinate{};
  const bool one_tile = level == 0 && !cells.empty();
  std::int32_t missing_q = 0;
  for (const Snowfall& snowfall : view.state->snowfalls) {
    if (!cells.empty() && !snowfall.area.meets(cells)) continue;
    const auto [from, to] = std::minmax(page.tick, now);
    const rules::SnowDepth had = snowDepth(snowfall, tile, from), has = snowDepth(snowfall, tile, to);
    const std::int32_t over = snowfall.last_tick + rules::kSnowBeat;
    const bool lacks_last = !one_tile && from < over && to >= over;
    if (lacks_last || had.layers != has.layers || had.share != has.share) missing_q += has.layers - had.layers + 1;
  }
  return missing_q;
}

/// Pages that lack much snow at once; of those that lack some, a few in every frame, those that lack most; and such as
/// lack the last of a snowfall that is over.
void TerrainLevels::addSnowedPages(const TerrainView& view, std::vector<LoadJob>& jobs) {
  if (view.state->snowfalls.empty()) return;
  const std::int32_t now = view.state->tick;
  const bool falls = std::ranges::any_of(view.state->snowfalls, [&](const Snowfall& snowfall) {
    return snowfall.first_tick <= now && now <= snowfall.last_tick + rules::kSnowBeat;
  });
  struct Lacking {
    std::int32_t snow_q;
    LoadJob job;
  };
  std::vector<Lacking> lacking;
  for (int level = 0; level < kLevelCount; ++level) {
    const Level& l = levels_[std::size_t(level)];
    for (const Page& page : l.pages) {
      if (!holds(level, page.at)) continue;
      const std::int32_t snow_q = snowMissing(view, level, page);
      if (snow_q > (falls ? kSeen_q : 0))
        lacking.push_back({snow_q, {level, page.at, {page.at * kPageSamples, glm::ivec2(kPageSamples)}}});
    }
  }
  std::ranges::stable_sort(lacking, std::greater<>(), &Lacking::snow_q);
  const auto urgent = std::ranges::find_if(lacking, [](const Lacking& l) { return l.snow_q <= kMissing_q; });
  const std::size_t count = std::max(std::size_t(urgent - lacking.begin()), std::min(lacking.size(), kPagesPerFrame));
  for (std::size_t i = 0; i < count; ++i) jobs.push_back(lacking[i].job);
  stats.snow_pages += std::int64_t(count);
}

}  // namespace spoor
