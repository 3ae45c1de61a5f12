#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/follower.h"
#include "protocol/in_process_transport.h"
#include "server/client_book.h"
#include "tests/scenes.h"

namespace spoor::test {

inline constexpr InProcessNetwork::Conditions kNear{1, 4, 0, 100};
inline constexpr InProcessNetwork::Conditions kFar{30, 90, 30, 150};

bool contains(const std::string& text, const std::string& part);

/// A session without a simulator: every tick changes a few tiles in a way that depends on nothing but the tick.
class ScriptedSession {
 public:
  /// 200 x 150 cells, two bodies. `rough`: every cell of every tile changes, to anything, so that nothing compresses.
  explicit ScriptedSession(bool rough = false);
  explicit ScriptedSession(ScenePack own_pack);
  ScriptedSession(const ScriptedSession&) = delete;
  ScriptedSession& operator=(const ScriptedSession&) = delete;

  TickUpdate step();

  ScenePack pack;
  std::vector<std::uint8_t> encoded_pack;
  BaseTerrain base{pack};
  WorldState state;
  std::map<std::int32_t, std::uint64_t> hash_at;
  std::map<std::int32_t, Parameters> changes;  // of parameters, by the first tick they are for
  std::vector<Crater> arriving;                // that come with the next tick

 private:
  TileChange changeTile(TileCoordinate at, std::int32_t tick, std::size_t first_new_crater) const;
  bool rough_ = false;
};

/// Another transport, through which a test may change what comes in.
class Meddler final : public Transport {
 public:
  explicit Meddler(std::unique_ptr<Transport> inner) : inner_(std::move(inner)) {}

  std::vector<TransportEvent> service(int wait_ms) override;
  void send(PeerId peer, Channel channel, std::span<const std::uint8_t> bytes) override {
    inner_->send(peer, channel, bytes);
  }
  std::size_t outstandingBytes(PeerId peer, Channel channel) const override {
    return inner_->outstandingBytes(peer, channel);
  }
  std::int64_t silenceMs(PeerId peer) const override { return inner_->silenceMs(peer); }
  void closeAfterQueue(PeerId peer, CloseCode code) override { inner_->closeAfterQueue(peer, code); }
  void close(PeerId peer, CloseCode code) override { inner_->close(peer, code); }
  int failureCount() const override { return inner_->failureCount(); }
  const Transport& inner() const { return *inner_; }

  /// Called for each message from the server; false: it is left out.
  std::function<bool(Message&)> change;

 private:
  std::unique_ptr<Transport> inner_;
};

/// A client of the rig.
struct Player {
  std::unique_ptr<Meddler> transport;
  PeerId server = 0;
  std::unique_ptr<Follower> follower;  // none: the test talks for itself
  std::string error;                   // what update() said
  bool is_frozen = false;              // not updated

  void say(const Message& message);
  void sayBytes(std::span<const std::uint8_t> bytes) { transport->send(server, Channel::control, bytes); }
  /// The reason of a refusal among what the server said, for players that talk for themselves.
  std::optional<std::string> refusal;
  bool is_disconnected = false;
  std::vector<CraterReply> replies;  // for players that talk for themselves
};

/// A server and its clients on an in-process network, in step.
class Rig {
 public:
  Rig(const InProcessNetwork::Conditions& conditions, ScriptedSession& session, const BookOptions& options = {});

  Player& join(const std::string& name);
  /// A client that only connects.
  Player& connect();
  void kill(Player& player);

  /// Passes time in steps of 2 ms.
  void run(int time_ms);
  /// Passes time until `done`, at most `limit_ms`; fails the test where that is not enough.
  void runUntil(const std::function<bool()>& done, int limit_ms = 20000);
  /// Publishes ticks, one every 16 ms, with the craters that clients have asked for.
  void play(int tick_count);
  /// Says goodbye and waits until all that is left has closed.
  std::vector<ClientReport> finish();

  InProcessNetwork network;
  ScriptedSession& session;
  std::unique_ptr<Transport> server_transport;
  ClientBook book;
  std::vector<std::unique_ptr<Player>> players;
  std::size_t most_bulk_outstanding = 0;

 private:
  void stepPlayers();
};

/// The player holds the session's state: hash, sums, and every height.
void expectEqualState(const Player& player, const ScriptedSession& session);

}  // namespace spoor::test
