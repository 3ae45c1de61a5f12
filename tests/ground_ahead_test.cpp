// Where the middle of a view meets the ground.
#include "client/ground_ahead.h"

#include "tests/scenes.h"

namespace spoor::test {
namespace {

std::optional<glm::dvec2> ahead(const World& world, const glm::dvec3& eye_m, const glm::dvec3& target_m) {
  const WorldState state = initialState(world.id, world.base);
  return groundAhead({&world.base, &state}, cameraLookingAt(eye_m, target_m));
}

TEST(GroundAhead, IsWhereTheRayMeetsLevelGround) {
  const World world(flatPack(400, 300));
  const auto place_m = ahead(world, {5, 6, 4}, {25, 16, 0});
  ASSERT_TRUE(place_m);
  EXPECT_NEAR(place_m->x, 25, 1e-4);
  EXPECT_NEAR(place_m->y, 16, 1e-4);
}

TEST(GroundAhead, IsNowhereInTheSkyAndOffTheMap) {
  const World world(flatPack(400, 300));
  EXPECT_FALSE(ahead(world, {5, 6, 4}, {25, 16, 4.5}));
  EXPECT_FALSE(ahead(world, {5, 6, 4}, {45, 6, 0}));
}

TEST(GroundAhead, IsTheNearSideOfAHill) {
  std::vector<std::int32_t> heights(100 * 20, 0);
  for (int y = 0; y < 20; ++y)
    for (int x = 40; x < 60; ++x) heights[std::size_t(y * 100 + x)] = 20000;
  const World world(groundPack(100, 20, heights, 10000));
  const auto place_m = ahead(world, {1, 1, 1}, {9, 1, 0.5});
  ASSERT_TRUE(place_m);
  EXPECT_NEAR(place_m->x, 4.0, 0.15);
}

}  // namespace
}  // namespace spoor::test
