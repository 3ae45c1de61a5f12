// Which patches of the ground a camera may see: the part of TerrainLevels that runs every frame.
#include <algorithm>
#include <array>

#include "client/terrain_levels.h"
#include "shaders/rules/limits.h"

namespace spoor {

using namespace render;

namespace {

using Planes = std::array<glm::vec4, 6>;

/// The half spaces of a view, as (normal, distance): inside where dot(normal, p) + distance >= 0.
Planes planesOf(const glm::mat4& m) {
  const auto row = [&](int i) { return glm::vec4(m[0][i], m[1][i], m[2][i], m[3][i]); };
  return {row(3) + row(0), row(3) - row(0), row(3) + row(1), row(3) - row(1), row(3) - row(2), row(2)};
}

bool mayBeSeen(const Planes& planes, const glm::vec3& low, const glm::vec3& high) {
  for (const glm::vec4& plane : planes) {
    const glm::vec3 furthest(plane.x > 0 ? high.x : low.x, plane.y > 0 ? high.y : low.y, plane.z > 0 ? high.z : low.z);
    if (glm::dot(glm::vec3(plane), furthest) + plane.w < 0.0f) return false;
  }
  return true;
}

/// A level's patches as a grid: where they lie and which of them the finer window replaces.
struct PatchGrid {
  int side;        // patches along the window
  int per_page;    // patches along a page
  int side_cells;  // cells along a patch
  glm::ivec2 first_cell;
  glm::ivec2 hole_first{0}, hole_end{0};

  bool inHole(int x, int y) const { return x >= hole_first.x && x < hole_end.x && y >= hole_first.y && y < hole_end.y; }

  int flags(int x, int y, bool coarsest) const {
    int result = 0;
    if (!coarsest) result |= (x == 0) | (y == 0) << 1 | (x == side - 1) << 2 | (y == side - 1) << 3;
    return result * kRimEdges +
           (inHole(x - 1, y) | inHole(x, y - 1) << 1 | inHole(x + 1, y) << 2 | inHole(x, y + 1) << 3) * kHoleEdges;
  }
};

}  // namespace

TerrainLevels::HeightRange TerrainLevels::rangeAround(int level, glm::ivec2 page) const {
  HeightRange range = slot(level, page).range;
  for (int y = -1; y <= 1; ++y)
    for (int x = -1; x <= 1; ++x)
      if (const glm::ivec2 near = page + glm::ivec2(x, y); holds(level, near)) range.include(slot(level, near).range);
  return range;
}

/// What a page's patches may reach: with the neighbours, whose first samples end its last patches, and the level into
/// which this one may turn.
TerrainLevels::HeightRange TerrainLevels::rangeOf(int level, glm::ivec2 page) const {
  HeightRange range = rangeAround(level, page);
  if (level + 1 < kLevelCount) range.include(rangeAround(level + 1, {page.x >> kLevelShift, page.y >> kLevelShift}));
  return range;
}

double TerrainLevels::stoneReach(const CameraFrame& camera) const {
  const double spacing_m = settings_.stone_side_m / 2.0;
  if (cell_m_ / kStoneCuts > spacing_m) return 0.0;  // no triangles are as fine
  if (camera.orthographic) return spacing_m * camera.pixels_per_radian >= settings_.stone_triangle_px ? 1.0e6 : 0.0;
  return spacing_m * camera.pixels_per_radian / settings_.stone_triangle_px;
}

/// Is a page of level 0 cut finer than its cells? Never at the window's border.
bool TerrainLevels::cutsStones(const CameraFrame& camera, glm::ivec2 page) const {
  const double reach_m = stoneReach(camera);
  const glm::ivec2 in_window = page - levels_[0].first_page;
  const int last = levels_[0].page_count - 1;
  if (reach_m <= 0.0 || in_window.x < 1 || in_window.y < 1 || in_window.x >= last || in_window.y >= last) return false;
  if (camera.orthographic) return true;
  const HeightRange range = rangeOf(0, page);
  const auto placeOf = [&](glm::ivec2 corner, double rise_q) {
    return glm::dvec3(glm::dvec2(corner * kPageSamples - camera.origin_cell) * cell_m_,
                      (rise_q - camera.origin_height_q) / rules::kUnitsPerMetre);
  };
  const glm::dvec3 eye(camera.eye_rel);
  const glm::dvec3 nearest = glm::clamp(eye, placeOf(page, range.lowest_q), placeOf(page + 1, range.highest_q));
  return glm::distance(eye, nearest) < reach_m;
}

void TerrainLevels::collectPatches(const CameraFrame& camera, std::vector<Patch>& out) const {
  if (stoneReach(camera) > 0.0) collectStonePatches(camera, out);
  for (int level = 0; level < kLevelCount; ++level) collectLevel(level, camera, out);
}

/// Pages that show stones, in patches as small as tessellation needs them to be. Where they border on others both have
/// a vertex a cell.
void TerrainLevels::collectStonePatches(const CameraFrame& camera, std::vector<Patch>& out) const {
  const Planes planes = planesOf(camera.clip_from_rel);
  const Level& l = levels_[0];
  constexpr int kPerPage = kPageSamples / kStonePatchSamples;
  const auto rise_q = std::int32_t(settings_.stone_height_m * rules::kUnitsPerMetre) + 1;
  for (int i = 0; i < l.page_count * l.page_count; ++i) {
    const glm::ivec2 page = l.first_page + glm::ivec2(i % l.page_count, i / l.page_count);
    if (!cutsStones(camera, page)) continue;
    const HeightRange range = rangeOf(0, page);
    const auto corner = [&](glm::ivec2 cell, std::int32_t height_q) {
      const double rise_m = (double(height_q) - camera.origin_height_q) / rules::kUnitsPerMetre;
      return glm::vec3(glm::vec2(cell - camera.origin_cell) * float(cell_m_), float(rise_m));
    };
    const std::array<glm::ivec2, 4> beside{{{-1, 0}, {0, -1}, {1, 0}, {0, 1}}};
    int alone = 0;  // edges beyond which pages are not cut
    for (std::size_t edge = 0; edge < beside.size(); ++edge)
      alone |= int(!cutsStones(camera, page + beside[edge])) << edge;
    for (int y = 0; y < kPerPage; ++y) {
      for (int x = 0; x < kPerPage; ++x) {
        const glm::ivec2 first = page * kPageSamples + glm::ivec2(x, y) * kStonePatchSamples;
        if (!mayBeSeen(planes, corner(first, range.lowest_q),
                       corner(first + kStonePatchSamples, range.highest_q + rise_q)))
          continue;
        const int border = (x == 0) | (y == 0) << 1 | (x == kPerPage - 1) << 2 | (y == kPerPage - 1) << 3;
        out.emplace_back(first, 0, kStonePatch | (border & alone) * kCellEdges);
      }
    }
  }
}

void TerrainLevels::collectLevel(int level, const CameraFrame& camera, std::vector<Patch>& out) const {
  const Planes planes = planesOf(camera.clip_from_rel);
  const Level& l = levels_[std::size_t(level)];
  const bool coarsest = level + 1 == kLevelCount;
  const int stride = 1 << (level * kLevelShift);
  const int patch_samples = level == 0 ? settings_.fine_patch_samples : kCoarsePatchSamples;
  PatchGrid grid;
  grid.per_page = kPageSamples / patch_samples;
  grid.side = l.page_count * grid.per_page;
  grid.side_cells = patch_samples * stride;
  grid.first_cell = l.first_page * kPageSamples * stride;
  if (level > 0) {
    const Level& finer = levels_[std::size_t(level - 1)];
    const int finer_page_cells = kPageSamples * (stride >> kLevelShift);
    grid.hole_first = (finer.first_page * finer_page_cells - grid.first_cell) / grid.side_cells;
    grid.hole_end = grid.hole_first + finer.page_count * finer_page_cells / grid.side_cells;
  }

  const auto corner = [&](int x, int y, std::int32_t height_q) {
    const glm::ivec2 cell = grid.first_cell + glm::ivec2(x, y) * grid.side_cells - camera.origin_cell;
    const double rise_m = (double(height_q) - camera.origin_height_q) / rules::kUnitsPerMetre;
    return glm::vec3(glm::vec2(cell) * float(cell_m_), float(rise_m));
  };
  const bool stones = level == 0 && stoneReach(camera) > 0.0;
  const auto collect = [&](int x, int y, const HeightRange& range) {
    if (grid.inHole(x, y) || !mayBeSeen(planes, corner(x, y, range.lowest_q), corner(x + 1, y + 1, range.highest_q)))
      return;
    int flags = grid.flags(x, y, coarsest);
    if (stones) {
      // Edges that lie on a page's border, towards one that is cut finer.
      const glm::ivec2 own(x / grid.per_page, y / grid.per_page);
      const std::array<glm::ivec2, 4> beside{{{x - 1, y}, {x, y - 1}, {x + 1, y}, {x, y + 1}}};
      for (std::size_t edge = 0; edge < beside.size(); ++edge) {
        const glm::ivec2 next(beside[edge].x / grid.per_page, beside[edge].y / grid.per_page);
        if (next != own && cutsStones(camera, l.first_page + next)) flags |= kHoleEdges << edge;
      }
    }
    out.emplace_back(grid.first_cell + glm::ivec2(x, y) * grid.side_cells, level, flags);
  };
  for (int page = 0; page < l.page_count * l.page_count; ++page) {
    const glm::ivec2 in_window(page % l.page_count, page / l.page_count);
    const glm::ivec2 at = l.first_page + in_window;
    if (stones && cutsStones(camera, at)) continue;
    const HeightRange range = rangeOf(level, at);
    for (int y = 0; y < grid.per_page; ++y)
      for (int x = 0; x < grid.per_page; ++x)
        collect(in_window.x * grid.per_page + x, in_window.y * grid.per_page + y, range);
  }
}

}  // namespace spoor
