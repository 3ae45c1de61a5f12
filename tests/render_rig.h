#pragma once

#include <gtest/gtest.h>

#include <cstdio>
#include <memory>

#include "client/renderer.h"
#include "client/views.h"
#include "shaders/host/gl_context.h"

/// What the tests of the renderer share: headless, on whatever OpenGL 4.5 there is.
namespace spoor::test {

inline constexpr int kWorldCells = 1500;  // no multiple of a tile

/// Skips, saying why, where there is no OpenGL at all.
class Render : public ::testing::Test {
 protected:
  void SetUp() override {
    auto opened = openHeadlessContext();
    if (!opened) GTEST_SKIP() << opened.error();
    context_ = std::move(*opened);
    std::printf("renderer %s (%s)\n", context_->renderer().c_str(), context_->path().c_str());
  }

  std::unique_ptr<GlContext> context_;
};

inline ScenePack noisePack() {
  ScenePack pack;
  pack.name = "render test";
  pack.width_cells = kWorldCells;
  pack.height_cells = kWorldCells - 100;
  pack.cell_q = 500;
  pack.soil_depth_q = 5000;
  pack.noise = {11, (std::int64_t(1) << 32) / 90, 4, 0, 40000};
  Mesh mesh;
  mesh.name = "wedge";
  mesh.vertices = {{-8000, -6000, 0}, {8000, -6000, 0}, {0, 9000, 0}, {0, 0, 9000}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  deriveEdges(mesh);
  pack.meshes.push_back(mesh);
  pack.paths.push_back({{{100000, 100000}, {300000, 300000}}, 100, 0, 0});
  pack.paths.push_back({{{100000, 300000}, {300000, 100000}}, 100, 0, 0});
  for (int i = 0; i < 2; ++i) {
    Body body;
    body.name = "wedge";
    body.path_index = i;
    pack.bodies.push_back(body);
  }
  return pack;
}

/// A pack whose ground is the plane z = x / 4 + y / 8.
inline ScenePack planePack() {
  ScenePack pack = noisePack();
  pack.bodies.clear();
  pack.base_kind = BaseKind::samples;
  pack.noise = {};
  pack.soil_depth_q = 0;
  const int side = 24;
  pack.samples.column_count = side;
  pack.samples.row_count = side;
  pack.samples.step_x_q32 = (std::int64_t(1) << 32) / 64;
  pack.samples.step_y_q32 = (std::int64_t(1) << 32) / 64;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) pack.samples.height_q.push_back(x * 64 * 500 / 4 + y * 64 * 500 / 8);
  return pack;
}

inline void addLiveTile(WorldState& state, const BaseTerrain& base, TileCoordinate at, int rut_depth_q) {
  Tile& tile = state.tiles.insert(makeTile(at, {&base}, 1));
  for (int y = 0; y < rules::kTileSize; ++y)
    for (int x = 28; x < 36; ++x) {
      tile.height()[std::size_t(y * rules::kTileSize + x)] -= rut_depth_q;
      tile.ground -= rut_depth_q;
    }
}

/// A pack with what a view needs; nothing moves once it is made.
struct ViewedWorld {
  explicit ViewedWorld(ScenePack made) : pack(std::move(made)), base(pack) {
    for (std::size_t i = 0; i < pack.bodies.size(); ++i) {
      Pose pose;
      pose.x_q = 240000 + int(i) * 30000;
      pose.y_q = 200000;
      pose.z_q = base.heightAt(pose.x_q, pose.y_q);
      state.poses.push_back(pose);
    }
    state.previous_poses = state.poses;
  }
  TerrainView view() const { return {&base, &state}; }

  ScenePack pack;
  BaseTerrain base;
  WorldState state;
};

inline RenderSettings smallSettings() {
  RenderSettings settings;
  settings.width_px = 320;
  settings.height_px = 240;
  settings.fine_pages = 8;
  settings.coarse_pages = 8;
  return settings;
}

inline Camera fromAbove(const ViewedWorld& world, glm::dvec2 place_m, double height_m) {
  Camera camera = cameraLookingAt({place_m, groundHeight(world.view(), place_m) + height_m}, {place_m, 0.0});
  camera.focus_m = place_m;
  return camera;
}

inline std::size_t pixelsShowingSky(const Image& image) {
  std::size_t count = 0;
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) count += image.rgba[i] != 255;
  return count;
}

}  // namespace spoor::test
