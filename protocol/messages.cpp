#include "protocol/messages.h"

#include <flatbuffers/flatbuffers.h>

#include <algorithm>
#include <type_traits>

#include "messages_generated.h"
#include "shared/base/assert.h"

namespace spoor {
namespace {

using flatbuffers::FlatBufferBuilder;

static_assert(std::variant_size_v<Message> == kMessageKindCount);
template <MessageKind kind, typename T>
inline constexpr bool kHoldsAt = std::is_same_v<std::variant_alternative_t<std::size_t(kind), Message>, T>;
static_assert(kHoldsAt<MessageKind::hello, Hello> && kHoldsAt<MessageKind::welcome, Welcome> &&
              kHoldsAt<MessageKind::pack_request, PackRequest> &&
              kHoldsAt<MessageKind::snapshot_request, SnapshotRequest> &&
              kHoldsAt<MessageKind::bulk_chunk, BulkChunk> && kHoldsAt<MessageKind::tick_update, TickUpdate> &&
              kHoldsAt<MessageKind::confirm, Confirm> && kHoldsAt<MessageKind::goodbye, Goodbye> &&
              kHoldsAt<MessageKind::refused, Refused> && kHoldsAt<MessageKind::crater_request, CraterRequest> &&
              kHoldsAt<MessageKind::crater_reply, CraterReply>);

// Tables are flat: far below the verifier's own defaults of 64 and a million.
constexpr flatbuffers::uoffset_t kDepthLimit = 8;
constexpr flatbuffers::uoffset_t kTablesLimit = 64;

Error invalid(MessageKind kind, const std::string& what) { return Error{std::string(toText(kind)) + ": " + what}; }

// ---- from plain structs to tables

struct Builder {
  FlatBufferBuilder& out;

  void operator()(const Hello& message) {
    SPOOR_ASSERT(!message.name.empty());
    out.Finish(
        wire::CreateHello(out, message.protocol_version, out.CreateString(printableText(message.name, kNameLimit))));
  }
  void operator()(const Welcome& message) {
    out.Finish(wire::CreateWelcome(out, message.protocol_version, message.pack_id.low, message.pack_id.high,
                                   message.server_tick, message.pack_bytes, message.ticks_per_second));
  }
  void operator()(const PackRequest&) { out.Finish(wire::CreatePackRequest(out)); }
  void operator()(const SnapshotRequest& message) {
    out.Finish(wire::CreateSnapshotRequest(out, std::uint8_t(message.cause)));
  }
  void operator()(const BulkChunk& message) {
    SPOOR_ASSERT(!message.bytes.empty() && message.bytes.size() <= kBulkChunkBytes);
    const auto bytes = out.CreateVector(message.bytes);
    out.Finish(wire::CreateBulkChunk(out, std::uint8_t(message.kind), message.compressed, message.raw_bytes,
                                     message.stored_bytes, message.offset, bytes));
  }
  void operator()(const TickUpdate& message) {
    std::vector<wire::Pose> poses;
    poses.reserve(message.poses.size());
    for (const Pose& pose : message.poses) {
      poses.emplace_back(pose.x_q, pose.y_q, pose.z_q, pose.yaw, pose.pitch, pose.roll, pose.spin, pose.scale_q16);
    }
    const auto pose_vector = out.CreateVectorOfStructs(poses);
    const auto tiles = out.CreateVector(message.tiles);
    flatbuffers::Offset<flatbuffers::Vector<std::uint8_t>> parameters;
    if (message.parameters) {
      ByteWriter writer;
      putParameters(writer, *message.parameters);
      parameters = out.CreateVector(writer.bytes);
    }
    flatbuffers::Offset<flatbuffers::Vector<std::uint8_t>> craters;
    if (!message.craters.empty()) {
      ByteWriter writer;
      for (const Crater& crater : message.craters) putCrater(writer, crater);
      craters = out.CreateVector(writer.bytes);
    }
    flatbuffers::Offset<flatbuffers::Vector<std::uint8_t>> snowfalls;
    if (!message.snowfalls.empty()) {
      ByteWriter writer;
      for (const Snowfall& snowfall : message.snowfalls) putSnowfall(writer, snowfall);
      snowfalls = out.CreateVector(writer.bytes);
    }
    out.Finish(wire::CreateTickUpdate(out, message.tick, message.state_hash, pose_vector, tiles, parameters, craters,
                                      snowfalls));
  }
  void operator()(const Confirm& message) { out.Finish(wire::CreateConfirm(out, message.tick, message.state_hash)); }
  void operator()(const Goodbye& message) {
    out.Finish(
        wire::CreateGoodbye(out, out.CreateString(printableText(message.reason, kReasonLimit)), message.final_tick));
  }
  void operator()(const Refused& message) {
    out.Finish(wire::CreateRefused(out, message.protocol_version,
                                   out.CreateString(printableText(message.reason, kReasonLimit))));
  }
  void operator()(const CraterRequest& message) {
    const Crater& crater = message.wish.crater;
    out.Finish(wire::CreateCraterRequest(out, message.sequence, crater.x_q, crater.y_q, crater.inner_radius_q,
                                         crater.crest_radius_q, message.wish.balanced ? 0 : crater.rim_height_q,
                                         crater.depth_q, crater.noise_seed, crater.noise_q16, message.wish.balanced));
  }
  void operator()(const CraterReply& message) {
    out.Finish(wire::CreateCraterReply(out, message.sequence, message.accepted, message.tick, message.id,
                                       out.CreateString(printableText(message.reason, kReasonLimit))));
  }
};

// ---- from verified tables to plain structs, value by value

std::string_view textOf(const flatbuffers::String& text) { return {text.c_str(), text.size()}; }

Result<Message> convert(const wire::Hello& table) {
  const auto name = textOf(*table.name());
  if (name.empty() || name.size() > kNameLimit || !isPrintable(name)) {
    return invalid(MessageKind::hello, "the name must be 1 to 64 printable ASCII characters");
  }
  return Message(Hello{table.protocol_version(), std::string(name)});
}

Result<Message> convert(const wire::Welcome& table) {
  constexpr auto kind = MessageKind::welcome;
  if (table.server_tick() < 0) return invalid(kind, "negative tick");
  if (table.pack_bytes() == 0 || table.pack_bytes() > kPackBytesLimit) return invalid(kind, "pack size out of range");
  if (table.ticks_per_second() < 1) return invalid(kind, "ticks per second out of range");
  return Message(Welcome{table.protocol_version(), PackId{table.pack_id_low(), table.pack_id_high()},
                         table.server_tick(), table.pack_bytes(), table.ticks_per_second()});
}

Result<Message> convert(const wire::PackRequest&) { return Message(PackRequest{}); }

Result<Message> convert(const wire::SnapshotRequest& table) {
  if (table.cause() >= kSnapshotCauseCount) return invalid(MessageKind::snapshot_request, "unknown cause");
  return Message(SnapshotRequest{SnapshotCause(table.cause())});
}

Result<Message> convert(const wire::BulkChunk& table) {
  constexpr auto kind = MessageKind::bulk_chunk;
  if (table.kind() >= kBulkKindCount) return invalid(kind, "unknown bulk kind");
  const std::uint64_t limit = BulkKind(table.kind()) == BulkKind::pack ? kPackBytesLimit : kSnapshotBytesLimit;
  if (table.raw_bytes() == 0 || table.raw_bytes() > limit) return invalid(kind, "raw size out of range");
  if (table.stored_bytes() == 0 || table.stored_bytes() > limit) return invalid(kind, "stored size out of range");
  if (!table.compressed() && table.stored_bytes() != table.raw_bytes()) {
    return invalid(kind, "not compressed, but raw and stored size differ");
  }
  const std::size_t size = table.bytes()->size();
  if (size == 0 || size > kBulkChunkBytes) return invalid(kind, "piece size out of range");
  if (table.offset() > table.stored_bytes() || size > table.stored_bytes() - table.offset()) {
    return invalid(kind, "the piece lies outside the whole");
  }
  return Message(BulkChunk{BulkKind(table.kind()),
                           table.compressed(),
                           table.raw_bytes(),
                           table.stored_bytes(),
                           table.offset(),
                           {table.bytes()->begin(), table.bytes()->end()}});
}

Result<Message> convert(const wire::TickUpdate& table) {
  constexpr auto kind = MessageKind::tick_update;
  if (table.tick() < 1) return invalid(kind, "tick below 1");
  if (table.poses()->size() > kPosesLimit) return invalid(kind, "too many poses");
  TickUpdate update{table.tick(), table.state_hash(), {}, {table.tiles()->begin(), table.tiles()->end()}};
  if (const auto* bytes = table.parameters()) {
    ByteReader reader({bytes->data(), bytes->size()});
    update.parameters = getParameters(reader);
    if (reader.failed() || reader.left() > 0) return invalid(kind, "parameters of a wrong size");
    if (!validateParameters(*update.parameters)) return invalid(kind, "a parameter out of range");
  }
  if (const auto* bytes = table.craters()) {
    if (bytes->size() % kCraterBytes != 0 || bytes->size() > kTickCratersLimit * kCraterBytes)
      return invalid(kind, "craters of a wrong size");
    ByteReader reader({bytes->data(), bytes->size()});
    while (reader.left() > 0) update.craters.push_back(getCrater(reader));
  }
  if (const auto* bytes = table.snowfalls()) {
    if (bytes->size() % kSnowfallBytes != 0 || bytes->size() > kSnowfallsLimit * kSnowfallBytes)
      return invalid(kind, "snowfalls of a wrong size");
    ByteReader reader({bytes->data(), bytes->size()});
    while (reader.left() > 0) update.snowfalls.push_back(getSnowfall(reader));
  }
  update.poses.reserve(table.poses()->size());
  for (const wire::Pose* pose : *table.poses()) {
    update.poses.push_back({pose->x_q(), pose->y_q(), pose->z_q(), pose->yaw(), pose->pitch(), pose->roll(),
                            pose->spin(), pose->scale_q16()});
  }
  return Message(std::move(update));
}

Result<Message> convert(const wire::Confirm& table) {
  if (table.tick() < 0) return invalid(MessageKind::confirm, "negative tick");
  return Message(Confirm{table.tick(), table.state_hash()});
}

Result<Message> convert(const wire::Goodbye& table) {
  const auto reason = textOf(*table.reason());
  if (reason.size() > kReasonLimit || !isPrintable(reason)) return invalid(MessageKind::goodbye, "unprintable reason");
  if (table.final_tick() < 0) return invalid(MessageKind::goodbye, "negative tick");
  return Message(Goodbye{std::string(reason), table.final_tick()});
}

Result<Message> convert(const wire::Refused& table) {
  const auto reason = textOf(*table.reason());
  if (reason.size() > kReasonLimit || !isPrintable(reason)) return invalid(MessageKind::refused, "unprintable reason");
  return Message(Refused{table.protocol_version(), std::string(reason)});
}

/// Any values: what a scene does not admit is refused with a reply.
Result<Message> convert(const wire::CraterRequest& table) {
  if (table.balanced() && table.rim_height_q() != 0)
    return invalid(MessageKind::crater_request, "a rim height beside balanced");
  CraterRequest request{table.sequence(), {}};
  request.wish.balanced = table.balanced();
  Crater& crater = request.wish.crater;
  crater.x_q = table.x_q();
  crater.y_q = table.y_q();
  crater.inner_radius_q = table.inner_radius_q();
  crater.crest_radius_q = table.crest_radius_q();
  crater.rim_height_q = table.rim_height_q();
  crater.depth_q = table.depth_q();
  crater.noise_seed = table.noise_seed();
  crater.noise_q16 = table.noise_q16();
  return Message(request);
}

Result<Message> convert(const wire::CraterReply& table) {
  constexpr auto kind = MessageKind::crater_reply;
  const auto reason = textOf(*table.reason());
  if (reason.size() > kReasonLimit || !isPrintable(reason)) return invalid(kind, "unprintable reason");
  if (table.tick() < 0 || table.accepted() != (table.tick() > 0)) return invalid(kind, "a tick that does not fit");
  if (!table.accepted() && table.id() != 0) return invalid(kind, "refused, and an id");
  return Message(CraterReply{table.sequence(), table.accepted(), table.tick(), table.id(), std::string(reason)});
}

template <typename Table>
Result<Message> verifyAndConvert(const Frame& frame) {
  flatbuffers::Verifier verifier(frame.payload.data(), frame.payload.size(), kDepthLimit, kTablesLimit);
  if (frame.payload.size() < sizeof(flatbuffers::uoffset_t) || !verifier.VerifyBuffer<Table>()) {
    return invalid(frame.kind, "broken table");
  }
  return convert(*flatbuffers::GetRoot<Table>(frame.payload.data()));
}

}  // namespace

Result<std::vector<std::uint8_t>> encodeMessage(const Message& message) {
  FlatBufferBuilder out;
  std::visit(Builder{out}, message);
  return encodeFrame(kindOf(message), {out.GetBufferPointer(), out.GetSize()});
}

Result<Message> decodeMessage(std::span<const std::uint8_t> bytes, Sender from) {
  const auto frame = decodeFrame(bytes, from);
  if (!frame) return Error{frame.error()};
  switch (frame->kind) {
    case MessageKind::hello:
      return verifyAndConvert<wire::Hello>(*frame);
    case MessageKind::welcome:
      return verifyAndConvert<wire::Welcome>(*frame);
    case MessageKind::pack_request:
      return verifyAndConvert<wire::PackRequest>(*frame);
    case MessageKind::snapshot_request:
      return verifyAndConvert<wire::SnapshotRequest>(*frame);
    case MessageKind::bulk_chunk:
      return verifyAndConvert<wire::BulkChunk>(*frame);
    case MessageKind::tick_update:
      return verifyAndConvert<wire::TickUpdate>(*frame);
    case MessageKind::confirm:
      return verifyAndConvert<wire::Confirm>(*frame);
    case MessageKind::goodbye:
      return verifyAndConvert<wire::Goodbye>(*frame);
    case MessageKind::refused:
      return verifyAndConvert<wire::Refused>(*frame);
    case MessageKind::crater_request:
      return verifyAndConvert<wire::CraterRequest>(*frame);
    case MessageKind::crater_reply:
      return verifyAndConvert<wire::CraterReply>(*frame);
  }
  return Error{"frame: unknown kind"};
}

const char* toText(SnapshotCause cause) {
  switch (cause) {
    case SnapshotCause::join:
      return "joining";
    case SnapshotCause::tile_mismatch:
      return "a tick that cannot be applied";
    case SnapshotCause::hash_mismatch:
      return "another state hash";
    case SnapshotCause::missing_tick:
      return "a missing tick";
  }
  return "an unknown cause";
}

std::string printableText(std::string_view text, std::size_t limit) {
  std::string result(text.substr(0, limit));
  std::replace_if(
      result.begin(), result.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return result;
}

bool isPrintable(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return c >= ' ' && c <= '~'; });
}

}  // namespace spoor
