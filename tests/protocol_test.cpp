// Frames, messages and bulk: what goes through comes out, and nothing else goes through.
#include <gtest/gtest.h>
#include <zstd.h>

#include <algorithm>
#include <random>

#include "protocol/bulk.h"
#include "protocol/messages.h"
#include "protocol/zstd_codec.h"
#include "shared/base/bytes.h"

namespace spoor {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes noise(std::size_t size, std::uint64_t seed = 1) {
  std::mt19937_64 random(seed);
  Bytes bytes(size);
  for (auto& byte : bytes) byte = std::uint8_t(random());
  return bytes;
}

TickUpdate sampleTick(std::size_t tile_bytes) {
  return {77,
          0x1234567890abcdefu,
          {{1, -2, 3, 4, 5, 6, 7, 1}, {-8, 9, -10, 11, 12, 13, 65535, 65536}},
          Bytes(tile_bytes, 9)};
}

/// No field has its default.
Parameters sampleParameters() {
  Parameters p;
  p.displacement = Displacement::spread;
  p.nearest = NearestSearch::jump_flooding_squared;
  p.metric = Metric::chebyshev;
  p.slopes = SlopeRule::scatter;
  p.drift_weights = DriftWeights::displacement;
  p.active_areas = 0;
  p.displace_iterations = 11;
  p.sweeps_per_tick = 12;
  p.drift_step_q16 = 13;
  p.materials = {{kNeverSteep, 31, 32, 33, 34, 35, 36, 37}, {41, 42, 43, 44, 45, 46, 47, 48}};
  p.obstacle_threshold_q = 18;
  p.penetration_divider_q = 19;
  p.spread_cells = 20;
  p.capacity_rounds = 5;
  p.active_margin_cells = 22;
  p.frustum_height_q = 23;
  return p;
}

/// A tick that changes parameters, too small to be compressed.
TickUpdate steeredTick() {
  TickUpdate tick = sampleTick(1);
  tick.poses.clear();
  tick.parameters = sampleParameters();
  return tick;
}

/// No field has its default.
CraterWish sampleWish() {
  CraterWish wish;
  wish.crater.x_q = INT32_MIN;
  wish.crater.y_q = INT32_MAX;
  wish.crater.inner_radius_q = -3;
  wish.crater.crest_radius_q = 4;
  wish.crater.rim_height_q = 5;
  wish.crater.depth_q = 6;
  wish.crater.noise_seed = 65535;
  wish.crater.noise_q16 = 8;
  return wish;
}

std::vector<Message> samples() {
  return {Hello{kProtocolVersion, "viewer 1"},
          Welcome{kProtocolVersion, {~std::uint64_t(0), 2}, 12, 3456, 60},
          PackRequest{},
          SnapshotRequest{SnapshotCause::hash_mismatch},
          BulkChunk{BulkKind::snapshot, true, 100, 50, 10, noise(40)},
          sampleTick(4000),
          Confirm{5, 0xfedcba9876543210u},
          Goodbye{"over", 600},
          Refused{2, "no"},
          CraterRequest{9, sampleWish()},
          CraterReply{9, true, 77, 12, ""}};
}

Sender senderOf(const Message& message) { return ruleOf(kindOf(message)).from; }

bool equal(const Message& a, const Message& b) {
  if (a.index() != b.index()) return false;
  return std::visit(
      [&]<typename T>(const T& first) {
        const T& second = std::get<T>(b);
        if constexpr (std::is_same_v<T, TickUpdate>) {
          return first.tick == second.tick && first.state_hash == second.state_hash && first.poses == second.poses &&
                 first.tiles == second.tiles && first.parameters == second.parameters &&
                 first.craters == second.craters && first.snowfalls == second.snowfalls;
        } else {
          return first == second;
        }
      },
      a);
}

/// A frame with any header: `size_stated` and flags need not be true.
Bytes rawFrame(MessageKind kind, std::uint16_t flags, std::uint32_t size_stated, const Bytes& payload) {
  Bytes frame{'S', 'p', kFrameVersion, std::uint8_t(kind), std::uint8_t(flags), std::uint8_t(flags >> 8)};
  for (int byte = 0; byte < 4; ++byte) frame.push_back(std::uint8_t(size_stated >> (8 * byte)));
  frame.insert(frame.end(), payload.begin(), payload.end());
  return frame;
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(Messages, EveryKindGoesRoundTrip) {
  ASSERT_EQ(samples().size(), std::size_t(kMessageKindCount));
  for (const Message& message : samples()) {
    const auto frame = encodeMessage(message);
    ASSERT_TRUE(frame);
    const auto decoded = decodeMessage(*frame, senderOf(message));
    ASSERT_TRUE(decoded) << decoded.error();
    EXPECT_TRUE(equal(message, *decoded)) << toText(kindOf(message));
    const auto again = encodeMessage(*decoded);
    ASSERT_TRUE(again);
    EXPECT_EQ(*frame, *again) << toText(kindOf(message));
  }
}

TEST(Messages, DecodeRejectsEveryTruncation) {
  for (const Message& message : samples()) {
    const auto frame = encodeMessage(message);
    ASSERT_TRUE(frame);
    for (std::size_t size = 0; size < frame->size(); ++size) {
      EXPECT_FALSE(decodeMessage(std::span(*frame).first(size), senderOf(message))) << toText(kindOf(message)) << size;
    }
  }
}

TEST(Messages, DecodeRejectsATrailingByte) {
  for (const Message& message : samples()) {
    auto frame = encodeMessage(message);
    ASSERT_TRUE(frame);
    frame->push_back(0);
    EXPECT_FALSE(decodeMessage(*frame, senderOf(message))) << toText(kindOf(message));
  }
}

TEST(Messages, DecodeRejectsTheWrongSide) {
  for (const Message& message : samples()) {
    const auto frame = encodeMessage(message);
    ASSERT_TRUE(frame);
    const Sender other = senderOf(message) == Sender::client ? Sender::server : Sender::client;
    EXPECT_FALSE(decodeMessage(*frame, other)) << toText(kindOf(message));
  }
}

TEST(Messages, ValuesOutOfRangeAreRejected) {
  const std::vector<Message> wrong = {
      Welcome{1, {}, -1, 10, 60},
      Welcome{1, {}, 0, 0, 60},
      Welcome{1, {}, 0, kPackBytesLimit + 1, 60},
      Welcome{1, {}, 0, 10, 0},
      SnapshotRequest{SnapshotCause(9)},
      BulkChunk{BulkKind(7), true, 100, 50, 0, Bytes(10)},
      BulkChunk{BulkKind::pack, true, kPackBytesLimit + 1, 50, 0, Bytes(10)},
      BulkChunk{BulkKind::pack, false, 100, 50, 0, Bytes(10)},
      BulkChunk{BulkKind::pack, false, 50, 50, 41, Bytes(10)},
      BulkChunk{BulkKind::pack, false, 50, 50, ~std::uint64_t(0), Bytes(10)},
      TickUpdate{0, 0, {}, {}},
      Confirm{-1, 0},
      Goodbye{"over", -1},
      CraterReply{1, true, 0, 0, ""},
      CraterReply{1, false, 5, 0, "no"},
      CraterReply{1, true, -5, 0, ""},
      CraterReply{1, false, 0, 3, "no"},
  };
  for (const Message& message : wrong) {
    const auto frame = encodeMessage(message);
    ASSERT_TRUE(frame);
    EXPECT_FALSE(decodeMessage(*frame, senderOf(message))) << toText(kindOf(message));
  }
}

TEST(Parameters, GoRoundTripInATickUpdate) {
  const auto frame = encodeMessage(steeredTick());
  ASSERT_TRUE(frame);
  const auto decoded = decodeMessage(*frame, Sender::server);
  ASSERT_TRUE(decoded) << decoded.error();
  EXPECT_TRUE(equal(steeredTick(), *decoded));
  EXPECT_EQ(std::get<TickUpdate>(*decoded).parameters, sampleParameters());
  for (std::size_t size = 0; size < frame->size(); ++size)
    EXPECT_FALSE(decodeMessage(std::span(*frame).first(size), Sender::server)) << size;
}

TEST(Parameters, AreOfTheOrderAndSizeThatTheProtocolStates) {
  ByteWriter writer;
  putParameters(writer, sampleParameters());
  ByteWriter expected;
  for (const int byte : {2, 5, 2, 3, 1, 0}) expected.put(std::uint8_t(byte));
  for (const std::int32_t number : {11, 12, 13, 18, 19, 20, 5, 22, 23}) expected.put(number);
  expected.put(std::uint8_t(2));
  for (const std::int32_t number : {kNeverSteep, 31, 32, 33, 34, 35, 36, 37, 41, 42, 43, 44, 45, 46, 47, 48})
    expected.put(number);
  EXPECT_EQ(writer.bytes, expected.bytes);
  EXPECT_EQ(writer.bytes.size(), 43u + 2 * 32u);
  EXPECT_EQ(writer.bytes.size(), parametersBytes(2));
}

TEST(Parameters, OutOfRangeAreRejected) {
  void (*const spoil[])(Parameters&) = {
      [](Parameters& p) { p.displacement = Displacement(4); },
      [](Parameters& p) { p.nearest = NearestSearch(6); },
      [](Parameters& p) { p.metric = Metric(3); },
      [](Parameters& p) { p.slopes = SlopeRule(5); },
      [](Parameters& p) { p.drift_weights = DriftWeights(3); },
      [](Parameters& p) { p.drift_step_q16 = 0; },
      [](Parameters& p) { p.drift_step_q16 = kDriftStepLimit + 1; },
      [](Parameters& p) {
        p.slopes = SlopeRule::drift;
        p.drift_step_q16 = kDriftStepLimit;
        p.sweeps_per_tick = 1000;
      },
      [](Parameters& p) { p.materials[1].diffusion_q16 = kDiffusionLimit + 1; },
      [](Parameters& p) { p.materials[1].friction_inverse_q32 = -1; },
      [](Parameters& p) { p.materials[1].repose_q16 = kReposeLimit + 1; },
      [](Parameters& p) { p.active_areas = 2; },
      [](Parameters& p) { p.displace_iterations = 1001; },
      [](Parameters& p) { p.sweeps_per_tick = -1; },
      [](Parameters& p) { p.materials[0].compression_q16 = 65537; },
      [](Parameters& p) { p.materials[0].compaction_limit_q16 = -1; },
      [](Parameters& p) { p.materials[0].roughness_q16 = 65537; },
      [](Parameters& p) { p.materials[0].slope_threshold_q = kNeverSteep - 1; },
      [](Parameters& p) { p.materials[0].diagonal_threshold_q = -1; },
      [](Parameters& p) { p.obstacle_threshold_q = INT32_MAX; },
      [](Parameters& p) { p.penetration_divider_q = 0; },
      [](Parameters& p) { p.spread_cells = 65; },
      [](Parameters& p) { p.capacity_rounds = 0; },
      [](Parameters& p) { p.active_margin_cells = 4097; },
      [](Parameters& p) { p.frustum_height_q = INT32_MIN; },
  };
  for (std::size_t i = 0; i < std::size(spoil); ++i) {
    TickUpdate tick = steeredTick();
    spoil[i](*tick.parameters);
    const auto frame = encodeMessage(tick);
    ASSERT_TRUE(frame);
    const auto decoded = decodeMessage(*frame, Sender::server);
    ASSERT_FALSE(decoded) << i;
    EXPECT_TRUE(contains(decoded.error(), "parameter out of range")) << decoded.error();
  }
}

TEST(Parameters, OfAWrongSizeAreRejected) {
  auto frame = encodeMessage(steeredTick());
  ASSERT_TRUE(frame);
  auto raw = decodeFrame(*frame, Sender::server);
  ASSERT_TRUE(raw) << raw.error();
  ByteWriter writer;
  putParameters(writer, sampleParameters());
  const auto at = std::search(raw->payload.begin(), raw->payload.end(), writer.bytes.begin(), writer.bytes.end());
  ASSERT_NE(at, raw->payload.end());
  std::uint8_t& length = *(at - 4);  // of the vector, its lowest byte
  ASSERT_EQ(length, parametersBytes(2));
  for (const int wrong : {0, 1, int(parametersBytes(2)) - 1, int(parametersBytes(2)) + 1, 255}) {
    length = std::uint8_t(wrong);
    const auto decoded = decodeMessage(
        rawFrame(MessageKind::tick_update, 0, std::uint32_t(raw->payload.size()), raw->payload), Sender::server);
    ASSERT_FALSE(decoded) << wrong;
    // What reaches past the table's end is the verifier's.
    const bool fits = wrong < int(parametersBytes(2));
    EXPECT_TRUE(contains(decoded.error(), "parameters of a wrong size") ||
                (!fits && contains(decoded.error(), "broken table")))
        << decoded.error();
  }
}

/// A tick with which two snowfalls come. No field has its default.
TickUpdate snowyTick() {
  TickUpdate tick = sampleTick(1);
  tick.poses.clear();
  tick.snowfalls = {{{-1, 2, INT32_MAX, 4}, INT64_MIN, 6, 7, 0xfffffffeu}, {{8, 9, 10, 11}, 12, 13, 14, 15}};
  return tick;
}

TEST(Snowfalls, GoRoundTripInATickUpdateWithAnyValues) {
  const auto frame = encodeMessage(snowyTick());
  ASSERT_TRUE(frame);
  const auto decoded = decodeMessage(*frame, Sender::server);
  ASSERT_TRUE(decoded) << decoded.error();
  EXPECT_TRUE(equal(snowyTick(), *decoded));
  for (std::size_t size = 0; size < frame->size(); ++size)
    EXPECT_FALSE(decodeMessage(std::span(*frame).first(size), Sender::server)) << size;
}

TEST(Snowfalls, OfAWrongSizeOrTooManyAreRejected) {
  const auto frame = encodeMessage(snowyTick());
  ASSERT_TRUE(frame);
  auto raw = decodeFrame(*frame, Sender::server);
  ASSERT_TRUE(raw) << raw.error();
  ByteWriter writer;
  for (const Snowfall& snowfall : snowyTick().snowfalls) putSnowfall(writer, snowfall);
  ASSERT_EQ(writer.bytes.size(), 2 * kSnowfallBytes);
  const auto at = std::search(raw->payload.begin(), raw->payload.end(), writer.bytes.begin(), writer.bytes.end());
  ASSERT_NE(at, raw->payload.end());
  std::uint8_t& length = *(at - 4);  // of the vector, its lowest byte
  ASSERT_EQ(length, 2 * kSnowfallBytes);
  for (const int wrong : {1, int(kSnowfallBytes) - 1, int(kSnowfallBytes) + 1, 2 * int(kSnowfallBytes) - 1}) {
    length = std::uint8_t(wrong);
    const auto decoded = decodeMessage(
        rawFrame(MessageKind::tick_update, 0, std::uint32_t(raw->payload.size()), raw->payload), Sender::server);
    ASSERT_FALSE(decoded) << wrong;
    EXPECT_TRUE(contains(decoded.error(), "snowfalls of a wrong size")) << decoded.error();
  }
  TickUpdate many = snowyTick();
  many.snowfalls.resize(kSnowfallsLimit + 1);
  const auto too_many = encodeMessage(many);
  ASSERT_TRUE(too_many);
  const auto decoded = decodeMessage(*too_many, Sender::server);
  ASSERT_FALSE(decoded);
  EXPECT_TRUE(contains(decoded.error(), "snowfalls of a wrong size")) << decoded.error();
}

TEST(Craters, GoRoundTripInATickUpdate) {
  TickUpdate tick = sampleTick(1);
  for (std::uint32_t id = 0; id < 3; ++id) {
    tick.craters.push_back(sampleWish().crater);
    tick.craters.back().tick = 77;
    tick.craters.back().id = id;
  }
  const auto frame = encodeMessage(tick);
  ASSERT_TRUE(frame);
  const auto decoded = decodeMessage(*frame, Sender::server);
  ASSERT_TRUE(decoded) << decoded.error();
  EXPECT_EQ(std::get<TickUpdate>(*decoded).craters, tick.craters);
}

TEST(Craters, ARequestMayHoldAnyValue) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 200; ++i) {
    CraterRequest request{std::uint32_t(random()), {}};
    Crater& crater = request.wish.crater;
    for (std::int32_t* value : {&crater.x_q, &crater.y_q, &crater.inner_radius_q, &crater.crest_radius_q,
                                &crater.rim_height_q, &crater.depth_q})
      *value = i % 4 == 0 ? INT32_MIN : std::int32_t(random());
    request.wish.balanced = i % 2 != 0;
    if (request.wish.balanced) crater.rim_height_q = 0;
    const auto frame = encodeMessage(request);
    ASSERT_TRUE(frame);
    const auto decoded = decodeMessage(*frame, Sender::client);
    ASSERT_TRUE(decoded) << decoded.error();
    EXPECT_EQ(std::get<CraterRequest>(*decoded), request);
  }
}

TEST(Craters, ABalancedRimDoesNotTravel) {
  CraterRequest request{1, sampleWish()};
  request.wish.balanced = true;
  const auto decoded = decodeMessage(*encodeMessage(request), Sender::client);
  ASSERT_TRUE(decoded) << decoded.error();
  EXPECT_EQ(std::get<CraterRequest>(*decoded).wish.crater.rim_height_q, 0);
}

TEST(Messages, TextsAreCleanedOnTheWayOut) {
  const auto frame = encodeMessage(Hello{1, "line\nbreak" + std::string(100, 'x')});
  ASSERT_TRUE(frame);
  const auto decoded = decodeMessage(*frame, Sender::client);
  ASSERT_TRUE(decoded) << decoded.error();
  EXPECT_EQ(std::get<Hello>(*decoded).name.substr(0, 10), "line?break");
  EXPECT_EQ(std::get<Hello>(*decoded).name.size(), kNameLimit);
}

TEST(Messages, AnUnprintableNameIsRejected) {
  auto frame = encodeMessage(Hello{1, "viewer"});
  ASSERT_TRUE(frame);
  const auto at = std::search(frame->begin(), frame->end(), std::begin("viewer"), std::begin("viewer") + 6);
  ASSERT_NE(at, frame->end());
  *at = '\x1b';
  EXPECT_FALSE(decodeMessage(*frame, Sender::client));
}

TEST(Frame, DecodeRejectsABadHeader) {
  const auto good = encodeMessage(PackRequest{});
  ASSERT_TRUE(good);
  const auto with = [&](std::size_t at, std::uint8_t value) {
    Bytes frame = *good;
    frame[at] = value;
    return decodeMessage(frame, Sender::client);
  };
  EXPECT_TRUE(with(0, 'S'));
  EXPECT_FALSE(with(0, 'T'));
  EXPECT_FALSE(with(1, 'P'));
  EXPECT_TRUE(contains(with(2, 9).error(), "version 9, this is 1"));
  EXPECT_TRUE(contains(with(3, kMessageKindCount).error(), "unknown kind"));
  EXPECT_TRUE(contains(with(4, 2).error(), "unknown flags"));
  EXPECT_TRUE(contains(with(4, 1).error(), "a compressed pack request"));
}

TEST(Frame, SizesOverTheLimitAreRejectedBothWays) {
  for (std::uint8_t number = 0; number < kMessageKindCount; ++number) {
    const auto kind = MessageKind(number);
    const KindRule& rule = ruleOf(kind);
    const auto over_raw = std::uint32_t(rule.raw_limit_bytes + 1);
    EXPECT_FALSE(decodeFrame(rawFrame(kind, 0, over_raw, {}), rule.from)) << toText(kind);
    const auto over_stored = std::uint32_t(rule.stored_limit_bytes + 1);
    EXPECT_FALSE(decodeFrame(rawFrame(kind, 0, over_stored, Bytes(over_stored)), rule.from)) << toText(kind);
    EXPECT_FALSE(encodeFrame(kind, Bytes(over_raw))) << toText(kind);
  }
  const std::size_t stored_limit = ruleOf(MessageKind::tick_update).stored_limit_bytes;
  EXPECT_FALSE(encodeMessage(TickUpdate{1, 0, {}, noise(stored_limit)})) << "more than may be sent, even compressed";
}

TEST(Frame, TickUpdatesAreCompressedWhereItHelps) {
  const auto helped = encodeMessage(sampleTick(4000));
  ASSERT_TRUE(helped);
  EXPECT_LT(helped->size(), 200u);
  auto tick = sampleTick(0);
  tick.tiles = noise(4000);
  const auto plain = encodeMessage(tick);
  ASSERT_TRUE(plain);
  EXPECT_EQ((*plain)[4], 0);
}

TEST(Zstd, ABombIsNotUnpacked) {
  const Bytes zeros(std::size_t(200) << 20);
  const Bytes bomb = zstdCompress(zeros);
  ASSERT_LT(bomb.size(), std::size_t(64) << 10);
  const auto kind = MessageKind::tick_update;
  const auto honest = decodeFrame(rawFrame(kind, kFrameCompressed, std::uint32_t(zeros.size()), bomb), Sender::server);
  EXPECT_TRUE(contains(honest.error(), "are allowed")) << honest.error();
  const auto lying = decodeFrame(rawFrame(kind, kFrameCompressed, 1000, bomb), Sender::server);
  EXPECT_TRUE(contains(lying.error(), "announced were 1000")) << lying.error();
}

TEST(Zstd, AFrameThatStatesTooLittleIsRejected) {
  // Two frames, each honest; together more than announced. And one frame followed by a skippable one.
  const Bytes one = zstdCompress(Bytes(1000, 3));
  Bytes two = one;
  two.insert(two.end(), one.begin(), one.end());
  EXPECT_FALSE(zstdDecompress(two, 1000));
  EXPECT_FALSE(zstdDecompress(two, 2000));
  Bytes skippable = one;
  for (const int byte : {0x50, 0x2a, 0x4d, 0x18, 0, 0, 0, 0}) skippable.push_back(std::uint8_t(byte));
  EXPECT_FALSE(zstdDecompress(skippable, 1000));
  EXPECT_TRUE(zstdDecompress(one, 1000));
}

TEST(Zstd, AFrameWithoutContentSizeIsRejected) {
  const Bytes raw(1000, 3);
  ZSTD_CCtx* context = ZSTD_createCCtx();
  ZSTD_CCtx_setParameter(context, ZSTD_c_contentSizeFlag, 0);
  Bytes stored(ZSTD_compressBound(raw.size()));
  stored.resize(ZSTD_compress2(context, stored.data(), stored.size(), raw.data(), raw.size()));
  ZSTD_freeCCtx(context);
  EXPECT_TRUE(contains(zstdDecompress(stored, 1000).error(), "does not state"));
}

TEST(Zstd, EveryTruncationIsRejected) {
  const Bytes stored = zstdCompress(noise(300));
  for (std::size_t size = 0; size < stored.size(); ++size) {
    EXPECT_FALSE(zstdDecompress(std::span(stored).first(size), 300));
  }
}

TEST(Fuzz, RandomBytesAreNoMessage) {
  std::mt19937_64 random(20240607);
  for (int i = 0; i < 20000; ++i) {
    Bytes bytes = noise(random() % 200, random());
    if (bytes.size() > 3 && i % 2 == 0) {
      bytes[0] = 'S', bytes[1] = 'p', bytes[2] = kFrameVersion, bytes[3] %= kMessageKindCount;
    }
    EXPECT_FALSE(decodeMessage(bytes, i % 4 < 2 ? Sender::client : Sender::server));
  }
}

TEST(Fuzz, ChangedMessagesAreRejectedOrValid) {
  std::mt19937_64 random(99);
  auto messages = samples();
  messages.push_back(sampleTick(8));  // too small to be compressed: the changes reach the table
  messages.push_back(steeredTick());
  int valid = 0;
  for (const Message& message : messages) {
    const auto frame = encodeMessage(message);
    ASSERT_TRUE(frame);
    for (int i = 0; i < 3000; ++i) {
      Bytes changed = *frame;
      for (std::uint64_t count = 1 + random() % 4; count > 0; --count) {
        changed[random() % changed.size()] = std::uint8_t(random());
      }
      const auto decoded = decodeMessage(changed, senderOf(message));
      if (!decoded) continue;
      ++valid;
      EXPECT_TRUE(encodeMessage(*decoded));  // whatever passed holds only values that may be sent
    }
  }
  EXPECT_GT(valid, 0);
}

TEST(Bulk, PackagesGoRoundTripInChunks) {
  for (const Bytes& raw : {noise(200000), Bytes(200000, 4), Bytes(1, 4)}) {
    const BulkPackage package = makeBulkPackage(BulkKind::snapshot, raw);
    BulkAssembler assembler(BulkKind::snapshot);
    for (std::uint64_t offset = 0; offset < package.stored.size(); offset += kBulkChunkBytes) {
      EXPECT_FALSE(assembler.complete());
      ASSERT_TRUE(assembler.add(chunkAt(package, offset)));
    }
    ASSERT_TRUE(assembler.complete());
    const auto unpacked = assembler.unpack();
    ASSERT_TRUE(unpacked) << unpacked.error();
    EXPECT_EQ(*unpacked, raw);
  }
}

TEST(Bulk, ChunksThatDoNotFitAreRejected) {
  const BulkPackage package = makeBulkPackage(BulkKind::pack, noise(100000));
  const auto afterFirst = [&] {
    BulkAssembler assembler(BulkKind::pack);
    EXPECT_TRUE(assembler.add(chunkAt(package, 0)));
    return assembler;
  };
  EXPECT_FALSE(BulkAssembler(BulkKind::snapshot).add(chunkAt(package, 0))) << "of the wrong kind";
  EXPECT_FALSE(BulkAssembler(BulkKind::pack).add(chunkAt(package, kBulkChunkBytes))) << "not the first";
  EXPECT_FALSE(afterFirst().add(chunkAt(package, 0))) << "the first again";
  EXPECT_FALSE(afterFirst().add(chunkAt(package, 2 * kBulkChunkBytes))) << "one left out";
  BulkChunk other_size = chunkAt(package, kBulkChunkBytes);
  other_size.raw_bytes = ++other_size.stored_bytes;
  EXPECT_FALSE(afterFirst().add(other_size));
}

TEST(Bulk, AWholeThatUnpacksToAnotherSizeIsRejected) {
  BulkPackage package = makeBulkPackage(BulkKind::pack, Bytes(100000, 5));
  package.raw_bytes = 50000;
  BulkAssembler assembler(BulkKind::pack);
  ASSERT_TRUE(assembler.add(chunkAt(package, 0)));
  ASSERT_TRUE(assembler.complete());
  EXPECT_FALSE(assembler.unpack());
}

}  // namespace
}  // namespace spoor
