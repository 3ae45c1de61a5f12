// What a crater costs on the wire as a record, beside the same ground as differences of tiles.
#include <gtest/gtest.h>

#include <cstdio>

#include "protocol/messages.h"
#include "protocol/zstd_codec.h"
#include "shared/world/crater_set.h"
#include "tests/scenes.h"

namespace spoor::test {
namespace {

ScenePack craterPack(int radius_q) {
  ScenePack pack = noisePack(2 * radius_q / 500 + 40, 2 * radius_q / 500 + 40, 9, -5000, 5000, 100000);
  pack.cell_q = 500;
  pack.crater_limits.radius_q = radius_q;
  pack.crater_limits.hash_cell_q = std::max(radius_q / 8, 1);
  return pack;
}

Crater craterOf(const ScenePack& pack, int radius_q) {
  Crater crater;
  crater.x_q = crater.y_q = pack.width_cells * pack.cell_q / 2;
  crater.crest_radius_q = radius_q * 2 / 3;
  crater.inner_radius_q = 2 * crater.crest_radius_q - radius_q;
  crater.depth_q = radius_q / 5;
  crater.rim_height_q = balancedRimHeight(crater.inner_radius_q, crater.crest_radius_q, crater.depth_q);
  crater.noise_q16 = 9000;
  crater.tick = 1;
  return crater;
}

std::size_t bytesOf(const TickUpdate& update) {
  const auto frame = encodeMessage(update);
  EXPECT_TRUE(frame) << (frame ? "" : frame.error());
  return frame ? frame->size() : 0;
}

/// The crater's tiles against the ground before it, compressed as a tick's are.
std::size_t bytesAsTiles(const World& world, const Crater& crater) {
  CraterSet set(world.pack);
  set.add({&crater, 1});
  std::vector<TileChange> changes;
  const TileCoordinate extent = tileExtent(world.pack);
  PlaneCells before;
  for (std::int32_t y = 0; y < extent.y; ++y)
    for (std::int32_t x = 0; x < extent.x; ++x) {
      const auto tile = makeTile({x, y}, {&world.base, &set}, 1);
      world.base.fillHeights({x, y}, before);
      TileChange change = differenceOf(*tile, planesWith(*tile, before), kDormantVersion);
      if (change.width > 0) changes.push_back(std::move(change));
    }
  return zstdCompress(encodeTiles(changes)).size();
}

TEST(CraterWire, ARecordIsAsLongForEverySizeAndShorterThanItsTiles) {
  std::size_t record_bytes = 0;
  std::printf("R3, m    record, bytes    as tiles, bytes    ratio\n");
  for (const int radius_q : {2500, 10000, 50000, 200000, 400000}) {
    const World world(craterPack(radius_q));
    const Crater crater = craterOf(world.pack, radius_q);
    ASSERT_TRUE(validateCrater(world.pack, crater));
    TickUpdate update{1, 0, {}, encodeTiles({})};
    const std::size_t without = bytesOf(update);
    update.craters.push_back(crater);
    const std::size_t bytes = bytesOf(update) - without;
    if (record_bytes == 0) record_bytes = bytes;
    EXPECT_NEAR(double(bytes), double(record_bytes), 4) << "a tick may come out a few bytes longer when compressed";
    EXPECT_LE(bytes, 64u);
    const std::size_t tiles = bytesAsTiles(world, crater);
    EXPECT_GT(tiles, 2 * bytes);
    std::printf("%6.2f %12zu %18zu %12.0f\n", radius_q / 1e4, bytes, tiles, double(tiles) / double(bytes));
  }
}

}  // namespace
}  // namespace spoor::test
