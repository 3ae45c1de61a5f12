// The renderer, headless: the ground as a whole.
#include <cmath>
#include <random>

#include "client/mesh_surface.h"
#include "client/recording.h"
#include "tests/render_rig.h"

namespace spoor {
namespace {

using namespace test;

TEST_F(Render, GroundHasNoCracksFromAbove) {
  ViewedWorld world(noisePack());
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
  ViewedWorld world(planePack());
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
  ViewedWorld world(noisePack());
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
  ViewedWorld world(noisePack());
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
  ViewedWorld world(pack);
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
  ViewedWorld world(noisePack());
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
