// The spatial hash that compute shaders build is the host's, to the bit.
#include "shaders/host/gl_crater_table.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "shaders/host/gl_context.h"
#include "shaders/host/gl_limits.h"
#include "shared/world/pack.h"
#include "tests/gl_cases.h"

namespace spoor::test {
namespace {

/// A map of square cells of 0.1 m.
ScenePack mapPack(int width, int height, int radius_q, int hash_cell_q) {
  ScenePack pack;
  pack.width_cells = width;
  pack.height_cells = height;
  pack.cell_q = 1000;
  pack.crater_limits.radius_q = radius_q;
  pack.crater_limits.hash_cell_q = hash_cell_q;
  return pack;
}

class GlCraterTables : public ::testing::Test {
 protected:
  void SetUp() override {
    if (const std::string& lack = lackOf(glCases()[0]); !lack.empty()) GTEST_SKIP() << lack;
    auto context = openHeadlessContext();
    ASSERT_TRUE(context) << context.error();
    context_ = std::move(*context);
    const auto limits = checkLimits(*context_);
    ASSERT_TRUE(limits) << limits.error();
    table_ = std::make_unique<GlCraterTable>(limits->storage_block_bytes);
  }

  Crater craterAt(const ScenePack& pack, int x_q, int y_q, int outer) {
    Crater crater;
    crater.x_q = x_q;
    crater.y_q = y_q;
    crater.crest_radius_q = std::max(1, outer * 2 / 3);
    crater.inner_radius_q = 2 * crater.crest_radius_q - std::min(outer, pack.crater_limits.radius_q);
    crater.inner_radius_q = std::clamp(crater.inner_radius_q, 0, crater.crest_radius_q);
    crater.rim_height_q = drawn(0, 2000);
    crater.depth_q = drawn(0, 5000);
    crater.noise_seed = std::uint16_t(drawn(0, 65535));
    crater.noise_q16 = std::uint16_t(drawn(0, 20000));
    return crater;
  }

  /// Anywhere on the map and a little beyond, of any size.
  Crater randomCrater(const ScenePack& pack) {
    const int radius = pack.crater_limits.radius_q;
    return craterAt(pack, drawn(-radius / 4, pack.width_cells * pack.cell_q + radius / 4),
                    drawn(-radius / 4, pack.height_cells * pack.cell_q + radius / 4), drawn(2, radius));
  }

  void add(CraterSet& set, std::vector<Crater> craters) {
    auto id = std::uint32_t(set.size());
    for (Crater& crater : craters) {
      crater.id = id++;
      crater.tick = 1;
    }
    set.add(craters);
  }

  void addRandom(CraterSet& set, const ScenePack& pack, int count) {
    std::vector<Crater> craters;
    for (int i = 0; i < count; ++i) craters.push_back(randomCrater(pack));
    add(set, std::move(craters));
  }

  int drawn(int low, int high) { return std::uniform_int_distribution<int>(low, high)(engine_); }

  void update(const CraterSet& set) {
    const Status status = table_->update(set, 1000);
    ASSERT_TRUE(status) << status.error();
  }

  /// What the device has at a binding, after bind(0).
  template <typename T>
  static std::vector<T> download(GLuint binding, std::size_t count) {
    std::vector<T> values(count);
    GLint name = 0;
    glGetIntegeri_v(GL_SHADER_STORAGE_BUFFER_BINDING, binding, &name);
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    if (count > 0) glGetNamedBufferSubData(GLuint(name), 0, std::int64_t(count * sizeof(T)), values.data());
    checkGl("reading a table");
    return values;
  }

  /// Compares all arrays.
  void compare(const CraterSet& set) {
    const CraterTable& table = set.table();
    table_->bind(0);
    const auto head = download<rules::CraterHead>(0, 1)[0];
    ASSERT_EQ(head.count, int(set.size()));
    ASSERT_EQ(head.mask, set.size() == 0 ? -1 : table.mask());
    if (set.size() == 0) return;
    ASSERT_EQ(head.side, table.side_q);
    ASSERT_EQ(head.width, table.width_q);
    ASSERT_EQ(head.height, table.height_q);
    ASSERT_EQ(download<std::int32_t>(2, table.first.size()), table.first) << set.size() << " craters";
    ASSERT_EQ(download<std::int32_t>(3, table.used.size()), table.used) << set.size() << " craters";
    const auto entries = download<rules::CraterEntry>(4, table.entries.size());
    for (std::size_t i = 0; i < entries.size(); ++i) {
      ASSERT_EQ(entries[i].record, table.entries[i].record) << "entry " << i << ", " << set.size() << " craters";
      ASSERT_EQ(entries[i].tag, table.entries[i].tag) << "entry " << i << ", " << set.size() << " craters";
    }
    const auto shapes = download<rules::CraterShape>(1, set.size());
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      const rules::CraterShape shape = shapeOf(set.records()[i]);
      ASSERT_EQ(std::memcmp(&shapes[i], &shape, sizeof shape), 0) << "shape " << i;
    }
  }

  void updateAndCompare(const CraterSet& set) {
    ASSERT_NO_FATAL_FAILURE(update(set));
    ASSERT_NO_FATAL_FAILURE(compare(set));
  }

  std::unique_ptr<HeadlessContext> context_;
  std::unique_ptr<GlCraterTable> table_;
  std::mt19937 engine_{1};
};

TEST_F(GlCraterTables, AnEmptySetHasNoBuckets) { updateAndCompare(CraterSet(mapPack(100, 100, 20000, 50000))); }

TEST_F(GlCraterTables, RandomBatchesAreAddedWithRebuildsAndWithout) {
  for (const int side : {2000, 9000, 200000}) {
    SCOPED_TRACE(side);
    const ScenePack pack = mapPack(900, 700, 30000, side);
    CraterSet set(pack);
    int kept = 0;
    for (int round = 0; round < 40; ++round) {
      const std::uint32_t before = set.table().generation;
      addRandom(set, pack, 1 << drawn(0, round < 20 ? 4 : 7));
      kept += set.table().generation == before ? 1 : 0;
      ASSERT_NO_FATAL_FAILURE(updateAndCompare(set));
    }
    EXPECT_GT(kept, 5) << "batches without a rebuild";
    EXPECT_GT(set.table().generation, 3u);
    table_->forget();
  }
}

TEST_F(GlCraterTables, RecordsThatCameSinceTheTableWasBuiltAreInARebuildToo) {
  const ScenePack pack = mapPack(900, 700, 30000, 9000);
  CraterSet set(pack);
  addRandom(set, pack, 500);
  for (int i = 0; i < 30; ++i) addRandom(set, pack, 1);
  ASSERT_LT(set.table().built_count, set.size()) << "no batch without a rebuild";
  updateAndCompare(set);
}

/// As a client's after a new snapshot: built once, as the one before.
TEST_F(GlCraterTables, AnotherSetWithTheSameFirstRecordsIsLaidOutAnew) {
  const ScenePack pack = mapPack(400, 400, 20000, 50000);
  CraterSet before(pack), after(pack);
  addRandom(before, pack, 10);
  ASSERT_NO_FATAL_FAILURE(updateAndCompare(before));
  std::vector<Crater> craters(before.records().begin(), before.records().end());
  for (int i = 0; i < 500; ++i) craters.push_back(randomCrater(pack));
  add(after, std::move(craters));
  ASSERT_EQ(after.table().generation, before.table().generation);
  ASSERT_NO_FATAL_FAILURE(updateAndCompare(after));
}

TEST_F(GlCraterTables, NewCratersTravelAloneAndLeaveTheRest) {
  const ScenePack pack = mapPack(900, 700, 30000, 40000);
  CraterSet set(pack);
  addRandom(set, pack, 3000);
  ASSERT_NO_FATAL_FAILURE(updateAndCompare(set));
  const std::uint32_t generation = set.table().generation;
  const std::int64_t copied = table_->copiedBytes(), dispatched = table_->dispatchCount();
  addRandom(set, pack, 3);
  ASSERT_EQ(set.table().generation, generation);
  ASSERT_NO_FATAL_FAILURE(updateAndCompare(set));
  EXPECT_EQ(table_->copiedBytes() - copied, 3 * 64 + 32);
  EXPECT_EQ(table_->dispatchCount() - dispatched, 3);
  ASSERT_NO_FATAL_FAILURE(update(set));
  EXPECT_EQ(table_->copiedBytes() - copied, 3 * 64 + 32) << "nothing new";
}

TEST_F(GlCraterTables, ACraterInManyCells) {
  const ScenePack pack = mapPack(1000, 1000, 160000, 10000);
  CraterSet set(pack);
  add(set, {craterAt(pack, 500000, 500000, 160000)});
  ASSERT_NO_FATAL_FAILURE(updateAndCompare(set));
  for (int i = 0; i < 6; ++i) {
    add(set, {craterAt(pack, 450000 + i * 20000, 500000, 160000), craterAt(pack, 0, 999999, 160000)});
    ASSERT_NO_FATAL_FAILURE(updateAndCompare(set));
  }
}

TEST_F(GlCraterTables, TagsThatWrapKeepTheirOrder) {
  const ScenePack pack = mapPack(1100, 1100, 256, 16);  // 68 750 hash cells a side
  CraterSet set(pack);
  constexpr int kWrap = 65536 * 16;
  for (int i = 0; i < 60; ++i) {
    std::vector<Crater> craters;
    for (int k = 0; k < 5; ++k)
      craters.push_back(craterAt(pack, drawn(0, 2) > 0 ? kWrap + drawn(-200, 200) : drawn(0, 1099999),
                                 drawn(0, 2) > 0 ? kWrap + drawn(-200, 200) : drawn(0, 1099999), drawn(2, 256)));
    add(set, std::move(craters));
    ASSERT_NO_FATAL_FAILURE(updateAndCompare(set));
  }
  // The case is there: of one record in one bucket, an entry after the wrap stands before one that is visited earlier.
  const CraterTable& table = set.table();
  bool wrapped = false;
  for (std::size_t bucket = 0; bucket < table.used.size(); ++bucket)
    for (int i = table.first[bucket]; i + 1 < table.first[bucket] + table.used[bucket]; ++i) {
      const auto &a = table.entries[std::size_t(i)], &b = table.entries[std::size_t(i) + 1];
      wrapped |= a.record == b.record && (a.tag & 0xffff) < 64 && (b.tag & 0xffff) > 0xff00;
    }
  EXPECT_TRUE(wrapped);
}

TEST_F(GlCraterTables, ThousandsOnOneSpot) {
  const ScenePack pack = mapPack(300, 300, 30000, 50000);
  CraterSet set(pack);
  add(set, std::vector<Crater>(7000, craterAt(pack, 130000, 130000, 30000)));
  ASSERT_NO_FATAL_FAILURE(updateAndCompare(set));
  add(set, std::vector<Crater>(1000, craterAt(pack, 130000, 130000, 30000)));
  updateAndCompare(set);
}

TEST_F(GlCraterTables, ASetThatLostItsNewestIsTakenUpAfterForgetting) {
  const ScenePack pack = mapPack(900, 700, 30000, 20000);
  CraterSet set(pack);
  addRandom(set, pack, 300);
  ASSERT_NO_FATAL_FAILURE(updateAndCompare(set));
  set.truncate(220);
  addRandom(set, pack, 100);
  table_->forget();
  table_->bind(0);
  EXPECT_EQ(download<rules::CraterHead>(0, 1)[0].mask, -1) << "a device that forgot has no craters";
  ASSERT_NO_FATAL_FAILURE(updateAndCompare(set));
  set.truncate(0);
  table_->forget();
  ASSERT_NO_FATAL_FAILURE(updateAndCompare(set));
}

TEST_F(GlCraterTables, HundredThousandCraters) {
  const ScenePack pack = mapPack(40000, 40000, 60000, 100000);
  CraterSet set(pack);
  addRandom(set, pack, 90000);
  ASSERT_NO_FATAL_FAILURE(updateAndCompare(set));
  for (int i = 0; i < 4; ++i) {
    addRandom(set, pack, 2500);
    ASSERT_NO_FATAL_FAILURE(updateAndCompare(set));
  }
}

}  // namespace
}  // namespace spoor::test
