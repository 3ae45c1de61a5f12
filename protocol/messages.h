#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "protocol/frame.h"
#include "shared/base/result.h"
#include "shared/codec/tile_codec.h"
#include "shared/world/crater_text.h"

namespace spoor {

/// Raised whenever a message, a layout inside one or the rule of the state hash changes.
inline constexpr std::uint32_t kProtocolVersion = 4;

inline constexpr std::size_t kNameLimit = 64;     // characters of a client's name, at least 1, printable ASCII
inline constexpr std::size_t kReasonLimit = 400;  // characters of a reason, printable ASCII
inline constexpr std::size_t kPosesLimit = 65536;
inline constexpr std::size_t kBulkChunkBytes = std::size_t(32) << 10;
inline constexpr std::uint64_t kSnapshotBytesLimit = std::uint64_t(1) << 30;

/// Client: the first message.
struct Hello {
  std::uint32_t protocol_version = kProtocolVersion;
  std::string name;
  bool operator==(const Hello&) const = default;
};

/// Server: the answer to a hello.
struct Welcome {
  std::uint32_t protocol_version = kProtocolVersion;
  PackId pack_id;
  std::int32_t server_tick = 0;
  std::uint64_t pack_bytes = 0;  // encoded, before compression
  std::int32_t ticks_per_second = 60;
  bool operator==(const Welcome&) const = default;
};

/// Client: send the pack.
struct PackRequest {
  bool operator==(const PackRequest&) const = default;
};

enum class SnapshotCause : std::uint8_t {
  join = 0,           // the first of a connection
  tile_mismatch = 1,  // a tick could not be applied; the state is still at the tick before
  hash_mismatch = 2,  // a tick was applied, but the state hash differs
  missing_tick = 3,   // a tick was left out
};
inline constexpr std::uint8_t kSnapshotCauseCount = 4;
const char* toText(SnapshotCause cause);

/// Client: send the whole state at a tick of the server's choice, and every tick after it.
struct SnapshotRequest {
  SnapshotCause cause = SnapshotCause::join;
  bool operator==(const SnapshotRequest&) const = default;
};

enum class BulkKind : std::uint8_t { pack = 0, snapshot = 1 };
inline constexpr std::uint8_t kBulkKindCount = 2;

/// Server: a piece of a pack or a snapshot. Pieces come in order, without gaps; the first has offset 0.
struct BulkChunk {
  BulkKind kind = BulkKind::pack;
  bool compressed = false;         // what is stored is one zstd frame
  std::uint64_t raw_bytes = 0;     // of the whole, decompressed
  std::uint64_t stored_bytes = 0;  // of the whole, as sent
  std::uint64_t offset = 0;        // of this piece in what is stored
  std::vector<std::uint8_t> bytes;
  bool operator==(const BulkChunk&) const = default;
};

/// Client: it holds this tick with this state hash.
struct Confirm {
  std::int32_t tick = 0;
  std::uint64_t state_hash = 0;
  bool operator==(const Confirm&) const = default;
};

/// Server: the session is over after this tick.
struct Goodbye {
  std::string reason;
  std::int32_t final_tick = 0;
  bool operator==(const Goodbye&) const = default;
};

/// Server: this client has to go.
struct Refused {
  std::uint32_t protocol_version = kProtocolVersion;
  std::string reason;
  bool operator==(const Refused&) const = default;
};

/// Client: let there be a crater. Its values are any: what cannot be is answered with a refusal.
struct CraterRequest {
  std::uint32_t sequence = 0;  // above that of the client's request before
  CraterWish wish;             // tick and id do not travel; nor does H4 where it is balanced
  bool operator==(const CraterRequest&) const = default;
};

/// Server: what became of a request; one for each, in any order.
struct CraterReply {
  std::uint32_t sequence = 0;
  bool accepted = false;
  std::int32_t tick = 0;  // with which it came, >= 1; 0 where refused
  std::uint32_t id = 0;   // of its record; 0 where refused
  std::string reason;     // why refused; empty where accepted
  bool operator==(const CraterReply&) const = default;
};

/// One alternative a MessageKind, in its order. Server to client also: TickUpdate (shared/codec/tile_codec.h).
using Message = std::variant<Hello, Welcome, PackRequest, SnapshotRequest, BulkChunk, TickUpdate, Confirm, Goodbye,
                             Refused, CraterRequest, CraterReply>;

inline MessageKind kindOf(const Message& message) { return MessageKind(message.index()); }

/// The frame of a message. Values must be valid (asserted); texts are cut and cleaned (printableText) first.
/// Errors: larger than its kind may be, possible for tick updates only.
Result<std::vector<std::uint8_t>> encodeMessage(const Message& message);

/// Safe on untrusted bytes: frame, table and every value are checked. `from` is who sent it; kinds of the other side
/// are refused before anything is decompressed.
Result<Message> decodeMessage(std::span<const std::uint8_t> frame, Sender from);

/// Printable ASCII only, other bytes as '?', at most `limit` characters.
std::string printableText(std::string_view text, std::size_t limit);
bool isPrintable(std::string_view text);

}  // namespace spoor
