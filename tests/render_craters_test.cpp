// Craters as they are drawn: heights of all levels, what came since, colours, recordings.
#include <algorithm>
#include <cmath>

#include "client/figure_scene.h"
#include "client/recording.h"
#include "client/terrain_levels.h"
#include "tests/render_rig.h"

namespace spoor {
namespace {

using namespace test;

constexpr std::int32_t kMetre_q = 10000;

ScenePack craterPack() {
  ScenePack pack = noisePack();
  pack.bodies.clear();
  pack.crater_limits.radius_q = 20 * kMetre_q;
  pack.crater_limits.hash_cell_q = 8 * kMetre_q;
  return pack;
}

/// The same without any slope.
ScenePack flatCraterPack() {
  ScenePack pack = craterPack();
  pack.soil_depth_q = 5 * kMetre_q;
  pack.noise.lowest_q = pack.noise.highest_q = -pack.soil_depth_q;
  return pack;
}

Crater craterAt(double x_m, double y_m, double crest_m) {
  Crater crater;
  crater.x_q = std::int32_t(x_m * kMetre_q);
  crater.y_q = std::int32_t(y_m * kMetre_q);
  crater.crest_radius_q = std::int32_t(crest_m * kMetre_q);
  crater.inner_radius_q = crater.crest_radius_q / 2;
  crater.depth_q = crater.crest_radius_q / 4;
  crater.rim_height_q = crater.crest_radius_q / 8;
  crater.noise_seed = 77;
  crater.noise_q16 = 16000;
  crater.tick = 1;
  return crater;
}

struct CraterWorld : ViewedWorld {
  explicit CraterWorld(ScenePack made, std::span<const Crater> craters = {}) : ViewedWorld(std::move(made)) {
    state.craters = CraterSet(pack);
    add(craters);
  }
  void add(std::span<const Crater> craters) {
    for (Crater crater : craters) {
      crater.id = std::uint32_t(state.craters.size());
      state.craters.add({&crater, 1});
    }
  }
  void addLive(TileCoordinate at) { state.tiles.insert(makeTile(at, {&base, &state.craters}, 1)); }
};

RenderSettings plainSettings() {
  RenderSettings settings = smallSettings();
  settings.width_px = settings.height_px = 192;
  return settings;
}

Image pictureOf(const CraterWorld& world, const Camera& camera, const RenderSettings& settings) {
  Renderer renderer(world.pack, settings);
  renderer.draw(world.view(), camera);
  return renderer.readPicture();
}

Camera straightDown(glm::dvec2 place_m, double height_m) {
  Camera camera = cameraLookingAt({place_m, 60.0}, {place_m, 0.0});
  camera.orthographic_height_m = height_m;
  return camera;
}

int brightness(const Image& image, int x, int y) {
  const std::size_t i = std::size_t(y * image.width_px + x) * 4;
  return image.rgba[i] + image.rgba[i + 1] + image.rgba[i + 2];
}

std::size_t differentPixels(const Image& a, const Image& b) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.rgba.size(); i += 4)
    count += !std::equal(a.rgba.begin() + std::ptrdiff_t(i), a.rgba.begin() + std::ptrdiff_t(i) + 4,
                         b.rgba.begin() + std::ptrdiff_t(i));
  return count;
}

TEST(CraterHeights, DormantSamplesOfEveryLevelAreTheBaseAndTheCratersAtTheirMiddleCell) {
  const std::array craters{craterAt(30.0, 28.0, 6.0), craterAt(34.0, 30.0, 5.0), craterAt(1.0, 70.0, 3.0)};
  const CraterWorld world(craterPack(), craters);
  const DormantGround dormant{&world.base, &world.state.craters};
  for (int level = 0; level < render::kLevelCount; ++level) {
    const int stride = 1 << (2 * level), middle = level == 0 ? 0 : stride / 2;
    const int side = std::max(64, 2048 / stride);  // to beyond the world's border, which lies at 1500 and 1400
    std::vector<std::int32_t> height_q(std::size_t(side) * std::size_t(side));
    fillSamples(world.view(), level, {glm::ivec2(0), glm::ivec2(side)}, height_q);
    std::size_t wrong = 0, lowered = 0;
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) {
        glm::ivec2 cell = glm::ivec2(x, y) * stride + middle;
        const glm::ivec2 size(world.pack.width_cells, world.pack.height_cells), period = 2 * size;
        cell -= cell / period * period;
        for (int axis = 0; axis < 2; ++axis)
          if (cell[axis] >= size[axis]) cell[axis] = period[axis] - 1 - cell[axis];
        wrong += height_q[std::size_t(y * side + x)] != dormant.height(cell.x, cell.y);
        lowered += height_q[std::size_t(y * side + x)] < world.base.height(cell.x, cell.y);
      }
    }
    EXPECT_EQ(wrong, 0u) << "level " << level;
    EXPECT_GT(lowered, 0u) << "level " << level;
  }
}

TEST(CraterHeights, ALiveTileShowsItsCratersOnce) {
  const std::array craters{craterAt(22.4, 22.4, 6.0)};
  CraterWorld world(flatCraterPack(), craters);  // over tile (7, 7) and more
  world.addLive({7, 7});
  std::vector<std::int32_t> live_q(16 * 16), dormant_q(16 * 16);
  fillSamples(world.view(), 1, {glm::ivec2(7 * 16), glm::ivec2(16)}, live_q);
  const CraterWorld untouched(flatCraterPack(), craters);
  fillSamples(untouched.view(), 1, {glm::ivec2(7 * 16), glm::ivec2(16)}, dormant_q);
  EXPECT_LT(*std::ranges::min_element(live_q), -kMetre_q / 2);
  for (std::size_t i = 0; i < live_q.size(); ++i)  // a mean of 4 x 4 cells of 5 cm, against the middle
    EXPECT_NEAR(live_q[i], dormant_q[i], 1200) << "sample " << i;
}

TEST(CraterHeights, LiveAndDormantCellsMeetWithoutAStep) {
  const std::array craters{craterAt(25.6, 25.6, 8.0)};  // on the corner of four tiles
  CraterWorld world(craterPack(), craters);
  world.addLive({7, 7});
  const CraterWorld dormant(craterPack(), craters);
  std::vector<std::int32_t> height_q(256 * 256), wanted_q(256 * 256);
  fillSamples(world.view(), 0, {glm::ivec2(6 * 64), glm::ivec2(256)}, height_q);
  fillSamples(dormant.view(), 0, {glm::ivec2(6 * 64), glm::ivec2(256)}, wanted_q);
  EXPECT_EQ(height_q, wanted_q);
}

TEST(CraterHeights, AViewStandsOnTheCratersFloor) {
  const CraterWorld world(flatCraterPack(), std::array{craterAt(30.0, 30.0, 6.0)});
  EXPECT_NEAR(groundHeight(world.view(), {30.0, 30.0}), -1.5, 0.02);
  EXPECT_NEAR(groundHeight(world.view(), {45.0, 30.0}), 0.0, 1e-9);
  const Camera inside = craterView(world.view(), 0, CraterLook::inside, 135.0, 1.5);
  EXPECT_LT(glm::distance(glm::dvec2(inside.eye_m), glm::dvec2(30.0)), 3.0);
  EXPECT_NEAR(inside.eye_m.z - groundHeight(world.view(), glm::dvec2(inside.eye_m)), 1.7, 1e-6);
}

TEST_F(Render, ACraterThatCameLaterLooksAsIfItHadAlwaysBeenThere) {
  // One inside, one over the world's corner, whose mirror images lie beyond the border; and one in a live tile.
  const std::array first{craterAt(30.0, 30.0, 4.0)};
  const std::array later{craterAt(33.0, 31.0, 3.0), craterAt(0.5, 1.0, 5.0), craterAt(22.0, 23.0, 2.0)};
  CraterWorld grown(craterPack(), first);
  CraterWorld whole(craterPack(), first);
  whole.add(later);
  whole.addLive({7, 7});
  std::vector<Camera> cameras{fromAbove(grown, {30.0, 28.0}, 25.0), fromAbove(grown, {2.0, 2.0}, 300.0)};
  cameras.push_back(cameraLookingAt({20.0, 12.0, 9.0}, {24.0, 26.0, 2.0}));
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    CraterWorld world(craterPack(), first);
    Renderer renderer(world.pack, plainSettings());
    renderer.draw(world.view(), cameras[i]);
    const Image before = renderer.readPicture();
    renderer.stats() = {};
    world.add(later);
    world.addLive({7, 7});
    renderer.tilesChanged(std::array{TileCoordinate{7, 7}});
    renderer.draw(world.view(), cameras[i]);
    EXPECT_EQ(renderer.stats().pages_loaded, 0);
    EXPECT_GT(renderer.stats().crater_samples, 0);
    const Image after = renderer.readPicture();
    EXPECT_EQ(differentPixels(after, pictureOf(whole, cameras[i], plainSettings())), 0u) << "camera " << i;
    EXPECT_GT(differentPixels(after, before), 100u) << "camera " << i;
  }
}

TEST_F(Render, AStateWithFewerOrOtherCratersIsLoadedAnew) {
  CraterWorld world(craterPack(), std::array{craterAt(30.0, 30.0, 4.0), craterAt(33.0, 31.0, 3.0)});
  const CraterWorld fewer(craterPack(), std::array{craterAt(30.0, 30.0, 4.0)});
  const CraterWorld other(craterPack(), std::array{craterAt(27.0, 30.0, 4.0), craterAt(33.0, 30.0, 3.0)});
  const Camera camera = fromAbove(world, {30.0, 28.0}, 25.0);
  Renderer renderer(world.pack, plainSettings());
  for (const CraterWorld* shown : {static_cast<const CraterWorld*>(&world), &fewer, &other, &fewer}) {
    // The renderer knows the world's pack; a view of it with another's state.
    renderer.draw({&world.base, &shown->state}, camera);
    EXPECT_EQ(differentPixels(renderer.readPicture(), pictureOf(*shown, camera, plainSettings())), 0u);
  }
}

TEST_F(Render, ANewCraterLoadsTheTilesItMeetsAndNoOthers) {
  CraterWorld world(craterPack());
  TerrainLevels levels({8, 8, render::kFinePatchSamples, 0}, 0.05, glm::normalize(glm::dvec3(-1.0, 0.7, 0.4)));
  levels.updateHeights(world.view(), {600, 560}, {});
  levels.stats = {};
  world.add(std::array{craterAt(30.0, 28.0, 1.0)});  // cells 570 .. 630 x 530 .. 590: tiles 8 .. 9 x 8 .. 9
  levels.updateHeights(world.view(), {600, 560}, {});
  EXPECT_EQ(levels.stats.pages_loaded, 0);
  EXPECT_EQ(levels.stats.crater_samples, levels.stats.samples_uploaded);
  // Four tiles of level 0 and of level 1; the coarser ones hold mirror images of the small world as well.
  EXPECT_GE(levels.stats.crater_samples, 4 * 64 * 64 + 4 * 16 * 16);
  levels.stats = {};
  levels.updateHeights(world.view(), {600, 560}, {});
  EXPECT_EQ(levels.stats.samples_uploaded, 0);

  ScenePack large = craterPack();
  large.width_cells = large.height_cells = 1 << 21;
  CraterWorld wide(large);
  TerrainLevels far({8, 8, render::kFinePatchSamples, 0}, 0.05, glm::normalize(glm::dvec3(-1.0, 0.7, 0.4)));
  const glm::ivec2 focus(1 << 20);
  far.updateHeights(wide.view(), focus, {});
  far.stats = {};
  wide.add(std::array{craterAt(4000.0, 4000.0, 9.0)});  // 68 km away
  far.updateHeights(wide.view(), focus, {});
  EXPECT_EQ(far.stats.samples_uploaded, 0);
  const double middle_m = (1 << 20) * 0.05;
  wide.add(std::array{craterAt(middle_m + 1.0, middle_m + 1.0, 0.5)});  // in one tile
  far.updateHeights(wide.view(), focus, {});
  EXPECT_EQ(far.stats.samples_uploaded, 64 * 64 + 16 * 16 + 4 * 4 + 1);  // none of level 4 lies on it
}

TEST_F(Render, ColourInsideACraterDiffersAndEndsAtItsBorder) {
  const double outer_m = 1.5 * 5.0;
  Crater crater = craterAt(30.0, 30.0, 5.0);
  crater.depth_q = crater.rim_height_q = crater.noise_q16 = 0;  // colour alone
  for (const Ground ground : {Ground::snow, Ground::sand, Ground::mud, Ground::dirt, Ground::grass}) {
    RenderSettings settings = plainSettings();
    settings.ground = ground;
    const Camera camera = straightDown({30.0, 30.0}, 24.0);
    const CraterWorld none(flatCraterPack());
    const CraterWorld one(flatCraterPack(), std::array{crater});
    const Image plain = pictureOf(none, camera, settings), image = pictureOf(one, camera, settings);
    std::size_t inside = 0, core = 0, outside = 0;
    int strongest_at_border = 0, darker = 0;
    for (int y = 0; y < 192; ++y) {
      for (int x = 0; x < 192; ++x) {
        const double away_m = std::hypot(x + 0.5 - 96.0, y + 0.5 - 96.0) / 8.0;
        const int change = std::abs(brightness(image, x, y) - brightness(plain, x, y));
        core += away_m < 2.0;
        darker += away_m < 2.0 ? 2 * brightness(image, x, y) < brightness(plain, x, y) : 0;
        inside += away_m < 2.0 && change > 20;
        outside += away_m > outer_m + 0.1 && change > 0;
        if (away_m > outer_m - 0.08 && away_m < outer_m) strongest_at_border = std::max(strongest_at_border, change);
      }
    }
    EXPECT_GT(inside, core * 95 / 100) << "ground " << int(ground);
    const bool dark_already = ground == Ground::mud;
    EXPECT_GT(darker, dark_already ? 0 : int(core) * 9 / 10) << "ground " << int(ground);
    EXPECT_EQ(outside, 0u) << "ground " << int(ground);
    EXPECT_LT(strongest_at_border, 120) << "ground " << int(ground);  // of 765
  }
}

TEST_F(Render, NoCraterBorderIsACircle) {
  Crater crater = craterAt(30.0, 30.0, 5.0);
  crater.depth_q = crater.rim_height_q = crater.noise_q16 = 0;
  const Camera camera = straightDown({30.0, 30.0}, 24.0);
  const Image plain = pictureOf(CraterWorld(flatCraterPack()), camera, plainSettings());
  const Image image = pictureOf(CraterWorld(flatCraterPack(), std::array{crater}), camera, plainSettings());
  std::vector<double> reaches;
  for (int spoke = 0; spoke < 64; ++spoke) {
    const double turn = spoke * 2.0 * 3.14159265 / 64.0;
    double reach_m = 0.0;
    for (double away_px = 8.0; away_px < 90.0; away_px += 0.5) {
      const int x = int(96.0 + std::cos(turn) * away_px), y = int(96.0 + std::sin(turn) * away_px);
      if (std::abs(brightness(image, x, y) - brightness(plain, x, y)) > 100) reach_m = away_px / 8.0;
    }
    reaches.push_back(reach_m);
  }
  const auto [least, most] = std::ranges::minmax(reaches);
  EXPECT_GT(most - least, 0.5);
  EXPECT_LE(most, 7.5);
}

TEST_F(Render, TheNewestOfCratersOnOneSpotDecide) {
  Crater wide = craterAt(30.0, 30.0, 6.0);
  wide.depth_q = wide.rim_height_q = wide.noise_q16 = 0;
  Crater old = craterAt(31.0, 30.0, 2.0);
  old.depth_q = old.rim_height_q = old.noise_q16 = 0;
  old.noise_seed = 5;
  const Camera camera = straightDown({30.0, 30.0}, 24.0);
  const Image two = pictureOf(CraterWorld(flatCraterPack(), std::array{wide, wide}), camera, plainSettings());
  const Image three = pictureOf(CraterWorld(flatCraterPack(), std::array{old, wide, wide}), camera, plainSettings());
  EXPECT_EQ(differentPixels(three, two), 0u);
  // The same one on top of them shows.
  const Image on_top = pictureOf(CraterWorld(flatCraterPack(), std::array{wide, wide, old}), camera, plainSettings());
  EXPECT_GT(differentPixels(on_top, two), 500u);
}

TEST_F(Render, TheHashesCellsDoNotShow) {
  std::vector<Crater> craters;
  for (int i = 0; i < 40; ++i) craters.push_back(craterAt(18.0 + i * 37 % 25, 18.0 + i * 53 % 23, 0.5 + i % 4));
  Image first;
  for (const std::int32_t side_q : {2 * kMetre_q, 5 * kMetre_q + 123, 20 * kMetre_q, 1 << 24}) {
    ScenePack pack = craterPack();
    pack.crater_limits.hash_cell_q = side_q;
    const CraterWorld world(pack, craters);
    const Image image = pictureOf(world, fromAbove(world, {30.0, 30.0}, 30.0), plainSettings());
    if (first.rgba.empty()) first = image;
    EXPECT_EQ(differentPixels(image, first), 0u) << "cells of " << side_q;
  }
}

TEST_F(Render, FarFromTheWorldsCornerCratersLookTheSame) {
  // 82 km, whole steps of every lattice that the soil's noise has; level ground, without grain.
  ScenePack pack = flatCraterPack();
  pack.width_cells = 1 << 21;
  const double shift_m = (1 << 15) * 2.5;
  const std::array craters{craterAt(30.0, 30.0, 4.0), craterAt(30.0 + shift_m, 30.0, 4.0)};
  const CraterWorld world(pack, craters);
  RenderSettings settings = plainSettings();
  settings.detail = 0.0;
  Camera camera = cameraLookingAt({24.0, 22.0, 6.0}, {30.0, 30.0, 0.0});
  const Image here = pictureOf(world, camera, settings);
  camera.eye_m.x += shift_m;
  camera.focus_m.x += shift_m;
  const Image there = pictureOf(world, camera, settings);
  // The soil is another; craters, burns and shadows are the same.
  double sum_here = 0.0, sum_there = 0.0;
  std::size_t far_apart = 0;
  for (int y = 0; y < 192; ++y) {
    for (int x = 0; x < 192; ++x) {
      sum_here += brightness(here, x, y);
      sum_there += brightness(there, x, y);
      far_apart += std::abs(brightness(here, x, y) - brightness(there, x, y)) > 250;
    }
  }
  EXPECT_NEAR(sum_here / sum_there, 1.0, 0.03);
  EXPECT_LT(far_apart, 192u * 192u / 25u);
}

TEST(CraterRecording, ReplaysTheCratersThatEveryMomentHad) {
  CraterWorld world(craterPack());
  Recording recording(4);
  for (int tick = 0; tick <= 60; ++tick) {
    world.state.tick = tick;
    if (tick % 5 == 3) world.add(std::array{craterAt(10.0 + tick, 20.0, 1.0)});
    if (tick == 40) world.addLive({7, 7});
    recording.add(world.state, tick == 40 ? std::vector<TileCoordinate>{{7, 7}} : std::vector<TileCoordinate>{});
  }
  recording.finish(world.state);
  std::vector<std::size_t> counts;
  recording.replay(world.base, [&](int, const WorldState& state, std::span<const TileCoordinate>) {
    EXPECT_EQ(state.craters.size(), std::size_t((state.tick + 2) / 5)) << "tick " << state.tick;
    EXPECT_TRUE(std::ranges::equal(state.craters.records(), world.state.craters.records().first(state.craters.size())));
    counts.push_back(state.craters.size());
    return true;
  });
  ASSERT_EQ(counts.size(), 4u);
  EXPECT_EQ(counts.back(), 12u);
  EXPECT_LT(counts.front(), 6u);
}

TEST(CraterFigure, APacksOwnCratersComeAtTheirTicks) {
  ScenePack pack = craterLooksPack();
  ASSERT_TRUE(validatePack(pack));
  pack.craters[3].tick = pack.craters[4].tick = 3;
  FigureScene scene(pack, makeNativeBackend());
  ASSERT_TRUE(scene.runTo(2));
  EXPECT_EQ(scene.state().craters.size(), 3u);
  ASSERT_TRUE(scene.runTo(3));
  EXPECT_TRUE(std::ranges::equal(scene.state().craters.records(), pack.craters));
  EXPECT_EQ(scene.state().tiles.size(), 0u);
}

}  // namespace
}  // namespace spoor
