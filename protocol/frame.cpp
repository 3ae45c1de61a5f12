#include "protocol/frame.h"

#include <array>
#include <string>

#include "protocol/zstd_codec.h"
#include "shared/base/assert.h"
#include "shared/base/bytes.h"

namespace spoor {
namespace {

constexpr std::size_t kKiB = 1024;
constexpr std::size_t kMiB = 1024 * kKiB;
constexpr std::size_t kCompressFromBytes = 128;  // below, zstd's own header eats what it saves

struct NamedRule {
  const char* name;
  KindRule rule;
};

constexpr std::array<NamedRule, kMessageKindCount> kRules = {{
    {"hello", {Sender::client, false, kKiB, kKiB}},
    {"welcome", {Sender::server, false, kKiB, kKiB}},
    {"pack request", {Sender::client, false, 256, 256}},
    {"snapshot request", {Sender::client, false, 256, 256}},
    {"bulk chunk", {Sender::server, false, 40 * kKiB, 40 * kKiB}},
    {"tick update", {Sender::server, true, 8 * kMiB, 64 * kMiB}},
    {"confirm", {Sender::client, false, 256, 256}},
    {"goodbye", {Sender::server, false, kKiB, kKiB}},
    {"refused", {Sender::server, false, kKiB, kKiB}},
    {"crater request", {Sender::client, false, 256, 256}},
    {"crater reply", {Sender::server, false, kKiB, kKiB}},
}};

std::string overLimit(MessageKind kind, const char* what, std::size_t size, std::size_t limit) {
  return std::string(toText(kind)) + ": " + std::to_string(size) + " bytes " + what + ", at most " +
         std::to_string(limit) + " are allowed";
}

}  // namespace

const char* toText(MessageKind kind) { return kRules.at(std::size_t(kind)).name; }

const KindRule& ruleOf(MessageKind kind) { return kRules.at(std::size_t(kind)).rule; }

Result<std::vector<std::uint8_t>> encodeFrame(MessageKind kind, std::span<const std::uint8_t> payload) {
  const KindRule& rule = ruleOf(kind);
  if (payload.size() > rule.raw_limit_bytes) {
    return Error{overLimit(kind, "raw", payload.size(), rule.raw_limit_bytes)};
  }
  std::vector<std::uint8_t> compressed;
  if (rule.may_compress && payload.size() >= kCompressFromBytes) compressed = zstdCompress(payload);
  const bool helps = !compressed.empty() && compressed.size() < payload.size();
  const std::span<const std::uint8_t> stored = helps ? std::span<const std::uint8_t>(compressed) : payload;
  if (stored.size() > rule.stored_limit_bytes) {
    return Error{overLimit(kind, "to send", stored.size(), rule.stored_limit_bytes)};
  }
  ByteWriter writer;
  writer.bytes.reserve(kFrameHeaderBytes + stored.size());
  writer.putBytes(kFrameMagic);
  writer.put(kFrameVersion);
  writer.put(std::uint8_t(kind));
  writer.put(helps ? kFrameCompressed : std::uint16_t(0));
  writer.put(std::uint32_t(payload.size()));
  writer.putBytes(stored);
  return std::move(writer.bytes);
}

Result<Frame> decodeFrame(std::span<const std::uint8_t> bytes, Sender from) {
  if (bytes.size() < kFrameHeaderBytes) return Error{"frame: cut off within the header"};
  ByteReader reader(bytes);
  const auto magic = reader.getBytes(sizeof kFrameMagic);
  if (magic[0] != kFrameMagic[0] || magic[1] != kFrameMagic[1]) return Error{"frame: wrong magic"};
  const auto version = reader.get<std::uint8_t>();
  if (version != kFrameVersion) {
    return Error{"frame: version " + std::to_string(version) + ", this is " + std::to_string(kFrameVersion)};
  }
  const auto kind_number = reader.get<std::uint8_t>();
  if (kind_number >= kMessageKindCount) return Error{"frame: unknown kind " + std::to_string(kind_number)};
  const auto kind = MessageKind(kind_number);
  const KindRule& rule = ruleOf(kind);
  if (rule.from != from) return Error{std::string("frame: a ") + toText(kind) + " from the wrong side"};
  const auto flags = reader.get<std::uint16_t>();
  if ((flags & ~kFrameCompressed) != 0) return Error{"frame: unknown flags " + std::to_string(flags)};
  const bool compressed = (flags & kFrameCompressed) != 0;
  if (compressed && !rule.may_compress) return Error{std::string("frame: a compressed ") + toText(kind)};
  const std::size_t raw_bytes = reader.get<std::uint32_t>();
  if (raw_bytes > rule.raw_limit_bytes) return Error{overLimit(kind, "raw", raw_bytes, rule.raw_limit_bytes)};
  if (reader.left() > rule.stored_limit_bytes) {
    return Error{overLimit(kind, "sent", reader.left(), rule.stored_limit_bytes)};
  }
  const auto stored = reader.getBytes(reader.left());
  if (!compressed) {
    if (stored.size() != raw_bytes) {
      return Error{std::string(toText(kind)) + ": " + std::to_string(stored.size()) + " bytes, announced were " +
                   std::to_string(raw_bytes)};
    }
    return Frame{kind, {stored.begin(), stored.end()}};
  }
  auto raw = zstdDecompress(stored, raw_bytes);
  if (!raw) return Error{std::string(toText(kind)) + ": " + raw.error()};
  return Frame{kind, std::move(*raw)};
}

}  // namespace spoor
