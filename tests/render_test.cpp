// The renderer, headless, on whatever OpenGL 4.5 there is.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <random>

#include "client/mesh_surface.h"
#include "client/recording.h"
#include "client/renderer.h"
#include "client/views.h"
#include "shaders/host/gl_context.h"

namespace spoor {
namespace {

constexpr int kWorldCells = 1500;  // no multiple of a tile

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

ScenePack noisePack() {
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
ScenePack planePack() {
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

void addLiveTile(WorldState& state, const BaseTerrain& base, TileCoordinate at, int rut_depth_q) {
  Tile& tile = state.tiles.insert(makeTile(at, base, 1));
  for (int y = 0; y < rules::kTileSize; ++y)
    for (int x = 28; x < 36; ++x) {
      tile.height()[std::size_t(y * rules::kTileSize + x)] -= rut_depth_q;
      tile.ground -= rut_depth_q;
    }
}

/// A pack with what a view needs; nothing moves once it is made.
struct World {
  explicit World(ScenePack made) : pack(std::move(made)), base(pack) {
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

RenderSettings smallSettings() {
  RenderSettings settings;
  settings.width_px = 320;
  settings.height_px = 240;
  settings.fine_pages = 8;
  settings.coarse_pages = 8;
  return settings;
}

Camera fromAbove(const World& world, glm::dvec2 place_m, double height_m) {
  Camera camera = cameraLookingAt({place_m, groundHeight(world.view(), place_m) + height_m}, {place_m, 0.0});
  camera.focus_m = place_m;
  return camera;
}

std::size_t pixelsShowingSky(const Image& image) {
  std::size_t count = 0;
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) count += image.rgba[i] != 255;
  return count;
}

TEST_F(Render, GroundHasNoCracksFromAbove) {
  World world(noisePack());
  addLiveTile(world.state, world.base, {7, 6}, 2000);
  addLiveTile(world.state, world.base, {8, 6}, -3000);
  Renderer renderer(world.pack, smallSettings());
  std::mt19937 random(5);
  const auto between = [&](double low, double high) { return low + (high - low) * double(random() % 10000) / 9999.0; };
  for (int i = 0; i < 20; ++i) {
    // From inside one tile up to where all levels are in the picture, over the world and beyond its border.
    const glm::dvec2 place_m(between(-10.0, 85.0), between(-10.0, 80.0));
    Camera camera = fromAbove(world, place_m, std::pow(10.0, between(0.3, 2.8)));
    if (i % 4 == 3) camera.orthographic_height_m = between(5.0, 400.0);
    if (i % 2 == 1) camera.focus_m += glm::dvec2(between(-12.0, 12.0), between(-12.0, 12.0));
    renderer.draw(world.view(), camera);
    EXPECT_EQ(pixelsShowingSky(renderer.readPicture()), 0u) << "camera " << i;
  }
}

TEST_F(Render, NormalsOfAPlaneAreTheSameEverywhere) {
  World world(planePack());
  RenderSettings settings = smallSettings();
  settings.shade = Shade::normals;
  Renderer renderer(world.pack, settings);
  const glm::vec3 normal = glm::normalize(glm::vec3(-0.25f, -0.125f, 1.0f)) * 0.5f + 0.5f;
  // Around the corner of four tiles, after windows have moved over it so that it lies across the torus's seams, and
  // from high enough to see the borders between levels.
  for (const int tile : {10, 11, 12, 13, 14}) {
    for (const double height_m : {6.0, 25.0}) {
      renderer.draw(world.view(), fromAbove(world, glm::dvec2(tile * 64 * 0.05, 10 * 64 * 0.05), height_m));
      const Image image = renderer.readPicture();
      std::size_t wrong = 0;
      for (std::size_t i = 0; i < image.rgba.size(); ++i)
        if (i % 4 != 3) wrong += std::abs(float(image.rgba[i]) - 255.0f * normal[int(i % 4)]) > 1.6f;
      EXPECT_EQ(wrong, 0u) << "tile " << tile << " from " << height_m << " m";
    }
  }
}

TEST_F(Render, PictureDependsOnStateAndCameraAlone) {
  World world(noisePack());
  addLiveTile(world.state, world.base, {7, 6}, 2000);
  const Camera camera = trailsView(world.view(), 135.0);
  Renderer first(world.pack, smallSettings());
  first.draw(world.view(), camera);
  const Image alone = first.readPicture();
  // Elsewhere and back: the windows come from the other side.
  first.draw(world.view(), fromAbove(world, {60.0, 20.0}, 30.0));
  first.draw(world.view(), fromAbove(world, {28.0, 26.0}, 30.0));
  first.draw(world.view(), camera);
  EXPECT_TRUE(first.readPicture().rgba == alone.rgba);
  Renderer second(world.pack, smallSettings());
  second.draw(world.view(), camera);
  EXPECT_TRUE(second.readPicture().rgba == alone.rgba);
}

TEST_F(Render, ChangedTileIsUploadedAloneAndChangesThePictureThereOnly) {
  World world(noisePack());
  const TileCoordinate at{9, 7};
  addLiveTile(world.state, world.base, at, 0);
  world.state.poses.assign(world.pack.bodies.size(), Pose{});
  RenderSettings settings = smallSettings();
  settings.height_px = settings.width_px;
  Renderer renderer(world.pack, settings);
  const double tile_m = 64 * 0.05;
  Camera camera = fromAbove(world, glm::dvec2(at.x + 0.5, at.y + 0.5) * tile_m, 100.0);
  camera.orthographic_height_m = 5.0 * tile_m;  // five tiles, 64 pixels each
  renderer.draw(world.view(), camera);
  const Image before = renderer.readPicture();

  for (int y = 0; y < rules::kTileSize; ++y)
    for (int x = 24; x < 40; ++x) world.state.tiles.find(at)->height()[std::size_t(y * rules::kTileSize + x)] -= 1500;
  renderer.stats() = {};
  renderer.tilesChanged(std::array{at});
  renderer.draw(world.view(), camera);
  const Image after = renderer.readPicture();
  EXPECT_EQ(renderer.stats().tiles_uploaded, 1);
  EXPECT_EQ(renderer.stats().pages_loaded, 0);
  EXPECT_EQ(renderer.stats().samples_uploaded, 64 * 64 + 16 * 16 + 4 * 4 + 1);

  std::size_t changed_inside = 0, changed_outside = 0;
  for (int y = 0; y < after.height_px; ++y) {
    for (int x = 0; x < after.width_px; ++x) {
      const std::size_t i = std::size_t(y * after.width_px + x) * 4;
      const int difference = std::abs(after.rgba[i] - before.rgba[i]);
      // The tile and what its rim shades: a quarter of a tile around. Beyond, coarse levels may differ by a trace.
      const bool inside = std::abs(x - 160) <= 48 && std::abs(y - 160) <= 48;
      if (inside)
        changed_inside += difference > 8;
      else
        changed_outside += difference > 8;
    }
  }
  EXPECT_GT(changed_inside, 200u);
  EXPECT_EQ(changed_outside, 0u);
}

TEST_F(Render, FarFromTheWorldsCornerThePictureIsTheSame) {
  // East of its samples this ground is the same at every x: cells of 5 cm, and 160 km between the two cameras.
  ScenePack pack = planePack();
  pack.width_cells = 1 << 22;
  World world(pack);
  addLiveTile(world.state, world.base, {50, 8}, 2000);
  const int shift_tiles = 256 * 200;
  addLiveTile(world.state, world.base, {50 + shift_tiles, 8}, 2000);
  RenderSettings settings = smallSettings();
  settings.detail = 0.0;  // grain is bound to its cell
  Renderer renderer(world.pack, settings);
  Camera camera = cameraLookingAt({158.0, 23.0, 28.5}, {162.0, 27.3, 22.0});
  renderer.draw(world.view(), camera);
  const Image here = renderer.readPicture();
  EXPECT_LT(pixelsShowingSky(here), here.rgba.size() / 8);
  camera.eye_m.x += shift_tiles * 64 * 0.05;
  camera.focus_m.x += shift_tiles * 64 * 0.05;
  renderer.draw(world.view(), camera);
  const Image there = renderer.readPicture();
  std::size_t different = 0;
  for (std::size_t i = 0; i < here.rgba.size(); ++i) different += std::abs(here.rgba[i] - there.rgba[i]) > 3;
  EXPECT_LT(different, here.rgba.size() / 2000);
}

TEST(MeshSurface, SharpEdgesStaySharpAndFlatOnesAreShared) {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {10000, 0, 0}, {10000, 10000, 0}, {0, 10000, 0}, {0, 0, 10000}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 4, 1}};
  const auto points = surfaceOf(mesh, 40.0);
  ASSERT_EQ(points.size(), 9u);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(points[i].normal, glm::vec3(0.0f, 0.0f, 1.0f));
  for (std::size_t i = 6; i < 9; ++i) EXPECT_NEAR(points[i].normal.z, 0.0f, 1e-6f);
  EXPECT_EQ(points[1].point_m, glm::vec3(1.0f, 0.0f, 0.0f));
}

TEST(Recording, ReplaysTheTilesOfEachMomentHoweverLongTheSession) {
  World world(noisePack());
  const TileCoordinate at{3, 4};
  addLiveTile(world.state, world.base, at, 0);
  Recording recording(5);
  for (int tick = 0; tick <= 103; ++tick) {
    world.state.tick = tick;
    world.state.tiles.find(at)->height()[7] = tick;
    recording.add(world.state, std::array{at});
  }
  recording.finish(world.state);
  std::vector<std::int32_t> ticks;
  recording.replay(world.base, [&](int, const WorldState& state, std::span<const TileCoordinate> changed) {
    EXPECT_EQ(changed.size(), 1u);
    EXPECT_EQ(state.tiles.find(at)->height()[7], state.tick);
    ticks.push_back(state.tick);
    return true;
  });
  ASSERT_EQ(ticks.size(), 5u);
  EXPECT_EQ(ticks.back(), 103);
  for (std::size_t i = 1; i < ticks.size(); ++i) EXPECT_NEAR(ticks[i] - ticks[i - 1], 21, 9);
}

}  // namespace
}  // namespace spoor
