// The session file: record, replay, and every way to be cut off or damaged.
#include "shared/codec/session.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>

#include "shared/base/bytes.h"
#include "shared/base/hash.h"
#include "shared/world/pose_bytes.h"
#include "shared/world/script.h"
#include "tests/scenes.h"

namespace spoor::test {
namespace {

/// A body that drives 30 cells across level ground.
ScenePack drivePack() {
  ScenePack pack = flatPack(70, 30);
  addBody(pack, boxMesh(4000, 3000, 2000), 10000, 15000, 700);
  pack.paths[0] = {{{10000, 15000}, {40000, 15000}}, 1300, 0, 0};
  return pack;
}

using Bytes = std::vector<std::uint8_t>;

class Session : public ::testing::Test {
 protected:
  static constexpr int kTicks = 12;
  World world_{drivePack()};
  std::filesystem::path path_ =
      std::filesystem::path(::testing::TempDir()) / ("spoor_session_" + std::to_string(getpid()) + ".sprs");

  ~Session() override { std::filesystem::remove(path_); }

  /// Records a session, with parameters that change from some ticks on; returns its hashes.
  std::vector<std::uint64_t> record(const std::map<int, Parameters>& changes = {}) {
    auto writer = SessionWriter::create(path_.string(), encodePack(world_.pack));
    EXPECT_TRUE(writer) << writer.error();
    Simulation simulation = world_.simulate();
    const Script script(world_.base);
    std::vector<std::uint64_t> hashes;
    for (int tick = 1; tick <= kTicks; ++tick) {
      std::optional<Parameters> parameters;
      if (const auto found = changes.find(tick); found != changes.end()) parameters = found->second;
      const auto result = simulation.step(script.poses(tick), parameters);
      EXPECT_TRUE(result) << result.error();
      (*writer)->append({tick, result->update.poses, result->update.state_hash, simulation.state().ledger,
                         result->update.parameters});
      hashes.push_back(result->update.state_hash);
    }
    const Status status = (*writer)->close();
    EXPECT_TRUE(status) << status.error();
    return hashes;
  }
  Bytes read() const {
    std::ifstream file(path_, std::ios::binary);
    return Bytes(std::istreambuf_iterator<char>(file), {});
  }
  void write(std::span<const std::uint8_t> bytes) const {
    std::ofstream file(path_, std::ios::binary | std::ios::trunc);
    file.write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
  }

  struct Reading {
    std::string error;  // of opening, or of a record
    int ticks = 0;
    bool truncated = false;
  };
  Reading readAll() const {
    Reading reading;
    auto reader = SessionReader::open(path_.string());
    if (!reader) return {reader.error(), 0, false};
    for (;;) {
      auto tick = (*reader)->next();
      if (!tick) reading.error = tick.error();
      if (!tick || !*tick) break;
      ++reading.ticks;
    }
    reading.truncated = (*reader)->truncated();
    return reading;
  }
  /// Reads a file of the pack and one tick made by hand.
  /// @param whole    a recorded session of the pack
  /// @param craters  how many the tick announces
  /// @param block    what follows that: craters, then parameters
  Reading readWithTick(const Bytes& whole, std::uint32_t craters, const Bytes& crater_bytes, std::uint32_t snowfalls,
                       const Bytes& rest) {
    ByteWriter payload;
    payload.put(std::int32_t(1));
    for (int i = 0; i < 6; ++i) payload.put(std::int64_t(0));  // hash and ledger
    payload.put(std::uint32_t(world_.pack.bodies.size()));
    for (const Pose& pose : Script(world_.base).poses(1)) putPose(payload, pose);
    payload.put(craters);
    payload.putBytes(crater_bytes);
    payload.put(snowfalls);
    payload.putBytes(rest);
    ByteWriter file;
    file.putBytes(std::span(whole).first(recordStarts(whole)[1]));
    file.put(std::uint32_t(payload.bytes.size()));
    file.put(std::uint8_t(2));
    file.putBytes(payload.bytes);
    file.put(hashBytes(payload.bytes, 2));
    write(file.bytes);
    return readAll();
  }
  /// Where each record begins; the last entry is the end of the file.
  static std::vector<std::size_t> recordStarts(const Bytes& bytes) {
    std::vector<std::size_t> starts = {8};
    while (starts.back() < bytes.size()) {
      const std::size_t at = starts.back();
      const std::size_t payload = bytes[at] | std::size_t(bytes[at + 1]) << 8 | std::size_t(bytes[at + 2]) << 16;
      starts.push_back(at + 4 + 1 + payload + 8);
    }
    return starts;
  }
};

class SessionReplay : public Session, public ::testing::WithParamInterface<BackendCase> {
 protected:
  void SetUp() override {
    if (const std::string& lack = lackOf(GetParam()); !lack.empty()) GTEST_SKIP() << lack;
  }
};

TEST_P(SessionReplay, OfTheFileHasTheRecordedHashesAndLedgers) {
  const auto hashes = record();
  auto reader = SessionReader::open(path_.string());
  ASSERT_TRUE(reader) << reader.error();
  EXPECT_EQ((*reader)->id(), world_.id);
  EXPECT_EQ(encodePack((*reader)->pack()), encodePack(world_.pack));
  const BaseTerrain base((*reader)->pack());
  Simulation replay(base, (*reader)->id(), borrowBackend(GetParam()));
  for (int tick = 1; tick <= kTicks; ++tick) {
    const auto record = (*reader)->next();
    ASSERT_TRUE(record) << record.error();
    ASSERT_TRUE(record->has_value());
    EXPECT_EQ((*record)->tick, tick);
    EXPECT_EQ((*record)->state_hash, hashes[std::size_t(tick - 1)]);
    const auto result = replay.step((*record)->poses);
    ASSERT_TRUE(result) << result.error();
    EXPECT_EQ(result->update.state_hash, (*record)->state_hash);
    EXPECT_EQ(replay.state().ledger, (*record)->ledger);
  }
  const auto end = (*reader)->next();
  ASSERT_TRUE(end);
  EXPECT_FALSE(end->has_value());
  EXPECT_FALSE((*reader)->truncated());
}

TEST_P(SessionReplay, OfChangedParametersHasTheRecordedHashes) {
  Parameters steep = world_.pack.parameters, tight = steep;
  steep.materials[0].slope_threshold_q = steep.materials[0].diagonal_threshold_q = kNeverSteep;
  tight.materials[0].slope_threshold_q = 150;
  tight.materials[0].diagonal_threshold_q = 212;
  tight.sweeps_per_tick = 3;
  const auto plain = record();
  const auto hashes = record({{1, steep}, {7, tight}});
  EXPECT_NE(plain.front(), hashes.front()) << "parameters are part of the state";
  EXPECT_NE(plain.back(), hashes.back());
  auto reader = SessionReader::open(path_.string());
  ASSERT_TRUE(reader) << reader.error();
  const BaseTerrain base((*reader)->pack());
  Simulation replay(base, (*reader)->id(), borrowBackend(GetParam()));
  for (int tick = 1; tick <= kTicks; ++tick) {
    const auto record = (*reader)->next();
    ASSERT_TRUE(record && record->has_value());
    EXPECT_EQ((*record)->parameters.has_value(), tick == 1 || tick == 7) << tick;
    if (tick == 7) {
      EXPECT_EQ((*record)->parameters, tight);
    }
    const auto result = replay.step((*record)->poses, (*record)->parameters);
    ASSERT_TRUE(result) << result.error();
    EXPECT_EQ(result->update.state_hash, hashes[std::size_t(tick - 1)]) << tick;
  }
  EXPECT_EQ(replay.state().parameters, tight);
}

SPOOR_ON_EVERY_BACKEND(SessionReplay);

TEST_F(Session, ParametersThatCannotBeAreReported) {
  record();
  const Bytes whole = read();
  const auto withParameters = [&](const Parameters& parameters, std::size_t size) {
    ByteWriter block;
    putParameters(block, parameters);
    block.bytes.resize(size);
    return readWithTick(whole, 0, {}, 0, block.bytes);
  };
  Parameters good = world_.pack.parameters;
  const std::size_t bytes = parametersBytes(1);
  EXPECT_EQ(withParameters(good, bytes).error, "");
  EXPECT_EQ(withParameters(good, bytes).ticks, 1);
  EXPECT_EQ(withParameters(good, 0).error, "") << "none";
  for (const std::size_t size : {std::size_t(1), bytes - 1, bytes + 1, 2 * bytes})
    EXPECT_NE(withParameters(good, size).error.find("is of a wrong size"), std::string::npos) << size;
  Parameters wrong = good;
  wrong.spread_cells = 65;
  EXPECT_NE(withParameters(wrong, bytes).error.find("spread_cells is 65"), std::string::npos);
}

TEST_F(Session, CratersThatCannotBeAreReported) {
  world_.pack.crater_limits.radius_q = 20000;
  record();
  const Bytes whole = read();
  const auto withCraters = [&](std::uint32_t count, const Crater& crater, std::size_t bytes) {
    ByteWriter block;
    for (std::uint32_t i = 0; i < std::min(count, 4u); ++i) {
      Crater numbered = crater;
      numbered.id += i;
      putCrater(block, numbered);
    }
    block.bytes.resize(bytes);
    return readWithTick(whole, count, block.bytes, 0, {});
  };
  Crater good;
  good.x_q = good.y_q = 10000;
  good.crest_radius_q = 5000;
  good.tick = 1;
  EXPECT_EQ(withCraters(2, good, 2 * kCraterBytes).error, "");
  EXPECT_EQ(withCraters(2, good, 2 * kCraterBytes).ticks, 1);
  for (const std::size_t size : {std::size_t(0), kCraterBytes, 2 * kCraterBytes - 1, 2 * kCraterBytes + 1})
    EXPECT_NE(withCraters(2, good, size).error.find("is of a wrong size"), std::string::npos) << size;
  EXPECT_NE(withCraters(0xffffffff, good, kCraterBytes).error.find("is of a wrong size"), std::string::npos);
  Crater wrong = good;
  wrong.id = 1;
  EXPECT_NE(withCraters(1, wrong, kCraterBytes).error.find("of another tick or id"), std::string::npos);
  wrong = good;
  wrong.tick = 2;
  EXPECT_NE(withCraters(1, wrong, kCraterBytes).error.find("of another tick or id"), std::string::npos);
  wrong = good;
  wrong.depth_q = -1;
  EXPECT_NE(withCraters(1, wrong, kCraterBytes).error.find("D5 is -0.0001 m"), std::string::npos);
  wrong = good;
  wrong.crest_radius_q = INT32_MIN;
  EXPECT_NE(withCraters(1, wrong, kCraterBytes).error.find("R2 is -214748.3648 m"), std::string::npos);
}

TEST_F(Session, ASnapshotHoldsTheParametersOfItsTick) {
  Simulation simulation = world_.simulate();
  const Script script(world_.base);
  Parameters changed = world_.pack.parameters;
  changed.capacity_rounds = 9;
  changed.materials[0].slope_threshold_q = kNeverSteep;
  ASSERT_TRUE(simulation.step(script.poses(1), changed));
  ASSERT_TRUE(simulation.step(script.poses(2)));
  const Bytes bytes = encodeSnapshot(simulation.state(), world_.base);
  const auto state = decodeSnapshot(bytes, world_.id, world_.base);
  ASSERT_TRUE(state) << state.error();
  EXPECT_EQ(state->parameters, changed);
  EXPECT_EQ(stateHash(*state), stateHash(simulation.state()));
  ByteWriter block;
  putParameters(block, changed);
  constexpr std::size_t at = 4 + 8;  // after tick and hash
  ASSERT_TRUE(std::equal(block.bytes.begin(), block.bytes.end(), bytes.begin() + at));
  for (std::size_t i = 0; i < block.bytes.size(); ++i) {
    if (i == 6 + 9 * 4) continue;  // the number of materials: another one has other fields after it
    Bytes wrong = bytes;
    wrong[at + i] ^= 0x80;  // out of range, or else of another state
    const auto refused = decodeSnapshot(wrong, world_.id, world_.base);
    ASSERT_FALSE(refused) << i;
    const bool is_named = refused.error().find("snapshot: parameters: ") == 0;
    EXPECT_TRUE(is_named || refused.error().find("snapshot: state hash ") == 0) << refused.error();
    if (i < 6) {
      EXPECT_TRUE(is_named) << i << ": " << refused.error();
    }
  }
}

TEST_F(Session, AFileCutOffAnywhereGivesItsWholeTicks) {
  record();
  const Bytes bytes = read();
  const auto starts = recordStarts(bytes);
  ASSERT_EQ(starts.size(), std::size_t(kTicks + 2));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    write(std::span(bytes).first(size));
    const Reading reading = readAll();
    if (size < starts[1]) {
      ASSERT_FALSE(reading.error.empty()) << size << ": no whole pack";
      continue;
    }
    const auto whole = std::ranges::upper_bound(starts, size) - starts.begin() - 2;
    ASSERT_EQ(reading.error, "") << size;
    ASSERT_EQ(reading.ticks, whole) << size;
    ASSERT_EQ(reading.truncated, !std::ranges::binary_search(starts, size)) << size;
  }
}

TEST_F(Session, ADamagedByteIsLocated) {
  record();
  const Bytes bytes = read();
  const auto starts = recordStarts(bytes);
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    if (at > starts[1] && at < starts[kTicks - 1] && at % 7 != 0) continue;  // the records are all alike
    Bytes damaged = bytes;
    damaged[at] ^= std::uint8_t(1 << at % 8);
    write(damaged);
    const Reading reading = readAll();
    const auto record = std::ranges::upper_bound(starts, at) - starts.begin() - 1;
    if (at < starts[1]) {
      ASSERT_FALSE(reading.error.empty()) << "byte " << at;
      continue;
    }
    // What comes before the damage is read; a size that reaches past the end looks like a file cut off there.
    ASSERT_EQ(reading.ticks, record - 1) << "byte " << at;
    if (reading.error.empty()) {
      ASSERT_TRUE(reading.truncated && at < starts[std::size_t(record)] + 4) << "byte " << at;
    } else {
      ASSERT_NE(reading.error.find("byte " + std::to_string(starts[std::size_t(record)]) + ":"), std::string::npos)
          << reading.error;
    }
  }
}

TEST_F(Session, AMissingOrRepeatedTickIsReported) {
  record();
  const Bytes bytes = read();
  const auto starts = recordStarts(bytes);
  Bytes missing = bytes;
  missing.erase(missing.begin() + std::ptrdiff_t(starts[3]), missing.begin() + std::ptrdiff_t(starts[4]));
  write(missing);
  EXPECT_NE(readAll().error.find("tick 4 follows tick 2"), std::string::npos) << readAll().error;
  Bytes repeated = bytes;
  repeated.insert(repeated.begin() + std::ptrdiff_t(starts[4]), bytes.begin() + std::ptrdiff_t(starts[3]),
                  bytes.begin() + std::ptrdiff_t(starts[4]));
  write(repeated);
  EXPECT_NE(readAll().error.find("tick 3 follows tick 3"), std::string::npos) << readAll().error;
}

TEST_F(Session, WhatIsNoSessionFileIsNamed) {
  EXPECT_NE(readAll().error.find("cannot be opened"), std::string::npos);
  write(Bytes(100, 0));
  EXPECT_NE(readAll().error.find("not a Spoor session"), std::string::npos);
  record();
  Bytes bytes = read();
  bytes[4] = 9;
  write(bytes);
  EXPECT_NE(readAll().error.find("format 9"), std::string::npos);
}

TEST_F(Session, ASizeThatLiesCostsNothing) {
  record();
  Bytes bytes = read();
  bytes[11] = 0xff;  // the pack record claims 4 GB
  write(bytes);
  EXPECT_NE(readAll().error.find("over the limit"), std::string::npos) << readAll().error;
}

TEST_F(Session, AFileThatCannotBeWrittenIsAnError) {
  EXPECT_FALSE(SessionWriter::create("/nonexistent/spoor.sprs", encodePack(world_.pack)));
  if (std::filesystem::exists("/dev/full")) {
    auto writer = SessionWriter::create("/dev/full", encodePack(world_.pack));
    EXPECT_FALSE(writer);
  }
}

}  // namespace
}  // namespace spoor::test
