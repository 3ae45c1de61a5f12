#include "client/terrain_levels.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <thread>

#include "shaders/host/shader_loader.h"
#include "shared/base/assert.h"

namespace spoor {

using namespace render;

namespace {

constexpr std::size_t kPageCells = std::size_t(kPageSamples) * kPageSamples;
// An edge on the window's border is cut into a quarter of its samples, as the next level has vertices there.
constexpr int kFinePatchLowest = 1 << kLevelShift;
constexpr std::size_t kBatchPages = 256;  // filled side by side before they are uploaded

int floorDivide(int a, int b) { return a >= 0 ? a / b : -((b - 1 - a) / b); }
int floorModulo(int a, int b) { return a - floorDivide(a, b) * b; }
int strideOf(int level) { return 1 << (level * kLevelShift); }

/// Width of the band in which a level turns into the next; small windows have narrower ones.
int morphSamples(int level, int side) {
  return std::min(level == 0 ? kFineMorphSamples : kCoarseMorphSamples, side / 4);
}

GlTexture makeLayers(GLenum format, int side, int layers, GLint filter) {
  GlTexture texture = makeTexture(layers == 1 ? GL_TEXTURE_2D : GL_TEXTURE_2D_ARRAY);
  if (layers == 1)
    glTextureStorage2D(texture.name(), 1, format, side, side);
  else
    glTextureStorage3D(texture.name(), 1, format, side, side, layers);
  glTextureParameteri(texture.name(), GL_TEXTURE_MIN_FILTER, filter);
  glTextureParameteri(texture.name(), GL_TEXTURE_MAG_FILTER, filter);
  glTextureParameteri(texture.name(), GL_TEXTURE_WRAP_S, GL_REPEAT);
  glTextureParameteri(texture.name(), GL_TEXTURE_WRAP_T, GL_REPEAT);
  return texture;
}

/// Calls work(0 .. count - 1), spread over the machine's threads.
template <typename Work>
void forEachInParallel(std::size_t count, const Work& work) {
  std::atomic<std::size_t> next{0};
  const auto run = [&] {
    for (std::size_t i = next++; i < count; i = next++) work(i);
  };
  const std::size_t helpers = std::min<std::size_t>(count, std::max(1u, std::thread::hardware_concurrency())) - 1;
  std::vector<std::jthread> threads;
  for (std::size_t i = 0; i < helpers; ++i) threads.emplace_back(run);
  run();
}

}  // namespace

bool TerrainLevels::windowsNest(int fine_pages, int coarse_pages) {
  if (fine_pages < 2 || fine_pages > 64 || fine_pages % 2 != 0) return false;
  if (coarse_pages < 4 || coarse_pages > 64 || coarse_pages % 2 != 0) return false;
  // A window's middle lies within half a page of the focus.
  const auto furthest = [](int pages) { return (pages * kPageSamples + kPageSamples) / 2; };
  const int coarse_side = coarse_pages * kPageSamples;
  const int pure = (coarse_side - kPageSamples) / 2 - morphSamples(1, coarse_side);
  return std::max(furthest(fine_pages), furthest(coarse_pages)) <= pure << kLevelShift;
}

int finePatchSamples(std::int32_t width_cells, std::int32_t patches_per_row) {
  SPOOR_ASSERT(width_cells > 0 && patches_per_row >= 0);
  int side = kFinePatchSamples;
  while (side > kFinePatchLowest && std::int64_t(side) * patches_per_row > width_cells) side /= 2;
  return side;
}

TerrainLevels::TerrainLevels(const TerrainSettings& settings, double cell_m, const glm::dvec3& sun)
    : settings_(settings), cell_m_(cell_m), sun_(sun) {
  const int fine_pages = settings.fine_pages, coarse_pages = settings.coarse_pages;
  SPOOR_ASSERT(windowsNest(fine_pages, coarse_pages) && sun.z > 0.0);
  SPOOR_ASSERT(settings.blur_passes >= 0 && settings.blur_passes <= kBlurPassesLimit);
  SPOOR_ASSERT(std::has_single_bit(unsigned(settings.fine_patch_samples)) &&
               settings.fine_patch_samples >= kFinePatchLowest && settings.fine_patch_samples <= kFinePatchSamples);
  for (int level = 0; level < kLevelCount; ++level) {
    Level& l = levels_[std::size_t(level)];
    l.page_count = level == 0 ? fine_pages : coarse_pages;
    l.pages.resize(std::size_t(l.page_count) * std::size_t(l.page_count));
  }
  const int fine_side = fine_pages * kPageSamples;
  const int coarse_side = coarse_pages * kPageSamples;
  fine_height_ = makeLayers(GL_R32I, fine_side, 1, GL_NEAREST);
  coarse_height_ = makeLayers(GL_R32I, coarse_side, kLevelCount - 1, GL_NEAREST);
  fine_relief_ = makeLayers(GL_RGBA16F, fine_side, 1, GL_LINEAR);
  coarse_relief_ = makeLayers(GL_RGBA16F, coarse_side, kLevelCount - 1, GL_LINEAR);
  relief_job_ = makeBuffer();
  glNamedBufferStorage(relief_job_.name(), sizeof(ReliefJob), nullptr, GL_DYNAMIC_STORAGE_BIT);
  relief_program_ = makeProgram({"render/relief.comp"});
  if (settings.blur_passes > 0) blur_program_ = makeProgram({"render/blur_slopes.comp"});
  if (settings.blur_passes > 1)
    for (GlTexture& slopes : blur_slopes_) slopes = makeLayers(GL_RG32F, fine_side, 1, GL_NEAREST);
}

void TerrainLevels::forget() {
  crater_count_.reset();
  for (Level& level : levels_) {
    level.placed = false;
    for (Page& page : level.pages) page.loaded = false;
  }
}

void TerrainLevels::updateHeights(const TerrainView& view, glm::ivec2 focus_cell,
                                  std::span<const TileCoordinate> changed) {
  prepareCover(view);
  for (int level = 0; level < kLevelCount; ++level) moveWindow(level, focus_cell);
  // Changed tiles first: pages that are loaded below hold the newest heights anyway.
  for (const TileCoordinate at : changed) uploadTile(view, at);
  loadPages(view);
  bind();
}

/// Maps that show nothing are not there: bound are then those of one texel.
void TerrainLevels::prepareCover(const TerrainView& view) {
  const bool wanted = settings_.materials || !view.state->snowfalls.empty();
  if (fine_cover_.name() != 0 && (has_cover_ || !wanted)) return;
  const auto sideOf = [&](int level) { return wanted ? levels_[std::size_t(level)].page_count * kPageSamples : 1; };
  fine_cover_ = makeLayers(GL_RG8UI, sideOf(0), 1, GL_NEAREST);
  coarse_cover_ = makeLayers(GL_RG8UI, sideOf(1), kLevelCount - 1, GL_NEAREST);
  has_cover_ = wanted;
  if (wanted) forget();
}

void TerrainLevels::updateRelief() {
  for (int level = 0; level < kLevelCount; ++level) makeRelief(level);
}

/// A page is as large as a patch of the next level, so a window's border is one of that level's patches.
void TerrainLevels::moveWindow(int level, glm::ivec2 focus_cell) {
  Level& l = levels_[std::size_t(level)];
  static_assert(kPageSamples == kCoarsePatchSamples << kLevelShift);
  const int page_cells = kPageSamples * strideOf(level);
  const glm::ivec2 nearest(floorDivide(focus_cell.x + page_cells / 2, page_cells),
                           floorDivide(focus_cell.y + page_cells / 2, page_cells));
  const glm::ivec2 first = nearest - l.page_count / 2;
  if (l.placed && first == l.first_page) return;
  l.first_page = first;
  l.placed = true;
  // What left the window misses changes from now on, and its relief was made at the border: it must be loaded again.
  for (Page& page : l.pages) {
    const glm::ivec2 in_window = page.at - first;
    const int last = l.page_count - 1;
    if (in_window.x < 0 || in_window.y < 0 || in_window.x > last || in_window.y > last) page.loaded = false;
  }
  // The coarsest level shows its border, where relief depends on what the window held: made anew, so that a picture
  // depends on the camera alone.
  if (level == kLevelCount - 1) l.dirty = {{glm::ivec2(0), glm::ivec2(l.page_count * kPageSamples)}};
}

TerrainLevels::Page& TerrainLevels::slot(int level, glm::ivec2 page) {
  Level& l = levels_[std::size_t(level)];
  return l.pages[std::size_t(floorModulo(page.y, l.page_count) * l.page_count + floorModulo(page.x, l.page_count))];
}
const TerrainLevels::Page& TerrainLevels::slot(int level, glm::ivec2 page) const {
  return const_cast<TerrainLevels*>(this)->slot(level, page);
}

bool TerrainLevels::holds(int level, glm::ivec2 page) const {
  const Level& l = levels_[std::size_t(level)];
  const glm::ivec2 in_window = page - l.first_page;
  if (in_window.x < 0 || in_window.y < 0 || in_window.x >= l.page_count || in_window.y >= l.page_count) return false;
  const Page& p = slot(level, page);
  return p.loaded && p.at == page;
}

void TerrainLevels::loadPages(const TerrainView& view) {
  std::vector<LoadJob> jobs = missingPages();
  stats.pages_loaded += std::int64_t(jobs.size());
  addNewCraters(view, jobs);
  addSnowedPages(view, jobs);
  for (std::size_t done = 0; done < jobs.size(); done += kBatchPages)
    load(view, std::span(jobs).subspan(done, std::min(kBatchPages, jobs.size() - done)));
}

std::vector<TerrainLevels::LoadJob> TerrainLevels::missingPages() const {
  std::vector<LoadJob> jobs;
  for (int level = 0; level < kLevelCount; ++level) {
    const Level& l = levels_[std::size_t(level)];
    for (int y = 0; y < l.page_count; ++y)
      for (int x = 0; x < l.page_count; ++x)
        if (const glm::ivec2 page = l.first_page + glm::ivec2(x, y); !holds(level, page))
          jobs.push_back({level, page, {page * kPageSamples, glm::ivec2(kPageSamples)}});
  }
  return jobs;
}

void TerrainLevels::load(const TerrainView& view, std::span<const LoadJob> jobs) {
  std::vector<std::int32_t> height_q(jobs.size() * kPageCells);
  std::vector<CoverSample> cover(has_cover_ ? height_q.size() : 0);
  const auto samplesOf = [&](auto& all, std::size_t i) {
    const glm::ivec2 count = jobs[i].box.count;
    return std::span(all).subspan(i * kPageCells, std::size_t(count.x) * std::size_t(count.y));
  };
  forEachInParallel(jobs.size(), [&](std::size_t i) {
    fillSamples(view, jobs[i].level, jobs[i].box, samplesOf(height_q, i));
    if (has_cover_) fillCover(view, jobs[i].level, jobs[i].box, samplesOf(cover, i));
  });
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const LoadJob& job = jobs[i];
    const auto [lowest, highest] = std::ranges::minmax_element(samplesOf(height_q, i));
    HeightRange range{*lowest, *highest};
    const bool whole = job.box.count == glm::ivec2(kPageSamples);
    const Page* before = holds(job.level, job.page) ? &slot(job.level, job.page) : nullptr;
    if (before != nullptr) range.include(before->range);
    const std::int32_t tick = before != nullptr && !whole ? before->tick : view.state->tick;
    slot(job.level, job.page) = Page{job.page, true, range, tick};
    uploadBox(job.level, job.box, samplesOf(height_q, i).data());
    if (has_cover_) uploadCover(job.level, job.box, samplesOf(cover, i).data());
  }
}

void TerrainLevels::uploadTile(const TerrainView& view, TileCoordinate at) {
  std::array<std::int32_t, kPageCells> height_q;
  std::array<CoverSample, kPageCells> cover;
  for (int level = 0; strideOf(level) <= kPageSamples; ++level) {
    const int side = kPageSamples / strideOf(level);
    const SampleBox box{glm::ivec2(at.x, at.y) * side, glm::ivec2(side)};
    const glm::ivec2 page(floorDivide(box.first.x, kPageSamples), floorDivide(box.first.y, kPageSamples));
    if (!holds(level, page)) continue;
    const std::size_t count = std::size_t(side) * std::size_t(side);
    const auto heights = std::span(height_q).first(count);
    fillSamples(view, level, box, heights);
    uploadBox(level, box, heights.data());
    if (has_cover_) {
      fillCover(view, level, box, std::span(cover).first(count));
      uploadCover(level, box, cover.data());
    }
    const auto [lowest, highest] = std::ranges::minmax_element(heights);
    slot(level, page).range.include({*lowest, *highest});
    if (level == 0) ++stats.tiles_uploaded;
  }
}

/// A box never crosses a page, so it never wraps round the torus.
void TerrainLevels::uploadBox(int level, const SampleBox& box, const std::int32_t* height_q) {
  Level& l = levels_[std::size_t(level)];
  const int side = l.page_count * kPageSamples;
  const glm::ivec2 texel(floorModulo(box.first.x, side), floorModulo(box.first.y, side));
  if (level == 0)
    glTextureSubImage2D(fine_height_.name(), 0, texel.x, texel.y, box.count.x, box.count.y, GL_RED_INTEGER, GL_INT,
                        height_q);
  else
    glTextureSubImage3D(coarse_height_.name(), 0, texel.x, texel.y, level - 1, box.count.x, box.count.y, 1,
                        GL_RED_INTEGER, GL_INT, height_q);
  l.dirty.push_back({box.first - l.first_page * kPageSamples, box.count});
  stats.samples_uploaded += std::int64_t(box.count.x) * box.count.y;
}

void TerrainLevels::uploadCover(int level, const SampleBox& box, const CoverSample* cover) {
  const int side = levels_[std::size_t(level)].page_count * kPageSamples;
  const glm::ivec2 texel(floorModulo(box.first.x, side), floorModulo(box.first.y, side));
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  if (level == 0)
    glTextureSubImage2D(fine_cover_.name(), 0, texel.x, texel.y, box.count.x, box.count.y, GL_RG_INTEGER,
                        GL_UNSIGNED_BYTE, cover);
  else
    glTextureSubImage3D(coarse_cover_.name(), 0, texel.x, texel.y, level - 1, box.count.x, box.count.y, 1,
                        GL_RG_INTEGER, GL_UNSIGNED_BYTE, cover);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
}

void TerrainLevels::bind() const {
  glBindTextureUnit(kFineHeightUnit, fine_height_.name());
  glBindTextureUnit(kCoarseHeightUnit, coarse_height_.name());
  glBindTextureUnit(kFineReliefUnit, fine_relief_.name());
  glBindTextureUnit(kCoarseReliefUnit, coarse_relief_.name());
  glBindTextureUnit(kFineCoverUnit, fine_cover_.name());
  glBindTextureUnit(kCoarseCoverUnit, coarse_cover_.name());
}

std::array<LevelWindow, kLevelCount> TerrainLevels::windows() const {
  std::array<LevelWindow, kLevelCount> result;
  for (int level = 0; level < kLevelCount; ++level) {
    const Level& l = levels_[std::size_t(level)];
    const int side = l.page_count * kPageSamples;
    const glm::ivec2 first = l.first_page * kPageSamples;
    result[std::size_t(level)] = {{first * strideOf(level), side, level * kLevelShift},
                                  {floorModulo(first.x, side), floorModulo(first.y, side),
                                   level == 0 ? 0 : strideOf(level) / 2, morphSamples(level, side)}};
  }
  return result;
}

int TerrainLevels::reachCells() const {
  return (settings_.coarse_pages / 2 - 1) * kPageSamples * strideOf(kLevelCount - 1);
}

}  // namespace spoor
