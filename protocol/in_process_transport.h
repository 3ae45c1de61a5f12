#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <random>
#include <vector>

#include "protocol/transport.h"

namespace spoor {

/// A network within the process: one listener, any number of clients, seeded delay and loss, and time that passes only
/// when told to. Messages keep the promises of Transport (whole, once, in order per channel): a lost one is sent again.
/// One thread. Must outlive its transports.
class InProcessNetwork {
 public:
  struct Conditions {
    int lowest_delay_ms = 0;  // one way
    int highest_delay_ms = 0;
    int loss_permille = 0;  // of messages, each time they are sent; below 1000
    int resend_after_ms = 100;
  };

  InProcessNetwork(std::uint64_t seed, const Conditions& conditions);
  ~InProcessNetwork();
  InProcessNetwork(const InProcessNetwork&) = delete;
  InProcessNetwork& operator=(const InProcessNetwork&) = delete;

  /// Once.
  std::unique_ptr<Transport> listen();

  struct Client {
    std::unique_ptr<Transport> transport;
    PeerId server = 0;
  };
  Client connect();

  std::int64_t nowMs() const { return now_ms_; }
  void advance(int passed_ms) { now_ms_ += passed_ms; }

  /// Cuts a client's line without a word to anybody, as when its process is killed. Both ends fall silent.
  void cut(const Transport& client);

 private:
  friend class InProcessTransport;

  struct Transit {
    TransportEvent event;
    std::int64_t arrives_ms = 0;
    bool acknowledges = false;  // carries no event: `event.bytes.size()` bytes of the peer's have arrived
    std::size_t acknowledged_bytes = 0;
  };
  /// One direction of a line.
  struct Lane {
    std::vector<Transit> transits;  // in order of sending
    std::array<std::int64_t, kChannelCount> last_arrival_ms{};
  };
  struct Line {
    Lane to_server;
    Lane to_client;
    std::array<std::size_t, kChannelCount> outstanding_at_server{};
    std::array<std::size_t, kChannelCount> outstanding_at_client{};
    std::int64_t server_heard_ms = 0;
    std::int64_t client_heard_ms = 0;
    bool cut = false;
    bool closed_at_server = false;
    bool closed_at_client = false;
  };

  int draw(int lowest, int highest);
  std::int64_t arrival(Lane& lane, Channel channel);
  void post(PeerId line, bool from_server, TransportEvent event);
  void collect(PeerId line, bool at_server, std::vector<TransportEvent>& events);

  Conditions conditions_;
  std::mt19937_64 random_;
  std::int64_t now_ms_ = 0;
  PeerId next_line_ = 1;
  std::map<PeerId, Line> lines_;  // in order of connecting: what happens does not depend on addresses
};

}  // namespace spoor
