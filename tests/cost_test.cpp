// Cost follows activity: counted, not timed.
#include <gtest/gtest.h>

#include "tests/scenes.h"

namespace spoor::test {
namespace {

/// What a tick touches.
struct Cost {
  std::int64_t active_cells, domain_cells, penetrating_cells, pairs_visited, bytes_moved;
  std::size_t update_bytes, live_tiles, memory_bytes, awake_tiles;
  bool operator==(const Cost&) const = default;
};

/// A car of a chassis and four wheels, its middle at (x_q, y_q), that drives eastwards.
void addCar(ScenePack& pack, int x_q, int y_q) {
  addBody(pack, boxMesh(20000, 8000, 4000), x_q, y_q, -3000);
  for (const int dx : {-7000, 7000})
    for (const int dy : {-5000, 5000}) addBody(pack, boxMesh(5000, 2000, 5000), x_q + dx, y_q + dy, 1200);
}

std::vector<Cost> drive(const World& world, int ticks) {
  Simulation simulation = world.simulate();
  std::vector<Cost> costs;
  for (int tick = 0; tick < ticks; ++tick) {
    std::vector<Pose> poses = simulation.state().poses;
    for (Pose& pose : poses) pose = moved(pose, 900, 150);
    const auto result = simulation.step(poses);
    EXPECT_TRUE(result);
    const TickEffect& effect = result->effect;
    costs.push_back({effect.active_cells, effect.domain_cells, effect.penetrating_cells, effect.pairs_visited,
                     effect.bytes_moved, result->update.tiles.size(), simulation.state().tiles.size(),
                     simulation.state().tiles.memoryBytes(), simulation.state().tiles.awake().size()});
  }
  return costs;
}

ScenePack carPack(int size, int x_q, int y_q, bool flat) {
  ScenePack pack = flat ? flatPack(size, size) : noisePack(size, size, 8, -2000, 2000, 50000);
  addCar(pack, x_q, y_q);
  return pack;
}

TEST(Cost, ACarCostsTheSameInAWorldAThousandTimesAsLarge) {
  const World small(carPack(2048, 512000, 700500, false)), large(carPack(65536, 512000, 700500, false));
  const auto expected = drive(small, 60), found = drive(large, 60);
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) ASSERT_EQ(found[i], expected[i]) << "tick " << i + 1;
  EXPECT_LE(found.back().live_tiles, 12u);
}

TEST(Cost, ACarCostsTheSameAnywhereInALargeWorld) {
  constexpr int kTile = 64 * 1000;
  const World corner(carPack(65536, 5 * kTile + 500, 7 * kTile, true)),
      middle(carPack(65536, 505 * kTile + 500, 507 * kTile, true));
  const auto expected = drive(corner, 40), found = drive(middle, 40);
  for (std::size_t i = 0; i < found.size(); ++i) ASSERT_EQ(found[i], expected[i]) << "tick " << i + 1;
}

TEST(Cost, ATrailLeftBehindIsNotSimulated) {
  const World world(carPack(2048, 100000, 700500, true));
  const auto costs = drive(world, 500);
  std::int64_t most = 0;
  for (std::size_t i = 100; i < costs.size(); ++i) most = std::max(most, costs[i].active_cells);
  EXPECT_GT(costs.back().live_tiles, 10u);
  EXPECT_LE(most, 12 * rules::kTileCells);
}

}  // namespace
}  // namespace spoor::test
