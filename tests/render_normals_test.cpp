// Normals and mesh of the finest level: blurred as the thesis does, made anew only where heights changed.
#include <algorithm>
#include <cmath>

#include "client/terrain_levels.h"
#include "tests/render_rig.h"

namespace spoor {
namespace {

void update(TerrainLevels& levels, const TerrainView& view, glm::ivec2 focus_cell,
            std::span<const TileCoordinate> changed) {
  levels.updateHeights(view, focus_cell, changed);
  levels.updateRelief();
}

using namespace test;

constexpr double kCell_m = 0.05;
constexpr int kSide = 4 * 64;  // samples along the window of these tests
const glm::ivec2 kFocus(7 * 64, 6 * 64);

TerrainLevels levelsWith(int blur_passes) {
  const glm::dvec3 sun = glm::normalize(glm::dvec3(-1.0, 0.7, 0.4));
  return TerrainLevels({4, 6, render::kFinePatchSamples, blur_passes}, kCell_m, sun);
}

ViewedWorld ruttedWorld() {
  ViewedWorld world(noisePack());
  addLiveTile(world.state, world.base, {7, 6}, 2000);
  addLiveTile(world.state, world.base, {6, 5}, -700);
  return world;
}

glm::vec2 at(const std::vector<glm::vec2>& slopes, int x, int y) {
  return slopes[std::size_t(std::clamp(y, 0, kSide - 1) * kSide + std::clamp(x, 0, kSide - 1))];
}

/// The thesis's normals, by the book: the symmetric derivative, then so many convolutions.
std::vector<glm::vec2> blurredSlopes(const TerrainView& view, glm::ivec2 first, int passes) {
  std::vector<std::int32_t> height_q(std::size_t(kSide) * kSide);
  fillSamples(view, 0, {first, glm::ivec2(kSide)}, height_q);
  const auto height_m = [&](int x, int y) {
    return float(height_q[std::size_t(std::clamp(y, 0, kSide - 1) * kSide + std::clamp(x, 0, kSide - 1))]) * 1e-4f;
  };
  std::vector<glm::vec2> slopes, next(std::size_t(kSide) * kSide);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      slopes.push_back(glm::vec2(height_m(x + 1, y) - height_m(x - 1, y), height_m(x, y + 1) - height_m(x, y - 1)) /
                       float(2.0 * kCell_m));
  constexpr float kGauss[3][3] = {{1, 2, 1}, {2, 4, 2}, {1, 2, 1}};
  for (int pass = 0; pass < passes; ++pass) {
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        glm::vec2 sum(0.0f);
        for (int j = 0; j < 3; ++j)
          for (int i = 0; i < 3; ++i) sum += kGauss[j][i] / 16.0f * at(slopes, x + i - 1, y + j - 1);
        next[std::size_t(y * kSide + x)] = sum;
      }
    }
    slopes.swap(next);
  }
  return slopes;
}

std::size_t differences(const std::vector<glm::vec4>& a, const std::vector<glm::vec4>& b, int rim) {
  std::size_t count = 0;
  for (int y = rim; y < kSide - rim; ++y)
    for (int x = rim; x < kSide - rim; ++x) count += a[std::size_t(y * kSide + x)] != b[std::size_t(y * kSide + x)];
  return count;
}

TEST_F(Render, BlurPassesEqualAPlainConvolution) {
  const ViewedWorld world = ruttedWorld();
  std::vector<float> steepest;
  for (const int passes : {0, 1, 2, 3, 16}) {
    TerrainLevels levels = levelsWith(passes);
    update(levels, world.view(), kFocus, {});
    const auto relief = levels.fineRelief();
    const auto wanted = blurredSlopes(world.view(), levels.windows()[0].window, passes);
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < relief.size(); ++i)
      for (int axis = 0; axis < 2; ++axis)  // the map keeps 11 bits
        wrong += std::abs(relief[i][axis] - wanted[i][axis]) > 1e-3f * std::abs(wanted[i][axis]) + 1e-5f;
    EXPECT_EQ(wrong, 0u) << passes << " passes";
    const auto by_x = [](const glm::vec4& a, const glm::vec4& b) { return a.x < b.x; };
    steepest.push_back(std::ranges::max_element(relief, by_x)->x);
  }
  EXPECT_TRUE(std::ranges::is_sorted(steepest, std::greater<>()));
  EXPECT_LT(steepest.back(), 0.5f * steepest.front());
}

TEST_F(Render, ReliefOfAChangedTileIsThatOfAFullRebuild) {
  for (const int passes : {0, 1, 2, 16}) {
    ViewedWorld world = ruttedWorld();
    TerrainLevels levels = levelsWith(passes);
    update(levels, world.view(), kFocus, {});
    const auto before = levels.fineRelief();
    // A tile inside, and one that its neighbour's border changes with it: every cell, to the corners.
    const std::array<TileCoordinate, 2> changed{{{6, 5}, {7, 6}}};
    for (const TileCoordinate tile : changed)
      for (int i = 0; i < rules::kTileCells; ++i)
        world.state.tiles.find(tile)->height()[std::size_t(i)] += i * 37 % 900;
    levels.stats = {};
    update(levels, world.view(), kFocus, changed);
    const TerrainStats after = levels.stats;
    const auto relief = levels.fineRelief();

    TerrainLevels fresh = levelsWith(passes);
    update(fresh, world.view(), kFocus, {});
    EXPECT_EQ(differences(relief, fresh.fineRelief(), 0), 0u) << passes << " passes";
    EXPECT_GT(differences(relief, before, 0), std::size_t(2 * rules::kTileCells)) << passes << " passes";
    // Of the finest level: two boxes that hold what a tile and the reach of all passes make, at most.
    const std::int64_t most = 64 + 2 * (1 + 6 + 12) + 2 * passes;
    EXPECT_LE(after.blurred_samples, 2 * most * most * passes) << passes << " passes";
    EXPECT_EQ(after.blurred_samples > 0, passes > 0);
  }
}

TEST_F(Render, ReliefAfterTheWindowMovedIsThatOfAFreshOne) {
  const ViewedWorld world = ruttedWorld();
  TerrainLevels levels = levelsWith(16);
  update(levels, world.view(), kFocus + 64, {});
  update(levels, world.view(), kFocus + glm::ivec2(0, -64), {});
  update(levels, world.view(), kFocus, {});
  TerrainLevels fresh = levelsWith(16);
  update(fresh, world.view(), kFocus, {});
  // The rim shows the next level alone.
  EXPECT_EQ(differences(levels.fineRelief(), fresh.fineRelief(), render::kMorphRimSamples - 2), 0u);
}

TEST_F(Render, PackAndSettingsSayHowOftenNormalsAreBlurred) {
  ViewedWorld world(noisePack());
  world.pack.normal_blur_passes = 3;
  addLiveTile(world.state, world.base, {7, 6}, 2000);
  const auto picture = [&](int passes) {
    RenderSettings settings = smallSettings();
    settings.shade = Shade::normals;
    settings.blur_passes = passes;
    Renderer renderer(world.pack, settings);
    renderer.draw(world.view(), fromAbove(world, glm::dvec2(7.5, 6.5) * 3.2, 3.0));
    return renderer.readPicture().rgba;
  };
  EXPECT_TRUE(picture(-1) == picture(3));
  EXPECT_FALSE(picture(-1) == picture(0));
}

TEST(FinePatches, ARowHoldsAsManyAsAskedForWhereTessellationAllows) {
  EXPECT_EQ(finePatchSamples(4096, 0), 64);
  EXPECT_EQ(finePatchSamples(4096, 64), 64);
  EXPECT_EQ(finePatchSamples(4096, 65), 32);
  EXPECT_EQ(finePatchSamples(2048, 64), 32);
  EXPECT_EQ(finePatchSamples(512, 64), 8);
  EXPECT_EQ(finePatchSamples(512, 4096), 4);
  EXPECT_EQ(finePatchSamples(1 << 24, 1), 64);
}

TEST_F(Render, SmallPatchesCoverTheGroundWithoutCracks) {
  ViewedWorld world(noisePack());
  addLiveTile(world.state, world.base, {7, 6}, 2000);
  for (const auto& [patches_per_row, side] : {std::pair{93, 16}, std::pair{187, 8}, std::pair{4096, 4}}) {
    RenderSettings settings = smallSettings();
    settings.patches_per_row = patches_per_row;
    Renderer renderer(world.pack, settings);
    for (int i = 0; i < 6; ++i) {
      // Across the border of the finest window, from where it fills the picture to where the next ones do.
      Camera camera = fromAbove(world, {30.0 + i, 26.0}, 3.0 * std::pow(2.0, i));
      camera.focus_m.x -= 9.0;
      renderer.draw(world.view(), camera);
      EXPECT_EQ(pixelsShowingSky(renderer.readPicture()), 0u) << patches_per_row << " patches, camera " << i;
    }
    // Three tiles from above, and the rows that their corners touch.
    Camera camera = fromAbove(world, glm::dvec2(7.5, 6.5) * 3.2, 100.0);
    camera.orthographic_height_m = 3 * 3.2 - 0.2;
    renderer.draw(world.view(), camera);
    const std::int64_t high = 3 * 64 / side, wide = 4 * 64 / side;
    EXPECT_NEAR(double(renderer.stats().patches_drawn), double(high * wide), double(2 * high + 4)) << patches_per_row;
  }
}

}  // namespace
}  // namespace spoor
