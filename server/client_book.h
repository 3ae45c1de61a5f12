#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "protocol/bulk.h"
#include "protocol/messages.h"
#include "protocol/transport.h"
#include "server/crater_requests.h"
#include "server/session_host.h"
#include "server/world_mirror.h"

namespace spoor {

struct BookOptions {
  int max_clients = 16;
  std::size_t craters_limit = 4096;       // of all clients, present or gone, that wait for a tick
  std::int64_t hello_limit_ms = 5000;     // from connecting to the hello
  std::int64_t silence_limit_ms = 15000;  // nothing heard of a client, not even acknowledgements
};

/// All clients of a session and what to do about each message of theirs (PROTOCOL.md, the server's states). Knows
/// neither threads nor sockets nor clocks. A client that talks nonsense is let go with a reason; the others never
/// notice.
class ClientBook {
 public:
  /// `transport` and `pack` must outlive the book.
  ClientBook(Transport& transport, const ScenePack& pack, std::vector<std::uint8_t> encoded_pack,
             const BookOptions& options);

  /// Follows a tick and sends it to everyone who follows; encoded once. Ticks must come in order, from 1 on.
  void publish(TickUpdate update);

  /// Moves bytes, waiting up to `wait_ms` for some, answers what came in and lets go of who is late.
  void serve(std::int64_t now_ms, int wait_ms);

  /// The craters that clients asked for and may have, since the last call, in the order of arrival. Each is to be
  /// answered; one whose client has left since is carried out as well.
  std::vector<CraterOrder> takeCraters() { return std::exchange(orders_, {}); }
  /// Tells clients what became of their orders; those that have left miss it.
  void answer(std::span<const CraterAnswer> answers);

  /// Tells everyone that the session ends with the last published tick. Nobody may join from here on, and craters that
  /// have not come are refused.
  void sayGoodbye(const std::string& reason);
  /// True when nobody is left who has yet to confirm the last tick; after sayGoodbye().
  bool allDone() const { return clients_.empty(); }
  /// Lets go of those who have not; after sayGoodbye().
  void letGo();
  /// Connections that are closing but not closed.
  bool isClosing() const { return !closing_.empty(); }

  int clientsInSync() const;
  std::vector<ClientReport> reports() const;

 private:
  enum class Stage : std::uint8_t { greeting, welcomed, following };
  struct Client {
    Stage stage = Stage::greeting;
    std::int64_t connected_ms = 0;
    std::uint64_t report_number = 0;  // in reports_, from `welcomed` on
    bool has_asked_for_pack = false;
    const BulkPackage* sending = nullptr;
    std::uint64_t sent_bytes = 0;           // of `sending`
    std::int32_t lowest_confirmation = 0;   // ticks below were confirmed, or came before the snapshot
    std::deque<std::int64_t> snapshots_ms;  // when it asked for one, the last minute
    CraterRequests craters;
  };
  using Clients = std::map<PeerId, Client>;  // in order of connecting

  void onMessage(PeerId peer, Client& client, std::span<const std::uint8_t> bytes, std::int64_t now_ms);
  void onDisconnected(PeerId peer, CloseCode code);
  void onHello(PeerId peer, Client& client, const Hello& hello);
  void onPackRequest(PeerId peer, Client& client);
  void onSnapshotRequest(PeerId peer, Client& client, const SnapshotRequest& request, std::int64_t now_ms);
  void onConfirm(PeerId peer, Client& client, const Confirm& confirm);
  void onCraterRequest(PeerId peer, Client& client, const CraterRequest& request, std::int64_t now_ms);
  void refuseCrater(PeerId peer, Client& client, std::uint32_t sequence, const std::string& reason);

  void checkTime(std::int64_t now_ms);
  void pumpBulk(PeerId peer, Client& client);
  void send(PeerId peer, Channel channel, const Message& message);
  /// Takes a client out of the book; it gets the reason. With `done` it is a client that has all there is.
  void release(PeerId peer, CloseCode code, const std::string& reason);
  void trimReports();

  Transport& transport_;
  const ScenePack& pack_;
  BookOptions options_;
  std::uint64_t pack_bytes_;
  WorldMirror mirror_;
  BulkPackage pack_package_;
  Clients clients_;
  std::vector<CraterOrder> orders_;
  std::size_t unanswered_ = 0;  // orders, handed over or not
  std::set<PeerId> closing_;
  std::map<std::uint64_t, ClientReport> reports_;  // in order of joining
  std::uint64_t next_report_ = 0;
  bool is_over_ = false;
};

}  // namespace spoor
