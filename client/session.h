#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "shared/base/result.h"
#include "shared/codec/tile_codec.h"
#include "shared/world/crater_text.h"

namespace spoor {

struct ConnectOptions {
  std::string host;
  std::uint16_t port = 0;
  std::string name = "viewer";
  double timeout_s = 10.0;  // until the server answers, and of silence afterwards
};

/// What became of a crater that was asked for.
struct CraterOutcome {
  std::uint32_t sequence = 0;
  std::int32_t tick = 0;  // with which it came; 0: refused
  std::uint32_t id = 0;   // of its record
  std::string reason;     // why refused; printable
};

/// A client's side of a session: it joins, fetches the pack and a snapshot, follows the ticks, checks every tile and
/// every state hash, and confirms each tick. One thread; nothing happens outside update().
class ClientSession {
 public:
  /// Resolves the host and opens a socket. Errors: an unknown host.
  static Result<std::unique_ptr<ClientSession>> start(const ConnectOptions& options);
  virtual ~ClientSession() = default;

  /// Serves the connection for at most `wait_ms`. Errors end the session: nobody answers, another version, the server
  /// went away without a goodbye, hostile bytes. A tile or hash mismatch is reported, counted and healed by asking for
  /// a new snapshot.
  [[nodiscard]] virtual Status update(int wait_ms) = 0;

  /// True once a snapshot has been applied; pack(), base() and state() are valid from then on.
  virtual bool inSync() const = 0;
  /// True once the server said goodbye and everything up to its last tick has been applied and confirmed.
  virtual bool ended() const = 0;

  virtual const ScenePack& pack() const = 0;
  virtual const BaseTerrain& base() const = 0;
  virtual const WorldState& state() const = 0;
  /// Snapshots asked for again because a tile or a hash differed.
  virtual int mismatchCount() const = 0;
  /// Tiles changed since the last call, each once. After a snapshot: every live tile, and those that were live before
  /// it (after a mismatch one of these may be dormant again).
  virtual std::vector<TileCoordinate> takeChangedTiles() = 0;

  /// Asks the server for a crater; only where inSync(). Returns the number of the request, from 1 on. Whatever the
  /// server does not admit it refuses, with a reason; a request on which the session ends may stay without an outcome.
  virtual std::uint32_t requestCrater(const CraterWish& wish) = 0;
  /// Outcomes since the last call. The crater itself comes with its tick, like everybody's.
  virtual std::vector<CraterOutcome> takeCraterOutcomes() = 0;
};

}  // namespace spoor
