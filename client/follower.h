#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "client/session.h"
#include "protocol/bulk.h"
#include "protocol/messages.h"
#include "protocol/transport.h"

namespace spoor {

struct FollowerOptions {
  std::string server_name;  // for messages: host:port
  std::string client_name;
  std::int64_t timeout_ms = 10000;  // until the server answers, and of silence afterwards
};

/// What a client does about each message of the server's (PROTOCOL.md, the client's states): fetches pack and snapshot,
/// applies the ticks, confirms them, and asks for a new snapshot where something differs. Knows neither sockets nor
/// clocks; ClientSession's contract is its own.
class Follower {
 public:
  /// `transport` must outlive this.
  Follower(Transport& transport, PeerId server, FollowerOptions options, std::int64_t now_ms);
  Follower(const Follower&) = delete;
  Follower& operator=(const Follower&) = delete;

  /// The end of the connection, once returned, is returned again.
  [[nodiscard]] Status update(std::int64_t now_ms, int wait_ms);

  bool inSync() const { return state_.has_value(); }
  bool ended() const { return is_ended_; }
  const ScenePack& pack() const { return *pack_; }
  const BaseTerrain& base() const { return *base_; }
  const WorldState& state() const { return *state_; }
  int mismatchCount() const { return mismatch_count_; }
  std::vector<TileCoordinate> takeChangedTiles();
  std::uint32_t requestCrater(const CraterWish& wish);
  std::vector<CraterOutcome> takeCraterOutcomes() { return std::exchange(outcomes_, {}); }

 private:
  enum class Stage : std::uint8_t { connecting, greeting, fetching_pack, fetching_snapshot, following };

  Status serve(std::int64_t now_ms, int wait_ms);
  Status onMessage(const Message& message);
  Status onWelcome(const Welcome& welcome);
  Status onBulkChunk(const BulkChunk& chunk);
  Status onPack(std::vector<std::uint8_t> bytes);
  Status onSnapshot(std::span<const std::uint8_t> bytes);
  Status onTick(TickUpdate update);
  Status onGoodbye(const Goodbye& goodbye);
  Status onCraterReply(const CraterReply& reply);
  Status onRefused(const Refused& refused) const;
  Status onDisconnected(CloseCode code);
  Status checkTime(std::int64_t now_ms) const;

  void apply(const TickUpdate& update);
  void heal(SnapshotCause cause, const std::string& what);
  void requestSnapshot(SnapshotCause cause);
  void confirm();
  void send(const Message& message);
  void noteEnd();
  Error unexpected(const Message& message) const;

  Transport& transport_;
  PeerId server_;
  FollowerOptions options_;
  Stage stage_ = Stage::connecting;
  std::int64_t stage_since_ms_;
  std::optional<std::string> failure_;

  PackId pack_id_;
  std::optional<BulkAssembler> bulk_;
  std::uint64_t announced_pack_bytes_ = 0;
  std::optional<ScenePack> pack_;
  std::optional<BaseTerrain> base_;  // points to pack_
  std::optional<WorldState> state_;

  std::deque<TickUpdate> waiting_;  // ticks that came before their snapshot
  std::size_t waiting_bytes_ = 0;
  std::set<TileCoordinate> changed_;
  int mismatch_count_ = 0;
  std::uint32_t last_request_ = 0;
  std::set<std::uint32_t> asked_;  // requests without an outcome
  std::vector<CraterOutcome> outcomes_;
  std::optional<std::int32_t> final_tick_;
  bool is_ended_ = false;
};

}  // namespace spoor
