#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "client/camera.h"
#include "client/terrain_cover.h"
#include "client/terrain_view.h"
#include "shaders/host/gl_objects.h"
#include "shaders/render/frame.h"

namespace spoor {

/// What loading did since the last reset, for tests and the curious.
struct TerrainStats {
  std::int64_t pages_loaded = 0;      // pages filled because the window moved
  std::int64_t tiles_uploaded = 0;    // changed tiles sent to level 0
  std::int64_t crater_samples = 0;    // of loaded pages, filled again because craters came
  std::int64_t snow_pages = 0;        // loaded pages of dormant ground, filled again because it snowed
  std::int64_t samples_uploaded = 0;  // of all levels, by all four
  std::int64_t relief_samples = 0;    // recomputed by relief.comp
  std::int64_t blurred_samples = 0;   // by blur_slopes.comp, of all passes
  std::int64_t patches_drawn = 0;
};

struct TerrainSettings {
  int fine_pages = 32;    // tiles along a side of the finest window, even
  int coarse_pages = 12;  // pages along a side of each coarser window, even; see windowsNest
  // Samples along a patch of the finest level, a power of two from 4 to kFinePatchSamples: the mesh before tessellation
  // has a vertex for each. Coarser levels keep patches of 16 samples, each as wide as 4, 16, .. of the largest here.
  int fine_patch_samples = render::kFinePatchSamples;
  // Passes of the 3 x 3 Gaussian over the finest level's slopes, 0 .. kBlurPassesLimit. Coarser levels have none: 16
  // passes blur by 2.8 cells (standard deviation), which is less than the four cells over which level 1 averages.
  int blur_passes = 0;
  bool materials = false;  // whether cells have materials that look different
  // Stones that are cut out of the finest level near the eye: side, 0: none; how far they stand out; side of a
  // triangle.
  double stone_side_m = 0.0;
  double stone_height_m = 0.0;
  double stone_triangle_px = 4.0;
};

/// Side of the finest level's patches for a terrain of that many patches in a row (Persson's numVerticesPerRow):
/// the largest power of two with which a row of the world has at least `patches_per_row` of them, within 4 cells and
/// the 64 that tessellation can cut to single cells; 0 patches: 64.
int finePatchSamples(std::int32_t width_cells, std::int32_t patches_per_row);

/// One patch to draw, as the shaders read it: first cell x, y; level; flags.
using Patch = glm::ivec4;

/// The ground's heights, relief and cover on the graphics card: nested windows round a focus, each a torus of pages, so
/// that moving the focus loads only pages that came into view, a changed tile uploads only itself, and a new crater the
/// tiles that it meets. Pages on which it snows are loaded again, some in every frame, so that none lacks more than a
/// few millimetres; once it has stopped none lacks any.
class TerrainLevels {
 public:
  /// @param sun  unit vector towards the sun, z > 0
  TerrainLevels(const TerrainSettings& settings, double cell_m, const glm::dvec3& sun);

  /// True where every window lies inside the part of the next one that has not begun to turn into a coarser one.
  static bool windowsNest(int fine_pages, int coarse_pages);

  /// Brings the windows to the focus and their heights up to date. `changed`: tiles that differ from the last call's.
  /// Craters that the last call's state did not have yet are seen here; the others must be the same.
  void updateHeights(const TerrainView& view, glm::ivec2 focus_cell, std::span<const TileCoordinate> changed);
  /// And then their relief, where heights changed.
  void updateRelief();

  /// Throws everything away: for a view of another world, or one that went back in time.
  void forget();

  void bind() const;
  /// Whether there are cover maps: where there are materials, or it has snowed.
  bool hasCover() const { return has_cover_; }
  std::array<render::LevelWindow, render::kLevelCount> windows() const;

  /// Adds the patches that the camera may see.
  void collectPatches(const CameraFrame& camera, std::vector<Patch>& out) const;

  const TerrainSettings& settings() const { return settings_; }

  /// How far from the eye a camera's triangles are fine enough for stones [m]; 0: nowhere. Beyond, they are shaded
  /// only.
  double stoneReach(const CameraFrame& camera) const;

  /// Distance from the focus that the coarsest window covers on every side, in cells.
  int reachCells() const;

  /// The finest level's relief as relief.comp lays it out, row-major from the window's first sample, for tests.
  std::vector<glm::vec4> fineRelief() const;

  TerrainStats stats;

 private:
  struct HeightRange {
    std::int32_t lowest_q = 0, highest_q = 0;
    void include(const HeightRange& other) {
      lowest_q = std::min(lowest_q, other.lowest_q);
      highest_q = std::max(highest_q, other.highest_q);
    }
  };
  struct Page {
    glm::ivec2 at{0};
    bool loaded = false;
    HeightRange range;
    std::int32_t tick = 0;  // up to which dormant ground has its snow
  };
  struct Level {
    int page_count = 0;  // along a side
    glm::ivec2 first_page{0};
    bool placed = false;
    std::vector<Page> pages;       // torus, row-major [page_count * page_count]
    std::vector<SampleBox> dirty;  // samples changed since the relief was made
  };

  /// Samples of one page to be filled: all of it, or what craters changed.
  struct LoadJob {
    int level;
    glm::ivec2 page;
    SampleBox box;
  };

  void moveWindow(int level, glm::ivec2 focus_cell);
  void loadPages(const TerrainView& view);
  std::vector<LoadJob> missingPages() const;
  void addNewCraters(const TerrainView& view, std::vector<LoadJob>& jobs);
  void addSnowedPages(const TerrainView& view, std::vector<LoadJob>& jobs);
  std::int32_t snowMissing(const TerrainView& view, int level, const Page& page) const;
  void prepareCover(const TerrainView& view);
  void addCratersOfLevel(const ScenePack& pack, std::span<const Crater> craters, int level, std::vector<LoadJob>& jobs);
  void load(const TerrainView& view, std::span<const LoadJob> jobs);
  void uploadTile(const TerrainView& view, TileCoordinate at);
  void uploadBox(int level, const SampleBox& box, const std::int32_t* height_q);
  void uploadCover(int level, const SampleBox& box, const CoverSample* cover);
  void makeRelief(int level);
  void runRelief(int level, const SampleBox& box);
  void blurSlopes(const std::vector<SampleBox>& boxes);
  void dispatchJob(int level, const SampleBox& box, int pass);
  bool holds(int level, glm::ivec2 page) const;
  HeightRange rangeAround(int level, glm::ivec2 page) const;
  void collectLevel(int level, const CameraFrame& camera, std::vector<Patch>& out) const;
  void collectStonePatches(const CameraFrame& camera, std::vector<Patch>& out) const;
  bool cutsStones(const CameraFrame& camera, glm::ivec2 page) const;
  HeightRange rangeOf(int level, glm::ivec2 page) const;
  Page& slot(int level, glm::ivec2 page);
  const Page& slot(int level, glm::ivec2 page) const;

  TerrainSettings settings_;
  double cell_m_;
  glm::dvec3 sun_;
  std::array<Level, render::kLevelCount> levels_;
  std::optional<std::size_t> crater_count_;  // that the loaded pages hold
  bool has_cover_ = false;
  GlTexture fine_height_, coarse_height_, fine_relief_, coarse_relief_, fine_cover_, coarse_cover_;
  std::array<GlTexture, 2> blur_slopes_;  // between passes; level 0, where there are two or more
  GlBuffer relief_job_;
  GlProgram relief_program_, blur_program_;
};

}  // namespace spoor
