#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "client/body_renderer.h"
#include "client/camera.h"
#include "client/column_renderer.h"
#include "client/crater_colours.h"
#include "client/highlight.h"
#include "client/material_looks.h"
#include "client/png_file.h"
#include "client/terrain_levels.h"

namespace spoor {

/// columns: every cell round the focus as a vertical bar, coloured by its height, and nothing else of the ground.
enum class Shade { lit, normals, columns };

struct RenderSettings {
  int width_px = 1280;
  int height_px = 720;
  int sample_count = 4;            // of the multisampled target, 1 .. 8; clamped to what the renderer has
  int fine_pages = 32;             // tiles along a side of the window with full detail
  int coarse_pages = 12;           // pages of 64 samples along a side of each coarser one; see TerrainLevels
  double sun_azimuth_deg = 135.0;  // from east towards north: north-west, as in hill-shaded maps
  double sun_elevation_deg = 21.0;
  int blur_passes = -1;      // of the ground's normals, 0 .. 16; -1: as the pack says
  int patches_per_row = -1;  // of the ground's mesh, 0 .. 4096, see finePatchSamples; -1: as the pack says
  double triangle_px = 8.0;  // wanted side of a triangle on the screen
  int tessellation = 0;  // into how many parts each side of a patch is cut, a power of two, as far as its samples go
                         // [Gilardi et al.'s tessellation factor]; 0: as triangle_px asks for
  double detail = 1.0;   // strength of the grain finer than a cell, 0 .. 1
  Ground ground = Ground::scene;
  Shade shade = Shade::lit;
  ColumnSettings columns;
  bool bodies = true;  // whether they are drawn
};

/// Where the time of a picture goes; the card is waited for after each part, so that their sum is more than it takes.
struct FrameTimes {
  double heights_ms = 0;  // copying changed heights to the card
  double normals_ms = 0;  // relief and blur, where heights changed
  double draw_ms = 0;     // all the rest
};

/// Draws a world: ground, bodies, sky. Dormant ground follows the snow that falls on it a little late (TerrainLevels).
/// Needs a current GL 4.5 context for its whole life. Throws std::runtime_error where the driver lacks something or a
/// shader is wrong.
class Renderer {
 public:
  /// The pack must outlive this.
  Renderer(const ScenePack& pack, const RenderSettings& settings);

  /// Tells which tiles differ from the last picture's.
  void tilesChanged(std::span<const TileCoordinate> tiles);

  /// Tiles to mark on the ground from now on, and no others; columns show no marks.
  void highlightTiles(std::span<const TileCoordinate> tiles) { highlight_.set(tiles); }

  /// Draws into the renderer's own target. The same view and camera give the same picture, whatever was drawn before.
  /// @param times  not nullptr: filled in
  void draw(const TerrainView& view, const Camera& camera, FrameTimes* times = nullptr);

  /// Draws at another size from now on.
  void resize(int width_px, int height_px);

  /// Forgets the loaded ground and craters: for a view of an earlier state or another one.
  void forget();

  Image readPicture() const;

  /// Copies the picture to the window's framebuffer of the same size.
  void showInWindow() const;

  TerrainStats& stats() { return terrain_.stats; }
  const RenderSettings& settings() const { return settings_; }

 private:
  void makeTargets();
  void drawTerrain(const CameraFrame& frame);
  void composePicture();
  void fillFrame(std::span<const Pose> poses, const Camera& camera, const CameraFrame& frame);

  const ScenePack* pack_;
  RenderSettings settings_;
  double cell_m_;
  glm::dvec3 sun_;
  std::vector<render::MaterialLook> looks_;
  TerrainLevels terrain_;
  BodyRenderer bodies_;
  ColumnRenderer columns_;
  CraterColours craters_;
  Highlight highlight_;
  std::vector<TileCoordinate> changed_;
  std::vector<Patch> patches_;
  GlBuffer frame_block_, looks_block_, patch_buffer_;
  GlVertexArray patch_layout_, no_layout_;
  struct Programs {
    GlProgram terrain, picture;
  };
  const Programs& programs();
  std::array<Programs, 2> programs_;  // without and with cover maps, made when they are wanted
  GlTexture colour_, depth_;          // multisampled: bodies and the depth of all
  GlRenderbuffer picture_colour_;
  GlFramebuffer target_, picture_;
};

}  // namespace spoor
