// The gl backend against the native one, tick by tick: whatever the groups, the order of batches and the schedule.
#include <gtest/gtest.h>

#include <cstdio>

#include "shaders/host/gl_backend.h"
#include "tests/scenes.h"

namespace spoor::test {
namespace {

TEST(GlTick, RandomWorldsHaveTheNativeHashes) {
  for (std::uint32_t seed = 1; seed < 20; ++seed) {
    RandomWorld random = randomWorld(seed, 10);
    SCOPED_TRACE(random.description);
    const World world(random.pack);
    auto gl = makeGlBackend({});
    if (!gl) GTEST_SKIP() << gl.error();
    Simulation on_device(world.base, world.id, std::move(*gl));
    Simulation native = world.simulate();
    for (const auto& poses : random.ticks) {
      const auto expected = native.step(poses);
      const auto result = on_device.step(poses);
      ASSERT_TRUE(result) << result.error();
      ASSERT_EQ(result->effect.penetrating_cells, expected->effect.penetrating_cells)
          << "tick " << expected->update.tick;
      ASSERT_EQ(result->update.state_hash, expected->update.state_hash) << "tick " << expected->update.tick;
      ASSERT_EQ(result->update.tiles, expected->update.tiles) << "tick " << expected->update.tick;
    }
  }
}

}  // namespace
}  // namespace spoor::test
