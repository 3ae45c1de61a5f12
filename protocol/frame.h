#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "shared/base/result.h"

namespace spoor {

/// Which table a frame carries. The numbers are the wire's.
enum class MessageKind : std::uint8_t {
  hello = 0,
  welcome = 1,
  pack_request = 2,
  snapshot_request = 3,
  bulk_chunk = 4,
  tick_update = 5,
  confirm = 6,
  goodbye = 7,
  refused = 8,
  crater_request = 9,
  crater_reply = 10,
};
inline constexpr std::uint8_t kMessageKindCount = 11;
const char* toText(MessageKind kind);

enum class Sender : std::uint8_t { client, server };

/// What a kind of message may be.
struct KindRule {
  Sender from;
  bool may_compress;
  std::size_t stored_limit_bytes;  // payload as sent
  std::size_t raw_limit_bytes;     // payload decompressed
};
const KindRule& ruleOf(MessageKind kind);

inline constexpr std::uint8_t kFrameMagic[2] = {'S', 'p'};
inline constexpr std::uint8_t kFrameVersion = 1;
inline constexpr std::uint16_t kFrameCompressed = 1;  // flag: the payload is one zstd frame
inline constexpr std::size_t kFrameHeaderBytes = 10;
inline constexpr std::size_t kFrameLimitBytes = kFrameHeaderBytes + (std::size_t(8) << 20);

/// A decoded frame: the payload decompressed, in memory aligned for any scalar.
struct Frame {
  MessageKind kind = MessageKind::hello;
  std::vector<std::uint8_t> payload;
};

/// Header and payload, compressed where the kind allows it and it helps. Errors: over the kind's limits.
Result<std::vector<std::uint8_t>> encodeFrame(MessageKind kind, std::span<const std::uint8_t> payload);

/// Safe on untrusted bytes. A frame ends where its bytes end: anything missing or trailing is an error.
Result<Frame> decodeFrame(std::span<const std::uint8_t> bytes, Sender from);

}  // namespace spoor
