// The spatial hash of craters, and dormant ground made from it: against all records looked at in every cell.
#include "shared/world/crater_set.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <random>

#include "tests/scenes.h"

namespace spoor::test {
namespace {

constexpr int kWidth = 150, kHeight = 110;  // cells of 1000

ScenePack cratersPack(std::int32_t hash_cell_q, std::int32_t reach_q = 30000) {
  ScenePack pack = noisePack(kWidth, kHeight, 3, -2000, 2000, 4000);
  pack.crater_limits = {.radius_q = reach_q, .hash_cell_q = hash_cell_q};
  return pack;
}

std::vector<Crater> numbered(std::vector<Crater> craters) {
  for (std::size_t i = 0; i < craters.size(); ++i) craters[i].id = std::uint32_t(i);
  return craters;
}

/// Anywhere on the map and over its border, large and small, some of them twice.
std::vector<Crater> randomCraters(const ScenePack& pack, std::uint32_t seed, int count) {
  std::vector<Crater> craters;
  for (int i = 0; i < count; ++i)
    craters.push_back(i % 10 == 9 ? craters.back()
                                  : randomCrater(pack, seed * 7919 + std::uint32_t(i), pack.crater_limits.radius_q));
  return numbered(std::move(craters));
}

/// D(S) of a cell from every record; 0 outside the map.
std::int32_t totalAt(const ScenePack& pack, std::span<const Crater> craters, int x, int y) {
  if (x < 0 || y < 0 || x >= pack.width_cells || y >= pack.height_cells) return 0;
  rules::CraterSum sum = rules::craterSumOfNone();
  for (const Crater& crater : craters) {
    const int dx = x * pack.cell_q + pack.cell_q / 2 - crater.x_q, dy = y * pack.cell_q + pack.cell_q / 2 - crater.y_q;
    sum = rules::withCrater(sum, rules::craterDisplacement(shapeOf(crater), dx, dy), crater.rim_height_q);
  }
  return rules::craterTotal(sum);
}

CraterSet setOf(const ScenePack& pack, std::span<const Crater> craters) {
  CraterSet set(pack);
  set.add(craters);
  return set;
}

TEST(CraterSet, FillsWhatEveryRecordTogetherDoesInHashCellsOfAnySide) {
  std::mt19937 engine(1);
  for (const std::int32_t side : {1875, 5000, 9999, 64000, 1 << 30}) {
    const ScenePack pack = cratersPack(side);
    const std::vector<Crater> craters = randomCraters(pack, 1, 70);
    const CraterSet set = setOf(pack, craters);
    for (const auto& [x, y, stride, columns, rows] : {std::array{0, 0, 1, kWidth, kHeight},
                                                      {-20, -7, 3, 70, 50},
                                                      {40, 30, 17, 9, 9},
                                                      {149, 109, 1, 3, 3},
                                                      {-9, 60, 1, 5, 5},
                                                      {160, 40, 2, 6, 6},
                                                      {77, 33, 1, 1, 1},
                                                      {-1000, -1000, 999, 3, 3}}) {
      std::vector<std::int32_t> filled(std::size_t(columns) * std::size_t(rows), 12345);
      set.fill(x, y, stride, columns, rows, filled);
      for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column)
          ASSERT_EQ(filled[std::size_t(row * columns + column)],
                    totalAt(pack, craters, x + column * stride, y + row * stride))
              << "side " << side << ", cell " << x + column * stride << ", " << y + row * stride;
    }
  }
}

TEST(CraterSet, ChangesTilesByWhatNewRecordsAdd) {
  const ScenePack pack = cratersPack(7000);
  const std::vector<Crater> craters = randomCraters(pack, 2, 60);
  const TileCoordinate extent = tileExtent(pack);
  for (std::int32_t tile_y = 0; tile_y < extent.y; ++tile_y)
    for (std::int32_t tile_x = 0; tile_x < extent.x; ++tile_x) {
      const TileCoordinate at{tile_x, tile_y};
      PlaneCells height{}, bedrock;
      bedrock.fill(-8000);
      CraterSet set(pack);
      std::unique_ptr<TileCraters> kept, none;
      std::size_t before = 0;
      for (const std::size_t count :
           {std::size_t(1), std::size_t(2), std::size_t(31), std::size_t(59), craters.size()}) {
        set.add(std::span(craters).subspan(before, count - before));
        PlaneCells expected = height, other = height;
        std::int64_t gained = 0;
        for (int i = 0; i < rules::kTileCells; ++i) {
          const int x = at.x * rules::kTileSize + i % rules::kTileSize,
                    y = at.y * rules::kTileSize + i / rules::kTileSize;
          const int change = totalAt(pack, std::span(craters).first(count), x, y) -
                             totalAt(pack, std::span(craters).first(before), x, y);
          expected[std::size_t(i)] = std::max(expected[std::size_t(i)] + change, -8000);
          gained += expected[std::size_t(i)] - height[std::size_t(i)];
        }
        none.reset();
        EXPECT_EQ(addCraters(at, other, bedrock, set, before, none), gained) << "nothing kept, " << count;
        EXPECT_EQ(addCraters(at, height, bedrock, set, before, kept), gained) << "sums kept, " << count;
        ASSERT_EQ(other, expected);
        ASSERT_EQ(height, expected);
        before = count;
      }
    }
}

TEST(CraterSet, FindsTheRecordsWhoseSquaresMeetABox) {
  std::mt19937 engine(3);
  for (const std::int32_t side : {1875, 20000, 1 << 29}) {
    const ScenePack pack = cratersPack(side);
    const std::vector<Crater> craters = randomCraters(pack, 3, 200);
    const CraterSet set = setOf(pack, craters);
    for (int i = 0; i < 400; ++i) {
      const auto number = [&engine](int low, int high) { return low + int(engine() % std::uint32_t(high - low + 1)); };
      const int x0 = number(-10, kWidth + 5), y0 = number(-10, kHeight + 5);
      const CellBox box{x0, y0, x0 + number(0, 40), y0 + number(0, 40)};
      const CellBox inside{std::max(box.x0, 0), std::max(box.y0, 0), std::min(box.x1, kWidth),
                           std::min(box.y1, kHeight)};
      std::vector<std::uint32_t> expected;
      for (const Crater& crater : craters)
        if (!inside.empty() && craterBox(pack, crater).meets(inside)) expected.push_back(crater.id);
      ASSERT_EQ(set.meeting(box), expected) << "side " << side;
    }
    EXPECT_TRUE(set.meeting({INT32_MIN, INT32_MIN, INT32_MAX, INT32_MAX}).size() == craters.size());
    EXPECT_TRUE(set.meeting({5, 5, 5, 9}).empty());
  }
}

/// Each record is in each hash cell that its square meets, once, and nowhere else; buckets are in order and have room.
void checkTable(const ScenePack& pack, const CraterSet& set) {
  const CraterTable& table = set.table();
  const std::int32_t side = pack.crater_limits.hash_cell_q;
  ASSERT_EQ(table.side_q, side);
  ASSERT_EQ(table.used.size() & (table.used.size() - 1), 0u);
  ASSERT_EQ(table.first.size(), table.used.size());
  std::map<std::tuple<int, std::int32_t, std::uint32_t>, int> expected;  // bucket, record, tag
  for (const Crater& crater : set.records())
    for (int y = 0; y * std::int64_t(side) < std::int64_t(kHeight) * 1000; ++y)
      for (int x = 0; x * std::int64_t(side) < std::int64_t(kWidth) * 1000; ++x) {
        const std::int64_t outer = crater.outerRadius();
        const std::int64_t west = x * std::int64_t(side), south = y * std::int64_t(side);
        const bool meets = crater.x_q + outer >= west && crater.x_q - outer < west + side &&
                           crater.y_q + outer >= south && crater.y_q - outer < south + side;
        if (meets)
          ++expected[{rules::craterBucket(x, y, table.mask()), std::int32_t(crater.id), rules::craterTag(x, y)}];
      }
  for (std::size_t bucket = 0; bucket < table.used.size(); ++bucket) {
    const std::int32_t end =
        bucket + 1 < table.first.size() ? table.first[bucket + 1] : std::int32_t(table.entries.size());
    ASSERT_LE(table.first[bucket] + table.used[bucket], end) << "used up to its capacity";
    for (std::int32_t place = table.first[bucket]; place < end; ++place) {
      const rules::CraterEntry& entry = table.entries[std::size_t(place)];
      if (place >= table.first[bucket] + table.used[bucket]) {
        ASSERT_TRUE(entry.record == 0 && entry.tag == 0) << "what no bucket uses is 0";
        continue;
      }
      const auto found = expected.find({int(bucket), entry.record, entry.tag});
      ASSERT_TRUE(found != expected.end() && found->second-- == 1) << "record " << entry.record;
      if (place == table.first[bucket]) continue;
      const rules::CraterEntry& before = table.entries[std::size_t(place) - 1];
      ASSERT_TRUE(before.record < entry.record || (before.record == entry.record && before.tag < entry.tag));
    }
  }
  for (const auto& [where, count] : expected) ASSERT_EQ(count, 0) << "record " << std::get<1>(where) << " is missing";
}

TEST(CraterSet, TheTableHoldsEachRecordInEachOfItsCellsOnce) {
  for (const std::int32_t side : {1875, 2500, 30000, 1 << 30}) {
    const ScenePack pack = cratersPack(side);
    ASSERT_NO_FATAL_FAILURE(checkTable(pack, setOf(pack, randomCraters(pack, 4, 150)))) << "side " << side;
  }
}

TEST(CraterSet, HowRecordsWereAddedDoesNotShow) {
  const ScenePack pack = cratersPack(2000);
  const std::vector<Crater> craters = randomCraters(pack, 5, 400);
  const CraterSet at_once = setOf(pack, craters);
  EXPECT_EQ(at_once.table().built_count, 400u);
  EXPECT_EQ(at_once.table().generation, 1u);
  for (const std::size_t batch : {1, 7, 150}) {
    CraterSet grown(pack);
    for (std::size_t at = 0; at < craters.size(); at += batch)
      grown.add(std::span(craters).subspan(at, std::min(batch, craters.size() - at)));
    ASSERT_NO_FATAL_FAILURE(checkTable(pack, grown));
    EXPECT_EQ(grown.hash(), at_once.hash());
    EXPECT_LT(grown.table().generation, 30u) << "seldom built anew";
    for (int y = -1; y < kHeight; y += 5)
      for (int x = -1; x < kWidth; x += 5)
        ASSERT_EQ(grown.meeting({x, y, x + 7, y + 6}), at_once.meeting({x, y, x + 7, y + 6}));
    std::vector<std::int32_t> displacement(kWidth * kHeight), expected(kWidth * kHeight);
    grown.fill(0, 0, 1, kWidth, kHeight, displacement);
    at_once.fill(0, 0, 1, kWidth, kHeight, expected);
    EXPECT_EQ(displacement, expected);
  }
}

TEST(CraterSet, ARecordMoreMovesNoOther) {
  const ScenePack pack = cratersPack(5000);
  const std::vector<Crater> craters = randomCraters(pack, 6, 300);
  CraterSet set = setOf(pack, std::span(craters).first(290));
  const CraterTable before = set.table();
  std::size_t at = 290;
  for (; at < craters.size() && set.table().generation == before.generation; ++at) {
    const CraterTable older = set.table();
    set.add({&craters[at], 1});
    if (set.table().generation != older.generation) break;
    EXPECT_EQ(set.table().first, older.first);
    for (std::size_t i = 0; i < older.entries.size(); ++i) {
      const rules::CraterEntry &was = older.entries[i], &is = set.table().entries[i];
      const bool the_same = was.record == is.record && was.tag == is.tag;
      ASSERT_TRUE(the_same || (was.record == 0 && was.tag == 0 && is.record == std::int32_t(at)));
    }
  }
  EXPECT_GT(at, 292u) << "buckets have room";
}

TEST(CraterSet, TakesTheNewestBack) {
  const ScenePack pack = cratersPack(4000);
  const std::vector<Crater> craters = randomCraters(pack, 7, 120);
  CraterSet set = setOf(pack, craters);
  for (const std::size_t count : {std::size_t(120), std::size_t(77), std::size_t(76), std::size_t(0)}) {
    set.truncate(count);
    const CraterSet fewer = setOf(pack, std::span(craters).first(count));
    EXPECT_EQ(set.size(), count);
    EXPECT_EQ(set.hash(), fewer.hash());
    ASSERT_NO_FATAL_FAILURE(checkTable(pack, set));
    EXPECT_EQ(set.meeting({0, 0, kWidth, kHeight}), fewer.meeting({0, 0, kWidth, kHeight}));
  }
  set.add(craters);
  EXPECT_EQ(set.hash(), setOf(pack, craters).hash());
}

TEST(CraterSet, ItsHashTellsEveryFieldAndTheOrder) {
  const ScenePack pack = cratersPack(4000);
  const std::vector<Crater> craters = randomCraters(pack, 8, 3);
  const std::uint64_t original = setOf(pack, craters).hash();
  std::int32_t Crater::*const fields[] = {
      &Crater::x_q,     &Crater::y_q, &Crater::inner_radius_q, &Crater::crest_radius_q, &Crater::rim_height_q,
      &Crater::depth_q, &Crater::tick};
  for (const auto field : fields) {
    std::vector<Crater> changed = craters;
    changed[1].*field += 1;
    EXPECT_NE(setOf(pack, changed).hash(), original);
  }
  for (std::uint16_t Crater::*const field : {&Crater::noise_seed, &Crater::noise_q16}) {
    std::vector<Crater> changed = craters;
    changed[0].*field ^= 1;
    EXPECT_NE(setOf(pack, changed).hash(), original);
  }
  std::vector<Crater> swapped = numbered({craters[1], craters[0], craters[2]});
  EXPECT_NE(setOf(pack, swapped).hash(), original);
  EXPECT_EQ(CraterSet(pack).hash(), 0u);
}

TEST(CraterSet, CostsWhatItsRecordsCostInAWorldOfAnySize) {
  const std::vector<Crater> craters = randomCraters(cratersPack(5000), 9, 500);
  std::vector<std::size_t> bytes;
  for (const std::int32_t width : {kWidth, 2000000}) {
    ScenePack pack = cratersPack(5000);
    pack.width_cells = width;
    pack.height_cells = width;
    const CraterSet set = setOf(pack, craters);
    bytes.push_back(set.memoryBytes());
  }
  // On the larger map more of those at the border lie within it.
  EXPECT_LT(double(bytes[1]), 1.3 * double(bytes[0])) << bytes[0] << " and " << bytes[1] << " bytes";
}

TEST(CraterSet, AtTheFarCornerOfTheLargestMap) {
  ScenePack pack = flatPack(2147483, 2147483);
  pack.crater_limits = {.radius_q = rules::kCraterReachLimit, .hash_cell_q = 600000};
  std::vector<Crater> craters(2, Crater{.x_q = 2147482999,
                                        .y_q = 2147482000,
                                        .inner_radius_q = 0,
                                        .crest_radius_q = 4000000,
                                        .rim_height_q = 50000,
                                        .depth_q = 90000});
  craters[1].x_q = INT32_MAX;
  craters[1].id = 1;
  for (const Crater& crater : craters) ASSERT_TRUE(validateCrater(pack, crater));
  const CraterSet set = setOf(pack, craters);
  EXPECT_EQ(set.meeting({2147400, 2147400, 2147483, 2147483}).size(), 2u);
  std::vector<std::int32_t> corner(4), beyond(1, 7);
  set.fill(2147481, 2147481, 1, 2, 2, corner);
  for (const std::int32_t displacement : corner) EXPECT_NEAR(displacement, -180000, 10);
  set.fill(2147483, 2147482, 1, 1, 1, beyond);
  EXPECT_EQ(beyond[0], 0);
}

TEST(CraterSet, LooksAtTheRecordsOfTheCellsThatABoxMeetsAndAtNoOthers) {
  const ScenePack pack = cratersPack(1875);
  const std::int32_t side = pack.crater_limits.hash_cell_q;
  const std::vector<Crater> craters = randomCraters(pack, 12, 600);
  const CraterSet set = setOf(pack, craters);
  std::size_t all_read = 0, all_in_buckets = 0;
  for (int y = 0; y < kHeight; y += 7)
    for (int x = 0; x < kWidth; x += 5) {
      std::size_t read = 999;
      set.meeting({x, y, x + 1, y + 1}, &read);
      std::size_t expected = 0;
      for (int cell_y = y * 1000 / side; cell_y <= (y * 1000 + 999) / side; ++cell_y)
        for (int cell_x = x * 1000 / side; cell_x <= (x * 1000 + 999) / side; ++cell_x) {
          expected += std::size_t(std::ranges::count_if(craters, [&](const Crater& crater) {
            const auto outer = std::int32_t(crater.outerRadius());
            return crater.x_q + outer >= cell_x * side && crater.x_q - outer < (cell_x + 1) * side &&
                   crater.y_q + outer >= cell_y * side && crater.y_q - outer < (cell_y + 1) * side;
          }));
          const auto bucket = std::size_t(rules::craterBucket(cell_x, cell_y, set.table().mask()));
          all_in_buckets += std::size_t(set.table().used[bucket]);
        }
      ASSERT_EQ(read, expected) << "cell " << x << ", " << y;
      all_read += read;
    }
  EXPECT_LT(all_read, all_in_buckets) << "buckets hold other cells' records too";
}

TEST(CraterSet, AFarCraterIsNotInAQuery) {
  ScenePack pack = flatPack(600000, 1000);  // 60 km
  pack.crater_limits = {.radius_q = 300000, .hash_cell_q = 750000};
  const Crater near{.x_q = 5000000, .y_q = 500000, .crest_radius_q = 100000, .depth_q = 5000};
  Crater far = near;
  far.x_q += 500000000;  // 50 km
  far.id = 1;
  const std::vector<Crater> craters = {near, far};
  const CraterSet set = setOf(pack, craters);
  EXPECT_EQ(set.meeting({4900, 400, 5100, 600}), std::vector<std::uint32_t>{0});
  EXPECT_EQ(set.meeting({504900, 400, 505100, 600}), std::vector<std::uint32_t>{1});
  EXPECT_TRUE(set.meeting({300000, 0, 300064, 64}).empty());
}

TEST(CraterSet, OfNoCratersIsEmptyEverywhere) {
  const CraterSet none, empty(cratersPack(5000));
  for (const CraterSet* set : {&none, &empty}) {
    EXPECT_TRUE(set->meeting({0, 0, 100, 100}).empty());
    std::vector<std::int32_t> displacement(6, 5);
    set->fill(0, 0, 1, 3, 2, displacement);
    EXPECT_EQ(displacement, std::vector<std::int32_t>(6, 0));
  }
}

TEST(DormantGround, IsTheBaseAndItsCratersAndNeverBelowBedrock) {
  ScenePack pack = cratersPack(6000);
  pack.soil_depth_q = 3000;
  std::vector<Crater> craters = randomCraters(pack, 10, 40);
  craters.push_back({.x_q = 70000, .y_q = 50000, .crest_radius_q = 10000, .rim_height_q = 500, .depth_q = 1 << 20});
  craters = numbered(std::move(craters));
  const BaseTerrain base(pack);
  const CraterSet set = setOf(pack, craters);
  const DormantGround dormant{&base, &set};
  const TileCoordinate extent = tileExtent(pack);
  int at_bedrock = 0, above = 0;
  PlaneCells heights;
  for (int y = 0; y < extent.y; ++y)
    for (int x = 0; x < extent.x; ++x) {
      dormant.fillHeights({x, y}, heights);
      const auto tile = makeTile({x, y}, dormant, 9);
      EXPECT_EQ(tile->height(), heights);
      for (int i = 0; i < rules::kTileCells; ++i) {
        const int cell_x = x * 64 + i % 64, cell_y = y * 64 + i / 64;
        const bool inside = cell_x < kWidth && cell_y < kHeight;
        const std::int64_t untouched = inside ? base.height(cell_x, cell_y) : 0;
        const std::int64_t wanted = untouched + totalAt(pack, craters, cell_x, cell_y);
        const std::int64_t bedrock = inside ? untouched - pack.soil_depth_q : 0;
        ASSERT_EQ(heights[std::size_t(i)], std::max(wanted, bedrock)) << cell_x << ", " << cell_y;
        at_bedrock += inside && wanted < bedrock ? 1 : 0;
        above += wanted > untouched ? 1 : 0;
        if (i % 331 == 0) {
          ASSERT_EQ(dormant.height(cell_x, cell_y), heights[std::size_t(i)]);
        }
      }
    }
  EXPECT_GT(at_bedrock, 50);
  EXPECT_GT(above, 50);
}

TEST(DormantGround, SeenFromAfarIsEveryFewCellsOfIt) {
  const ScenePack pack = cratersPack(6000);
  const std::vector<Crater> craters = randomCraters(pack, 11, 50);
  const BaseTerrain base(pack);
  const CraterSet set = setOf(pack, craters);
  const DormantGround dormant{&base, &set}, untouched{&base, nullptr};
  std::vector<std::int32_t> seen(20 * 15), plain(20 * 15);
  dormant.fillArea(-8, -16, 8, 20, 15, seen);
  untouched.fillArea(-8, -16, 8, 20, 15, plain);
  EXPECT_NE(seen, plain);
  for (int row = 0; row < 15; ++row)
    for (int column = 0; column < 20; ++column) {
      const int x = column * 8 - 8, y = row * 8 - 16;
      EXPECT_EQ(seen[std::size_t(row * 20 + column)], dormant.height(x, y));
      EXPECT_EQ(plain[std::size_t(row * 20 + column)], base.height(x, y));
      if (x < 0 || y < 0 || x >= kWidth) {
        EXPECT_EQ(seen[std::size_t(row * 20 + column)], 0);
      }
    }
}

}  // namespace
}  // namespace spoor::test
