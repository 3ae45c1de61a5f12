#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace spoor {

/// Whoever is at the other end. Never used twice by one transport.
using PeerId = std::uint32_t;

/// Each channel keeps its own order; between channels there is none.
enum class Channel : std::uint8_t { control = 0, ticks = 1, bulk = 2 };
inline constexpr std::size_t kChannelCount = 3;

/// Said when a connection is closed on purpose. `none`: it was lost.
enum class CloseCode : std::uint32_t { none = 0, done = 1, refused = 2, too_slow = 3, left = 4 };

struct TransportEvent {
  enum class Kind : std::uint8_t { connected, disconnected, message };
  Kind kind = Kind::message;
  PeerId peer = 0;
  Channel channel = Channel::control;
  CloseCode code = CloseCode::none;  // of disconnected
  std::vector<std::uint8_t> bytes;   // of message
};

/// Carries messages, whole, once and in order per channel. Knows nothing of what they mean. One thread.
class Transport {
 public:
  virtual ~Transport() = default;

  /// Moves bytes, waiting up to `wait_ms` for the first event, and returns what happened. A peer's last event is
  /// `disconnected`, whoever closed the connection.
  virtual std::vector<TransportEvent> service(int wait_ms) = 0;

  /// Queues a message. To a peer that is gone: nothing happens.
  virtual void send(PeerId peer, Channel channel, std::span<const std::uint8_t> bytes) = 0;

  /// Bytes sent on a channel that the other end has not acknowledged yet.
  virtual std::size_t outstandingBytes(PeerId peer, Channel channel) const = 0;

  /// Time since the peer was last heard of, counted only while this end was listening. [ms]
  virtual std::int64_t silenceMs(PeerId peer) const = 0;

  /// Closes once everything queued has been delivered; messages still coming in are for the caller to ignore.
  virtual void closeAfterQueue(PeerId peer, CloseCode code) = 0;
  /// Closes now and forgets what is queued.
  virtual void close(PeerId peer, CloseCode code) = 0;

  /// Failures of the network layer so far that were ignored (an oversized datagram, for one).
  virtual int failureCount() const = 0;
};

}  // namespace spoor
