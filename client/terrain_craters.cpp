// What new craters change of the loaded ground: the part of TerrainLevels that keeps up with them.
#include <algorithm>

#include "client/terrain_levels.h"
#include "shared/base/assert.h"

namespace spoor {

using namespace render;

namespace {

/// Samples [low, high) along an axis.
struct Span {
  int low = 0, high = 0;
  bool empty() const { return low >= high; }
  void include(const Span& other) {
    if (empty()) *this = other;
    low = std::min(low, other.low);
    high = std::max(high, other.high);
  }
};

int floorDivide(std::int64_t a, std::int64_t b) { return int(a >= 0 ? a / b : -((b - 1 - a) / b)); }
int ceilDivide(std::int64_t a, std::int64_t b) { return -floorDivide(-a, b); }

/// One axis of a level's window.
struct Axis {
  int level;
  int first_page, page_count;
  std::int32_t size_cells;  // of the world

  /// Samples whose cells lie in [low, high), whole tiles of them, within the window.
  Span samplesOf(std::int64_t low, std::int64_t high) const {
    const int shift = level * kLevelShift, stride = 1 << shift;
    const int middle = level == 0 ? 0 : stride / 2;
    const int tile = std::max(rules::kTileSize >> shift, 1);
    Span span{ceilDivide(low - middle, stride), ceilDivide(high - middle, stride)};
    if (span.empty()) return {};
    span = {floorDivide(span.low, tile) * tile, ceilDivide(span.high, tile) * tile};
    return {std::max(span.low, first_page * kPageSamples),
            std::min(span.high, (first_page + page_count) * kPageSamples)};
  }

  /// Of each page of the window the samples that show cells [low, high) of the world, or their mirror images beyond its
  /// border.
  std::vector<Span> pagesShowing(std::int32_t low, std::int32_t high) const {
    std::vector<Span> pages(static_cast<std::size_t>(page_count));
    const auto show = [&](std::int64_t from, std::int64_t to) {
      const Span span = samplesOf(from, to);
      if (span.empty()) return;
      for (int page = floorDivide(span.low, kPageSamples); page <= floorDivide(span.high - 1, kPageSamples); ++page) {
        const Span part{std::max(span.low, page * kPageSamples), std::min(span.high, (page + 1) * kPageSamples)};
        if (!part.empty()) pages[std::size_t(page - first_page)].include(part);
      }
    };
    const std::int64_t period = std::int64_t(2) * size_cells;
    const std::int64_t page_cells = std::int64_t(kPageSamples) << (level * kLevelShift);
    const int last = floorDivide((first_page + page_count) * page_cells, period);
    for (int image = floorDivide(first_page * page_cells, period); image <= last; ++image) {
      show(image * period + low, image * period + high);
      show((image + 1) * period - high, (image + 1) * period - low);
    }
    return pages;
  }
};

}  // namespace

void TerrainLevels::addNewCraters(const TerrainView& view, std::vector<LoadJob>& jobs) {
  const std::span<const Crater> craters = view.state->craters.records();
  const std::size_t before = crater_count_.value_or(craters.size());
  SPOOR_ASSERT(before <= craters.size());
  crater_count_ = craters.size();
  if (before == craters.size()) return;
  for (int level = 0; level < kLevelCount; ++level)
    addCratersOfLevel(view.base->pack(), craters.subspan(before), level, jobs);
}

/// One box a page, however many craters and mirror images it shows.
void TerrainLevels::addCratersOfLevel(const ScenePack& pack, std::span<const Crater> craters, int level,
                                      std::vector<LoadJob>& jobs) {
  const Level& l = levels_[std::size_t(level)];
  const Axis along_x{level, l.first_page.x, l.page_count, pack.width_cells};
  const Axis along_y{level, l.first_page.y, l.page_count, pack.height_cells};
  struct PageBox {
    Span x, y;
  };
  std::vector<PageBox> boxes(l.pages.size());
  for (const Crater& crater : craters) {
    const CellBox cells = craterBox(pack, crater);
    if (cells.empty()) continue;
    const std::vector<Span> columns = along_x.pagesShowing(cells.x0, cells.x1);
    const std::vector<Span> rows = along_y.pagesShowing(cells.y0, cells.y1);
    for (std::size_t y = 0; y < rows.size(); ++y) {
      for (std::size_t x = 0; x < columns.size(); ++x) {
        if (rows[y].empty() || columns[x].empty()) continue;
        boxes[y * columns.size() + x].x.include(columns[x]);
        boxes[y * columns.size() + x].y.include(rows[y]);
      }
    }
  }
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const glm::ivec2 page = l.first_page + glm::ivec2(int(i) % l.page_count, int(i) / l.page_count);
    const auto& [x, y] = boxes[i];
    if (x.empty() || !holds(level, page)) continue;  // a page that is not there yet is loaded as a whole
    jobs.push_back({level, page, {{x.low, y.low}, {x.high - x.low, y.high - y.low}}});
    stats.crater_samples += std::int64_t(x.high - x.low) * (y.high - y.low);
  }
}

}  // namespace spoor
