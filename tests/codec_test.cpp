// Tile changes, ticks and snapshots as bytes.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "shared/codec/tile_codec.h"
#include "tests/scenes.h"

namespace spoor::test {
namespace {

/// Two bodies that cross a world of 3 x 2 tiles.
ScenePack crossingPack() {
  ScenePack pack = noisePack(150, 100, 9, -4000, 4000, 50000);
  addBody(pack, boxMesh(6000, 4000, 3000), 20000, 50000, 900);
  addBody(pack, wedgeMesh(4000, 7000, 3000), 120000, 60000, 1500);
  return pack;
}

std::vector<Pose> crossingPoses(const WorldState& state) {
  return {moved(state.poses[0], 900, 100, 0, 40), moved(state.poses[1], -1400, 0, -20, 0)};
}

/// Whatever a state holds, in canonical bytes.
std::vector<std::uint8_t> bytesOf(const WorldState& state, const BaseTerrain& base) {
  auto bytes = encodeSnapshot(state, base);
  for (const std::uint64_t value :
       {stateHash(state), state.tiles_hash, std::uint64_t(state.ledger.initial), std::uint64_t(state.ledger.ground)})
    for (int shift = 0; shift < 64; shift += 8) bytes.push_back(std::uint8_t(value >> shift));
  return bytes;
}

class Codec : public ::testing::Test {
 protected:
  World world_{crossingPack()};
  Simulation simulation_ = world_.simulate();
  WorldState mirror_ = initialState(world_.id, world_.base);

  TickResult tick() {
    auto result = simulation_.step(crossingPoses(simulation_.state()));
    EXPECT_TRUE(result);
    return std::move(*result);
  }
  /// Runs some ticks on both sides.
  void follow(int count) {
    for (int i = 0; i < count; ++i) ASSERT_TRUE(applyTick(mirror_, world_.base, tick().update));
  }
};

TEST_F(Codec, AMirrorHasTheServersHashAndLedgerAfterEveryTick) {
  for (int i = 0; i < 40; ++i) {
    const TickResult result = tick();
    const Status status = applyTick(mirror_, world_.base, result.update);
    ASSERT_TRUE(status) << status.error();
    ASSERT_EQ(stateHash(mirror_), result.update.state_hash);
    ASSERT_EQ(mirror_.ledger, simulation_.state().ledger);
    ASSERT_TRUE(recount(mirror_));
  }
  EXPECT_GT(mirror_.tiles.size(), 3u);
  EXPECT_EQ(encodeSnapshot(mirror_, world_.base), encodeSnapshot(simulation_.state(), world_.base));
}

TEST_F(Codec, ChangesDecodeToWhatWasEncoded) {
  for (int i = 0; i < 5; ++i) {
    const TickResult result = tick();
    const auto decoded = decodeTiles(result.update.tiles, world_.pack);
    ASSERT_TRUE(decoded) << decoded.error();
    ASSERT_EQ(decoded->size(), result.effect.changes.size());
    EXPECT_EQ(encodeTiles(*decoded), result.update.tiles);
    for (std::size_t k = 0; k < decoded->size(); ++k) {
      const TileChange &a = (*decoded)[k], &b = result.effect.changes[k];
      EXPECT_EQ(a.at, b.at);
      EXPECT_EQ(std::tuple(a.base_version, a.new_version, a.wake_mask, a.hash),
                std::tuple(b.base_version, b.new_version, b.wake_mask, b.hash));
      EXPECT_EQ(std::tuple(a.x, a.y, a.width, a.height), std::tuple(b.x, b.y, b.width, b.height));
      EXPECT_EQ(a.difference, b.difference);
    }
  }
}

TEST_F(Codec, DifferencesOfEveryWidthSurvive) {
  for (const std::int32_t largest :
       {1, -1, 127, -128, 128, 32767, -32769, 1 << 23, -(1 << 23) - 1, INT32_MAX, INT32_MIN}) {
    TileChange change;
    change.new_version = 3;
    change.x = 61;
    change.y = 63;
    change.width = 3;
    change.height = 1;
    change.difference = {0, largest, -7};
    const auto decoded = decodeTiles(encodeTiles(std::span(&change, 1)), world_.pack);
    ASSERT_TRUE(decoded) << decoded.error();
    EXPECT_EQ(decoded->at(0).difference, change.difference);
  }
}

TEST_F(Codec, TheBoxIsTheSmallestThatHoldsTheChange) {
  const auto tile = makeTile({0, 0}, {&world_.base}, 4);
  const PlaneCells before = tile->height();
  EXPECT_EQ(differenceOf(*tile, planesWith(*tile, before), 2).width, 0);
  tile->height()[std::size_t(5 * 64 + 9)] += 3;
  tile->height()[std::size_t(7 * 64 + 8)] -= 1;
  const TileChange change = differenceOf(*tile, planesWith(*tile, before), 2);
  EXPECT_EQ(std::tuple(int(change.x), int(change.y), int(change.width), int(change.height)), std::tuple(8, 5, 2, 3));
  EXPECT_EQ(change.difference, (std::vector<std::int32_t>{0, 3, 0, 0, -1, 0}));
  EXPECT_EQ(std::pair(change.base_version, change.new_version), std::pair(2, 4));
}

TEST_F(Codec, HeightsBelowBedrockAndOutsideTheWorldAreRefusedWhateverTheirHash) {
  // Tile (2, 1) of 150 x 100 cells: column 63 lies outside. Soil is 50 000 deep.
  for (const auto& [cell, change_q, why] : {std::tuple(0, -50001, "below bedrock"), std::tuple(63, 1, "outside")}) {
    const auto tile = makeTile({2, 1}, {&world_.base}, 1);
    const PlaneCells before = tile->height();
    tile->height()[std::size_t(cell)] += change_q;
    tile->hash = tileHash(*tile);
    const TileChange change = differenceOf(*tile, planesWith(*tile, before), kDormantVersion);
    EXPECT_FALSE(applyTiles(mirror_, world_.base, std::span(&change, 1), 1)) << why;
    EXPECT_EQ(mirror_.tiles.size(), 0u);
  }
}

TEST_F(Codec, DecodeRejectsMoreTilesThanTheLimit) {
  std::vector<TileChange> changes(3);
  for (int i = 0; i < 3; ++i) changes[std::size_t(i)].at = {i, 0};
  EXPECT_TRUE(decodeTiles(encodeTiles(changes), world_.pack, 3));
  EXPECT_FALSE(decodeTiles(encodeTiles(changes), world_.pack, 2));
}

TEST_F(Codec, DecodeRejectsEveryTruncationAndATrailingByte) {
  follow(3);
  auto bytes = tick().update.tiles;
  for (std::size_t size = 0; size < bytes.size(); ++size)
    ASSERT_FALSE(decodeTiles(std::span(bytes).first(size), world_.pack)) << size << " of " << bytes.size();
  bytes.push_back(0);
  EXPECT_FALSE(decodeTiles(bytes, world_.pack));
}

TEST_F(Codec, DecodeRejectsAnEntryThatCannotBe) {
  const TileChange good{{1, 1}, 2, 3, kWakeSelf, 77, 4, 5, 2, 1, {8, 9}};
  const auto decodes = [&](const TileChange& a, const TileChange& b) {
    const TileChange both[] = {a, b};
    return bool(decodeTiles(encodeTiles(both), world_.pack));
  };
  TileChange before = good;
  before.at = {0, 0};
  ASSERT_TRUE(decodes(before, good));
  EXPECT_FALSE(decodes(good, before)) << "out of order";
  EXPECT_FALSE(decodes(good, good)) << "twice the same tile";
  const auto isRejected = [&](auto change) {
    TileChange bad = good;
    change(bad);
    return !decodes(before, bad);
  };
  EXPECT_TRUE(isRejected([](TileChange& c) { c.at = {3, 1}; })) << "outside the world";
  EXPECT_TRUE(isRejected([](TileChange& c) { c.at = {-1, 1}; })) << "outside the world";
  EXPECT_TRUE(isRejected([](TileChange& c) { c.at = {0, 2}; })) << "outside the world";
  EXPECT_TRUE(isRejected([](TileChange& c) { c.base_version = 4; })) << "versions run backwards";
  EXPECT_TRUE(isRejected([](TileChange& c) { c.base_version = -2; })) << "no such version";
  EXPECT_TRUE(isRejected([](TileChange& c) { c.wake_mask = kWakeMaskLimit; })) << "unknown bit";
  EXPECT_TRUE(isRejected([](TileChange& c) { c.x = 63; })) << "box leaves the tile";
  EXPECT_TRUE(isRejected([](TileChange& c) { c.y = 64; })) << "box leaves the tile";
  EXPECT_TRUE(isRejected([](TileChange& c) { c.difference.clear(); })) << "box without differences";
  EXPECT_TRUE(isRejected([](TileChange& c) { c.width = c.height = 0; })) << "differences without a box";
}

TEST_F(Codec, AWrongChangeIsRefusedAndLeavesTheStateUntouched) {
  follow(6);
  const TickResult next = tick();
  ASSERT_GE(next.effect.changes.size(), 2u);
  ASSERT_FALSE(next.effect.changes.back().difference.empty());
  const auto before = bytesOf(mirror_, world_.base);
  const auto isRefused = [&](auto change) {
    auto changes = next.effect.changes;
    change(changes.back());  // the last, so that all before it have been checked and found good
    const Status status = applyTiles(mirror_, world_.base, changes, mirror_.tick + 1);
    const bool untouched = bytesOf(mirror_, world_.base) == before;
    const TileCoordinate at = changes.back().at;
    const std::string name = "tile (" + std::to_string(at.x) + ", " + std::to_string(at.y) + ")";
    return !status && untouched && status.error().find(name) != std::string::npos;
  };
  EXPECT_TRUE(isRefused([](TileChange& c) { c.hash ^= 1; })) << "wrong hash";
  EXPECT_TRUE(isRefused([](TileChange& c) { c.base_version -= 1; })) << "wrong base version";
  EXPECT_TRUE(isRefused([](TileChange& c) { c.base_version = kDormantVersion; })) << "not dormant";
  EXPECT_TRUE(isRefused([](TileChange& c) { c.difference[0] += 1; })) << "wrong cell";
  EXPECT_TRUE(isRefused([](TileChange& c) { c.difference[0] = INT32_MAX; })) << "height out of range";
  const Status status = applyTick(mirror_, world_.base, next.update);
  EXPECT_TRUE(status) << "the right change still fits: " << status.error();
}

TEST_F(Codec, AWrongTickIsRefused) {
  follow(2);
  const TickUpdate good = tick().update;
  const auto before = bytesOf(mirror_, world_.base);
  const auto isRefused = [&](auto change) {
    TickUpdate bad = good;
    change(bad);
    return !applyTick(mirror_, world_.base, bad) && bytesOf(mirror_, world_.base) == before;
  };
  EXPECT_TRUE(isRefused([](TickUpdate& u) { u.tick += 1; }));
  EXPECT_TRUE(isRefused([](TickUpdate& u) { u.tick -= 1; }));
  EXPECT_TRUE(isRefused([](TickUpdate& u) { u.poses.pop_back(); }));
  EXPECT_TRUE(isRefused([](TickUpdate& u) { u.tiles.pop_back(); }));
  ASSERT_TRUE(applyTick(mirror_, world_.base, good));
}

TEST_F(Codec, AnotherStateHashIsReported) {
  TickUpdate update = tick().update;
  update.state_hash ^= 1;
  const Status status = applyTick(mirror_, world_.base, update);
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().find("state hash"), std::string::npos);
}

TEST_F(Codec, DamagedChangesNeverHarmTheState) {
  follow(8);
  const TickUpdate good = tick().update;
  const auto before = encodeSnapshot(mirror_, world_.base);
  std::mt19937 engine(71);
  int accepted = 0;
  for (int round = 0; round < 20000; ++round) {
    auto bytes = good.tiles;
    if (round % 10 == 0) {
      for (auto& byte : bytes) byte = std::uint8_t(engine());
    } else if (round % 10 == 1) {
      bytes.resize(engine() % (bytes.size() + 40));
    }
    for (auto left = 1 + engine() % 3; left > 0 && !bytes.empty(); --left)
      bytes[engine() % bytes.size()] ^= std::uint8_t(1 + engine() % 255);
    const auto changes = decodeTiles(bytes, world_.pack);
    if (!changes || !applyTiles(mirror_, world_.base, *changes, mirror_.tick + 1)) continue;
    // Every tile's own hash was right, so its cells are: as after the good tick, or, where it is not named, as before.
    ++accepted;
    ASSERT_TRUE(recount(mirror_)) << "round " << round;
    for (const Tile* tile : mirror_.tiles.sorted()) {
      const std::uint64_t hash = simulation_.state().tiles.find(tile->at)->hash;
      const bool named =
          std::ranges::any_of(*changes, [tile](const TileChange& change) { return change.at == tile->at; });
      ASSERT_TRUE(!named || tile->hash == hash) << "round " << round;
    }
    mirror_ = std::move(*decodeSnapshot(before, world_.id, world_.base));
  }
  EXPECT_LT(accepted, 2000);
  EXPECT_EQ(encodeSnapshot(mirror_, world_.base), before);
  EXPECT_TRUE(applyTick(mirror_, world_.base, good)) << "the right bytes still fit";
}

TEST_F(Codec, ASnapshotHoldsTheWholeState) {
  follow(15);
  const auto bytes = encodeSnapshot(simulation_.state(), world_.base);
  auto decoded = decodeSnapshot(bytes, world_.id, world_.base);
  ASSERT_TRUE(decoded) << decoded.error();
  EXPECT_EQ(stateHash(*decoded), stateHash(simulation_.state()));
  EXPECT_EQ(decoded->ledger, simulation_.state().ledger);
  EXPECT_EQ(decoded->previous_poses, simulation_.state().previous_poses);
  EXPECT_EQ(encodeSnapshot(*decoded, world_.base), bytes);
  EXPECT_TRUE(recount(*decoded));
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(applyTick(*decoded, world_.base, tick().update)) << "a late joiner follows";
}

TEST_F(Codec, ASnapshotOfTheStartIsEmptyGround) {
  const auto decoded = decodeSnapshot(encodeSnapshot(mirror_, world_.base), world_.id, world_.base);
  ASSERT_TRUE(decoded) << decoded.error();
  EXPECT_EQ(decoded->tiles.size(), 0u);
  EXPECT_EQ(stateHash(*decoded), stateHash(mirror_));
}

TEST_F(Codec, SnapshotDecodeRejectsEveryTruncationAndATrailingByte) {
  follow(4);
  auto bytes = encodeSnapshot(simulation_.state(), world_.base);
  for (std::size_t size = 0; size < bytes.size(); size += size < 400 ? 1 : 97)
    ASSERT_FALSE(decodeSnapshot(std::span(bytes).first(size), world_.id, world_.base))
        << size << " of " << bytes.size();
  bytes.push_back(0);
  EXPECT_FALSE(decodeSnapshot(bytes, world_.id, world_.base));
}

TEST_F(Codec, SnapshotDecodeSurvivesDamagedBytes) {
  follow(10);
  const auto good = encodeSnapshot(simulation_.state(), world_.base);
  std::mt19937 engine(72);
  for (int round = 0; round < 2000; ++round) {
    auto bytes = good;
    bytes[engine() % (round % 2 == 0 ? 300 : bytes.size())] ^= std::uint8_t(1 + engine() % 255);
    const auto decoded = decodeSnapshot(bytes, world_.id, world_.base);
    if (decoded) {
      ASSERT_TRUE(recount(*decoded)) << "round " << round;
    }
  }
}

}  // namespace
}  // namespace spoor::test
