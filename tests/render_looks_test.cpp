// Ways to look at the ground: columns coloured by height, and marked tiles.
#include <cmath>
#include <set>

#include "client/figure_scene.h"
#include "shaders/render/height_colour.h"
#include "tests/render_rig.h"

namespace spoor {
namespace {

using namespace test;

/// 40 x 30 flat cells of 5 cm at height 0.
ScenePack smallFlatPack() {
  ScenePack pack = noisePack();
  pack.width_cells = 40;
  pack.height_cells = 30;
  pack.noise.lowest_q = pack.noise.highest_q = -pack.soil_depth_q;
  pack.paths = {{{{10000, 7500}}, 0, 0, 0}};
  pack.bodies.resize(1);
  return pack;
}

glm::ivec3 pixelAt(const Image& image, int x, int y) {
  const std::size_t i = std::size_t(y * image.width_px + x) * 4;
  return {image.rgba[i], image.rgba[i + 1], image.rgba[i + 2]};
}

/// Looks straight down so that a cell is ten pixels wide; the world's south-west corner is at (40, 30) from the
/// picture's.
Image columnsFromAbove(const ViewedWorld& world, const ColumnSettings& columns) {
  RenderSettings settings = smallSettings();
  settings.width_px = 480;
  settings.height_px = 360;
  settings.shade = Shade::columns;
  settings.columns = columns;
  settings.bodies = false;
  Camera camera = cameraLookingAt({1.0, 0.75, 20.0}, {1.0, 0.75, 0.0});
  camera.orthographic_height_m = 36 * 0.05;
  Renderer renderer(world.pack, settings);
  renderer.draw(world.view(), camera);
  return renderer.readPicture();
}
glm::ivec3 columnTop(const Image& image, int cell_x, int cell_y) {
  return pixelAt(image, 40 + cell_x * 10 + 5, image.height_px - (30 + cell_y * 10 + 5));
}

void expectNear(const glm::ivec3& is, const glm::vec3& wanted, const char* what) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(is[i], 255.0f * wanted[i], 1.1f) << what << ", channel " << i;
}

TEST_F(Render, ColumnsShowTheColourOfTheirHeight) {
  ViewedWorld world(smallFlatPack());
  addLiveTile(world.state, world.base, {0, 0}, 0);
  const auto height = [&](int x, int y) -> std::int32_t& {
    return world.state.tiles.find({0, 0})->height()[std::size_t(y * rules::kTileSize + x)];
  };
  height(3, 4) = -1000;
  height(39, 0) = 4000;
  height(20, 29) = 1234;
  height(21, 29) = -321;
  height(22, 29) = 90000;
  const Image image = columnsFromAbove(world, {-1000, 0, 4000});
  expectNear(columnTop(image, 3, 4), {0.13f, 0.17f, 0.52f}, "lowest");
  expectNear(columnTop(image, 10, 10), {0.93f, 0.92f, 0.84f}, "untouched");
  expectNear(columnTop(image, 39, 0), {0.60f, 0.05f, 0.10f}, "highest");
  expectNear(columnTop(image, 22, 29), {0.60f, 0.05f, 0.10f}, "beyond the highest");
  expectNear(columnTop(image, 20, 29), render::heightColour(0.5f + 0.5f * 1234.0f / 4000.0f), "between");
  expectNear(columnTop(image, 21, 29), render::heightColour(0.5f - 0.5f * 321.0f / 1000.0f), "below");
  // Beyond the world's border there is paper.
  for (const auto& [x, y] : {std::pair{-1, 3}, std::pair{40, 3}, std::pair{5, -1}, std::pair{5, 30}})
    expectNear(columnTop(image, x, y), glm::vec3(0.97f), "outside");
}

TEST_F(Render, ColumnsWithoutARangeTakeTheirAreas) {
  ViewedWorld world(smallFlatPack());
  addLiveTile(world.state, world.base, {0, 0}, 0);
  world.state.tiles.find({0, 0})->height()[5] = 300;
  const Image image = columnsFromAbove(world, {});
  expectNear(columnTop(image, 5, 0), render::heightColour(1.0f), "highest");
  expectNear(columnTop(image, 6, 0), render::heightColour(0.0f), "lowest");
}

TEST(ColumnCells, LieInTheWorldRoundTheFocus) {
  ViewedWorld world(noisePack());
  addLiveTile(world.state, world.base, {23, 21}, 0);
  world.state.tiles.find({23, 21})->height()[3 * 64 + 7] = 77777;
  const ColumnCells inside = columnCells(world.view(), {700, 600});
  EXPECT_EQ(inside.first, glm::ivec2(700 - 128, 600 - 128));
  EXPECT_EQ(inside.count, glm::ivec2(256));
  EXPECT_EQ(inside.height_q.front(), world.base.height(572, 472));
  const ColumnCells corner = columnCells(world.view(), {5000, 5000});
  EXPECT_EQ(corner.first + corner.count, glm::ivec2(world.pack.width_cells, world.pack.height_cells));
  const glm::ivec2 at = glm::ivec2(23 * 64 + 7, 21 * 64 + 3) - corner.first;
  EXPECT_EQ(corner.height_q[std::size_t(at.y * corner.count.x + at.x)], 77777);
}

TEST_F(Render, MarksLieOnTheirTilesAndNowhereElse) {
  ViewedWorld world(noisePack());
  world.state.poses.assign(world.pack.bodies.size(), Pose{});
  RenderSettings settings = smallSettings();
  settings.height_px = settings.width_px;
  Renderer renderer(world.pack, settings);
  Camera camera = fromAbove(world, glm::dvec2(9.5, 7.5) * 3.2, 100.0);
  camera.orthographic_height_m = 5.0 * 3.2;  // five tiles, 64 pixels each
  renderer.draw(world.view(), camera);
  const Image plain = renderer.readPicture();
  const std::array<TileCoordinate, 3> marked{{{9, 7}, {10, 7}, {8, 9}}};
  renderer.highlightTiles(marked);
  renderer.draw(world.view(), camera);
  const Image image = renderer.readPicture();
  std::size_t wrong = 0;
  for (int y = 0; y < image.height_px; ++y) {
    for (int x = 0; x < image.width_px; ++x) {
      if (x % 64 < 2 || x % 64 > 61 || y % 64 < 2 || y % 64 > 61) continue;  // lines
      const TileCoordinate tile{7 + x / 64, 9 - y / 64};
      const bool is_marked = std::ranges::find(marked, tile) != marked.end();
      const glm::ivec3 difference = pixelAt(image, x, y) - pixelAt(plain, x, y);
      wrong += is_marked ? difference.r - difference.b < 40 : difference != glm::ivec3(0);
    }
  }
  EXPECT_EQ(wrong, 0u);
  // A line where marks end, none between two marked tiles.
  EXPECT_GT(pixelAt(image, 2 * 64 + 1, 160).r - pixelAt(image, 2 * 64 + 1, 160).b, 170);
  EXPECT_LT(pixelAt(image, 3 * 64 + 1, 160).r - pixelAt(image, 3 * 64 + 1, 160).b, 120);
  renderer.highlightTiles({});
  renderer.draw(world.view(), camera);
  EXPECT_TRUE(renderer.readPicture().rgba == plain.rgba);
}

TEST(FigureScene, ABoxPressedInEachWayLeavesItsOwnContourAndAllSoil) {
  std::set<std::uint64_t> grounds;
  for (const Displacement way : {Displacement::iterative, Displacement::direct, Displacement::spread}) {
    for (const Metric metric : {Metric::euclidean, Metric::manhattan, Metric::chebyshev}) {
      FigureScene scene(pressedBoxPack(way, metric), makeNativeBackend());
      ASSERT_TRUE(scene.runTo(kPressedBoxTicks, pressedBoxPoses(scene.pack())));
      EXPECT_EQ(scene.state().ledger.error(), 0);
      grounds.insert(scene.state().tiles_hash);
      // The hole is as deep as the box went, and nothing is left in it.
      const Tile& tile = *scene.state().tiles.find({});
      const int middle = scene.pack().width_cells / 2;
      EXPECT_EQ(tile.height()[std::size_t(middle * rules::kTileSize + middle)], scene.state().poses[0].z_q);
    }
  }
  EXPECT_EQ(grounds.size(), 9u);
}

TEST(FigureScene, TellsTheTilesOfItsLastTick) {
  ScenePack pack = pressedBoxPack(Displacement::direct, Metric::euclidean);
  FigureScene scene(pack, makeNativeBackend());
  EXPECT_TRUE(scene.activeTiles().empty());
  ASSERT_TRUE(scene.runTo(3, pressedBoxPoses(pack)));
  EXPECT_EQ(scene.state().tick, 3);
  EXPECT_EQ(scene.activeTiles(), std::vector<TileCoordinate>{{}});  // the world is one tile
  EXPECT_EQ(scene.state().ledger.error(), 0);

  pack = noisePack();
  pack.parameters.active_areas = 0;
  FigureScene whole(pack, makeNativeBackend());
  ASSERT_TRUE(whole.runTo(1));
  EXPECT_EQ(whole.activeTiles().size(), std::size_t(24 * 22));
}

}  // namespace
}  // namespace spoor
