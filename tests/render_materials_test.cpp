// Materials, stones, snow and bodies that change size as they are drawn.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "client/drift_scenes.h"
#include "client/figure_scene.h"
#include "client/recording.h"
#include "client/terrain_levels.h"
#include "tests/render_rig.h"

namespace spoor {
namespace {

using namespace test;

constexpr std::int32_t kMetre_q = 10000;
constexpr double kCell_m = 0.05;

/// Level ground without bodies: material 0 in the west, 1 from x = kBorder_cells on.
constexpr int kBorder_cells = 700;
ScenePack flatPack(const std::vector<Material>& materials) {
  ScenePack pack = noisePack();
  pack.bodies.clear();
  pack.noise.lowest_q = pack.noise.highest_q = -pack.soil_depth_q;
  pack.materials = materials;
  pack.parameters.materials.resize(materials.size());
  if (materials.size() == 1) return pack;
  pack.material_map.kind = MaterialMapKind::image;
  MaterialImage& image = pack.material_map.image;
  image = {15, 1, (std::int64_t(1) << 32) / 100, 1, {}};
  for (int x = 0; x < image.column_count; ++x) image.material.push_back(x * 100 < kBorder_cells ? 0 : 1);
  return pack;
}

const Material kRed{"red", {200, 30, 30}, MaterialTexture::plain};
const Material kBlue{"blue", {30, 30, 200}, MaterialTexture::plain};

Camera straightDown(glm::dvec2 place_m, double height_m) {
  Camera camera = cameraLookingAt({place_m, 60.0}, {place_m, 0.0});
  camera.orthographic_height_m = height_m;
  return camera;
}

RenderSettings squareSettings() {
  RenderSettings settings = smallSettings();
  settings.width_px = settings.height_px = 192;
  return settings;
}

Image pictureOf(const ViewedWorld& world, const Camera& camera, const RenderSettings& settings) {
  Renderer renderer(world.pack, settings);
  renderer.draw(world.view(), camera);
  return renderer.readPicture();
}

glm::ivec3 pixelAt(const Image& image, int x, int y) {
  const std::size_t i = std::size_t(y * image.width_px + x) * 4;
  return {image.rgba[i], image.rgba[i + 1], image.rgba[i + 2]};
}
int redness(const Image& image, int x, int y) { return pixelAt(image, x, y).r - pixelAt(image, x, y).b; }

TEST_F(Render, OneMaterialOfManyLooksAsItDoesAlone) {
  const ViewedWorld alone(noisePack());
  const Camera camera = fromAbove(alone, {30.0, 28.0}, 4.0);
  const Image as_snow = pictureOf(alone, camera, smallSettings());
  RenderSettings snow = smallSettings();
  snow.ground = Ground::snow;
  EXPECT_TRUE(pictureOf(alone, camera, snow).rgba == as_snow.rgba) << "a pack that says nothing of materials";
  ScenePack pack = noisePack();
  pack.materials.push_back(kRed);
  pack.parameters.materials.resize(2);
  pack.material_map.kind = MaterialMapKind::rules;
  const ViewedWorld many(pack);
  EXPECT_TRUE(pictureOf(many, camera, snow).rgba == as_snow.rgba) << "--ground takes the place of all materials";
  const Image mapped = pictureOf(many, camera, smallSettings());
  // Shares are sums of weights, and a shader with other parts rounds a few pixels otherwise.
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < mapped.rgba.size(); ++i) wrong += std::abs(mapped.rgba[i] - as_snow.rgba[i]) > 1;
  EXPECT_LT(wrong, mapped.rgba.size() / 500);
}

TEST_F(Render, BordersOfMaterialsAreSoftAndShowNoCells) {
  ViewedWorld world(flatPack({kRed, kBlue}));
  const double border_m = kBorder_cells * kCell_m;
  addLiveTile(world.state, world.base, {kBorder_cells / 64, 8}, 0);  // half of the picture: the same ground, live
  const Image image = pictureOf(world, straightDown({border_m, 9 * 3.2}, 12 * kCell_m), squareSettings());
  const int cell_px = 192 / 12;
  std::vector<int> edges;
  int soft_sum = 0;
  for (int y = 0; y < image.height_px; ++y) {
    EXPECT_GT(redness(image, 8, y), 60) << "row " << y;
    EXPECT_LT(redness(image, 183, y), -60) << "row " << y;
    int soft = 0, edge = 0;
    for (int x = 0; x < image.width_px; ++x) {
      const int red = redness(image, x, y);
      soft += std::abs(red) < 50;
      edge += red > 0;
    }
    soft_sum += soft;
    EXPECT_LT(soft, 3 * cell_px) << "row " << y;
    EXPECT_NEAR(edge, 96, 2 * cell_px) << "row " << y;
    edges.push_back(edge);
  }
  EXPECT_GT(soft_sum / image.height_px, cell_px / 4);
  // It winds, by steps smaller than cells.
  EXPECT_GT(*std::ranges::max_element(edges) - *std::ranges::min_element(edges), cell_px / 4);
  for (std::size_t y = 1; y < edges.size(); ++y) EXPECT_LT(std::abs(edges[y] - edges[y - 1]), cell_px / 2);
  // From afar, where other levels show it, it lies where it lay.
  const Image far = pictureOf(world, straightDown({border_m, 9 * 3.2}, 192 * 8 * kCell_m), squareSettings());
  EXPECT_GT(redness(far, 90, 96), 60);
  EXPECT_LT(redness(far, 102, 96), -60);
}

TEST(Cover, DormantAndLiveTilesHaveTheSameMaterialsAtEveryLevel) {
  ViewedWorld world(flatPack({kRed, kBlue}));
  for (int level = 0; level <= 3; ++level) {
    const int side = 256 >> (2 * level);
    const SampleBox box{glm::ivec2(std::max(640 >> (2 * level), 0), 0), glm::ivec2(side)};
    std::vector<CoverSample> dormant(std::size_t(side * side)), live(dormant.size());
    fillCover(world.view(), level, box, dormant);
    ViewedWorld reached(flatPack({kRed, kBlue}));
    for (int x = 10; x < 14; ++x)
      for (int y = 0; y < 4; ++y) addLiveTile(reached.state, reached.base, {x, y}, 500);
    fillCover(reached.view(), level, box, live);
    EXPECT_TRUE(dormant == live) << "level " << level;
    if (level != 0) continue;
    EXPECT_EQ(std::ranges::count(dormant, CoverSample{1, 0}), 256 * (640 + 256 - kBorder_cells));
  }
}

/// Pebbles as large as two cells.
ScenePack pebblePack(std::int32_t height_q) {
  return flatPack({{"pebbles", {150, 145, 140}, MaterialTexture::pebbles, 1000, height_q}});
}

/// Rows of the picture in which ground is seen against the sky, from close over it.
std::vector<int> skylineOf(const Image& image) {
  std::vector<int> line;
  for (int x = 0; x < image.width_px; ++x) {
    int y = 0;
    while (y < image.height_px && image.rgba[std::size_t(y * image.width_px + x) * 4 + 3] < 128) ++y;
    line.push_back(y);
  }
  return line;
}

TEST_F(Render, PebblesStandOutOfTheGroundByTheirHeightAndNotAtNone) {
  // A step at the border of a live tile that lies higher: its edge is a skyline with what stands on it.
  const auto edge = [&](std::int32_t height_q, double detail) {
    ViewedWorld world(pebblePack(height_q));
    addLiveTile(world.state, world.base, {9, 8}, 0);
    for (std::int32_t& height : world.state.tiles.find({9, 8})->height()) height += 5 * kMetre_q;
    RenderSettings settings = smallSettings();
    settings.detail = detail;
    const glm::dvec3 target(9.5 * 3.2, 8 * 3.2 + 0.5, 5.0);
    Camera camera = cameraLookingAt(target + glm::dvec3(0.0, -1.5, 0.02), target);
    const std::vector<int> line = skylineOf(pictureOf(world, camera, settings));
    return double(std::accumulate(line.begin(), line.end(), 0)) / double(line.size());
  };
  const double smooth = edge(0, 1.0), pebbled = edge(400, 1.0);
  EXPECT_GT(smooth - pebbled, 2.0);  // of some 6 pixels that the highest stand out
  EXPECT_GT(pebbled - edge(800, 1.0), 2.0);
  EXPECT_NEAR(edge(400, 0.0), smooth, 0.1) << "without detail";
}

TEST_F(Render, PebblesLeaveNoCracks) {
  // As large as four cells, so that triangles at the border of what is cut finely are larger than a cell.
  ScenePack pack = noisePack();
  pack.bodies.clear();
  pack.materials = {{"pebbles", {150, 145, 140}, MaterialTexture::pebbles, 2000, 600}};
  ViewedWorld world(pack);
  addLiveTile(world.state, world.base, {9, 8}, 2000);
  addLiveTile(world.state, world.base, {10, 8}, -1500);
  Renderer renderer(world.pack, smallSettings());
  for (int i = 0; i < 12; ++i) {
    // Far from the border of what is cut finely, and close to it.
    const glm::dvec2 place_m(9.2 * 3.2 + 0.61 * i, 8.3 * 3.2 + 0.37 * i);
    Camera camera = fromAbove(world, place_m, 0.6 + 0.9 * i);
    const double ground_m = groundHeight(world.view(), place_m);
    if (i % 2 == 1)
      camera = cameraLookingAt({place_m, ground_m + 1.5}, {place_m + glm::dvec2(2.0, 1.0), ground_m - 2.0});
    camera.focus_m = place_m;
    renderer.draw(world.view(), camera);
    EXPECT_EQ(pixelsShowingSky(renderer.readPicture()), 0u) << "camera " << i;
  }
}

/// The flat pack with 20 ticks of snow, 2 mm each.
ScenePack snowPack() {
  ScenePack pack = flatPack({{"mud", {60, 45, 35}, MaterialTexture::plain}});
  Snowfall snowfall;
  snowfall.area = {0, 0, pack.width_cells, pack.height_cells};
  snowfall.rate_q32 = std::int64_t(20) << 32;
  snowfall.first_tick = 1;
  snowfall.last_tick = 20;
  snowfall.seed = 3;
  pack.snowfalls.push_back(snowfall);
  return pack;
}

struct SnowWorld : ViewedWorld {
  explicit SnowWorld(std::int32_t tick) : ViewedWorld(snowPack()) {
    state.snowfalls = pack.snowfalls;
    state.tick = tick;
    // As live tiles are that became so before it snowed.
    addLiveTile(state, base, {9, 8}, 0);
    height() = makeTile({9, 8}, dormantGround(state, base), 1)->height();
  }
  PlaneCells& height() { return state.tiles.find({9, 8})->height(); }
};

TEST_F(Render, SnowOnLiveAndDormantGroundIsLevelAndWhite) {
  const SnowWorld before(0);
  SnowWorld world(60);
  for (int level = 0; level < render::kLevelCount; ++level) {
    const SampleBox box{glm::ivec2((9 << 6) >> (2 * level), (8 << 6) >> (2 * level)) / 64 * 64, glm::ivec2(64)};
    std::vector<std::int32_t> height_q(64 * 64);
    fillSamples(world.view(), level, box, height_q);
    const auto [low, high] = std::ranges::minmax_element(height_q);
    EXPECT_GE(*low, 400) << "level " << level;
    EXPECT_LE(*high, 402) << "level " << level;
  }
  const auto brightness = [](const Image& image, int x, int y) {
    const glm::ivec3 pixel = pixelAt(image, x, y);
    return pixel.r + pixel.g + pixel.b;
  };
  const Camera camera = straightDown(glm::dvec2(9.0, 8.5) * 3.2, 4.0);  // the live tile's western border
  const Image bare = pictureOf(before, camera, squareSettings()), white = pictureOf(world, camera, squareSettings());
  EXPECT_LT(brightness(bare, 40, 96), 300);
  EXPECT_GT(brightness(white, 40, 96), 450);
  for (int y = 0; y < 192; y += 5) EXPECT_NEAR(brightness(white, 90, y), brightness(white, 102, y), 40) << "row " << y;
  // A rut deeper than what fell shows what lies beneath.
  for (int y = 0; y < 64; ++y)
    for (int x = 8; x < 16; ++x) world.height()[std::size_t(y * 64 + x)] -= 800;
  const Image rutted = pictureOf(world, camera, squareSettings());
  EXPECT_LT(brightness(rutted, 96 + int(12 * kCell_m * 48), 96), 350);
  EXPECT_GT(brightness(rutted, 96 + int(24 * kCell_m * 48), 96), 450);
}

TEST_F(Render, LoadedGroundFollowsTheSnowAndEndsUpAsIfLoadedAnew) {
  SnowWorld world(0);
  const Camera camera = fromAbove(world, {30.0, 28.0}, 4.0);
  RenderSettings settings = smallSettings();
  settings.width_px = 96;
  settings.height_px = 72;
  Renderer renderer(world.pack, settings);
  renderer.draw(world.view(), camera);
  const std::array<TileCoordinate, 1> live{{{9, 8}}};
  renderer.stats() = {};
  for (int tick = 1; tick <= 70; ++tick) {
    world.state.tick = tick;
    world.height() = makeTile({9, 8}, dormantGround(world.state, world.base), 1)->height();
    renderer.tilesChanged(live);
    renderer.draw(world.view(), camera);
  }
  EXPECT_EQ(renderer.stats().pages_loaded, 0);
  const std::int64_t page_count = 8 * 8 * 5;
  EXPECT_GE(renderer.stats().snow_pages, page_count);
  EXPECT_LE(renderer.stats().snow_pages, 12 * page_count);  // 4 cm by 4 mm, and the last
  EXPECT_TRUE(renderer.readPicture().rgba == pictureOf(world, camera, settings).rgba);
  const std::int64_t loaded = renderer.stats().snow_pages;
  renderer.draw(world.view(), camera);
  EXPECT_EQ(renderer.stats().snow_pages, loaded) << "it snows no more";
}

TEST_F(Render, BodiesAreDrawnAsLargeAsTheirScale) {
  ViewedWorld world(noisePack());
  const auto extent = [&](std::int32_t scale_q16) {
    Pose far;
    far.x_q = 10 * kMetre_q;
    far.y_q = 10 * kMetre_q;
    Pose& pose = world.state.poses[0];
    pose = {};
    pose.x_q = pose.y_q = 30 * kMetre_q;
    pose.z_q = 12 * kMetre_q;
    pose.scale_q16 = scale_q16;
    world.state.poses[1] = far;
    const Camera camera = straightDown({30.0, 30.15}, 2.4);
    RenderSettings with = squareSettings();
    with.sun_elevation_deg = 89.9;  // its shadow lies beneath it
    RenderSettings without = with;
    without.bodies = false;
    const Image image = pictureOf(world, camera, with), ground = pictureOf(world, camera, without);
    int first = 192, last = -1;
    for (int y = 0; y < 192; ++y) {
      for (int x = 0; x < 192; ++x) {
        const glm::ivec3 difference = glm::abs(pixelAt(image, x, y) - pixelAt(ground, x, y));
        if (difference.r + difference.g + difference.b < 60) continue;
        first = std::min(first, x);
        last = std::max(last, x);
      }
    }
    return last - first + 1;
  };
  // The wedge is 1.6 m wide at its foot.
  const double pixel = 192 / 2.4;
  EXPECT_NEAR(extent(kFullScale), 1.6 * pixel, 2.0);
  EXPECT_NEAR(extent(kFullScale / 4), 0.4 * pixel, 2.0);
}

TEST(Recording, ReplaysTheSnowThatEveryMomentHad) {
  SnowWorld world(0);
  Recording recording(3);
  for (const int tick : {5, 10, 40}) {
    world.state.tick = tick;
    if (tick == 10) world.state.snowfalls.push_back(world.state.snowfalls[0]);
    recording.add(world.state, {});
  }
  recording.finish(world.state);
  std::vector<std::pair<std::int32_t, std::size_t>> seen;
  recording.replay(world.base, [&](int, const WorldState& state, std::span<const TileCoordinate>) {
    seen.emplace_back(state.tick, state.snowfalls.size());
    return true;
  });
  EXPECT_EQ(seen, (std::vector<std::pair<std::int32_t, std::size_t>>{{5, 1}, {10, 2}, {40, 2}}));
}

TEST(DriftScenes, AreWorldsThatRunAndKeepTheirSoil) {
  using enum DriftMaterial;
  for (const ScenePack& pack : {driftTracksPack({mud}), driftTracksPack({mud, pebbles, sand}), snowedTracksPack(),
                                growingBallPack(), driftMeasurePack(512)}) {
    ASSERT_TRUE(validatePack(pack)) << pack.name;
    FigureScene scene(pack, makeNativeBackend());
    ASSERT_TRUE(scene.runTo(4)) << pack.name;
    EXPECT_EQ(scene.state().ledger.error(), 0) << pack.name;
    EXPECT_GT(scene.state().tiles.size(), 0u) << pack.name;
  }
}

}  // namespace
}  // namespace spoor
