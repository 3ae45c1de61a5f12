#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "shared/base/result.h"
#include "shared/codec/tile_codec.h"

namespace spoor {

struct HostOptions {
  std::uint16_t port = 0;  // UDP; 0: one the system picks, see SessionHost::port
  int max_clients = 16;
};

/// A crater that a client asked for and may have, on its way to a tick.
struct CraterOrder {
  std::uint64_t client = 0;  // the how manieth to join
  std::uint32_t sequence = 0;
  Crater crater;
};

/// What became of an order.
struct CraterAnswer {
  std::uint64_t client = 0;
  std::uint32_t sequence = 0;
  std::int32_t tick = 0;  // with which it came; 0: it did not
  std::uint32_t id = 0;
  std::string reason = {};  // why not
};

/// What is known of a client, present or gone.
struct ClientReport {
  std::string name;
  bool in_sync = false;  // its last confirmation carried our hash, and it stayed connected until the end
  std::int32_t confirmed_tick = -1;
  std::uint64_t confirmed_hash = 0;  // the client's own state hash at that tick
  std::int32_t mismatches = 0;       // confirmations whose hash was not ours, and ticks it could not apply
  std::int32_t ticks_sent = 0;
  std::uint64_t tick_bytes_sent = 0;      // of tick updates, as sent (compressed, with frame headers)
  std::uint64_t snapshot_bytes_sent = 0;  // of packs and snapshots
  std::int32_t craters_asked = 0;
  std::int32_t craters_refused = 0;  // of these
  std::string left_because;          // empty while connected
};

/// Serves a session to clients on a thread of its own. That thread keeps a mirror of the state, fed by the published
/// ticks, and makes snapshots for joining clients from it: the tick loop never waits for a client.
class SessionHost {
 public:
  /// Opens the port and starts the thread. `pack` must outlive the host. Errors: the port is taken.
  static Result<std::unique_ptr<SessionHost>> open(const HostOptions& options, const ScenePack& pack,
                                                   std::vector<std::uint8_t> encoded_pack);
  virtual ~SessionHost() = default;

  virtual std::uint16_t port() const = 0;

  /// Hands a tick over; returns at once. Ticks must come in order, from 1 on.
  virtual void publish(TickUpdate update) = 0;

  /// Takes the craters that clients asked for since the last call, as they came; nothing where the host's
  /// thread is at work on them this very moment: then they come with the next call. Never waits for a client.
  virtual std::vector<CraterOrder> tryTakeCraters() = 0;
  /// Says what became of orders; returns at once. After the tick they came with has been published.
  virtual void answer(std::vector<CraterAnswer> answers) = 0;

  /// Clients connected now whose last confirmation (of a tick, or of their snapshot) carried our hash.
  virtual int clientsInSync() const = 0;

  /// Ends the session: every client is told the last tick, given up to `timeout_s` to confirm it, then let go.
  /// Reports all clients there ever were, in order of joining.
  virtual std::vector<ClientReport> finish(double timeout_s) = 0;
};

}  // namespace spoor
