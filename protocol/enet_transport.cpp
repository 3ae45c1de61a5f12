#include "protocol/enet_transport.h"

#include <enet/enet.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <unordered_map>

#include "protocol/frame.h"
#include "shared/base/assert.h"

namespace spoor {
namespace {

// Silence is the sessions' business (silenceMs); ENet gives up only well after them.
constexpr enet_uint32 kTimeoutLimit = 32;
constexpr enet_uint32 kTimeoutLowest_ms = 30000;
constexpr enet_uint32 kTimeoutHighest_ms = 60000;
constexpr std::size_t kServerWaitingLimitBytes = std::size_t(1) << 20;  // a client has little to say
constexpr std::size_t kClientWaitingLimitBytes = std::size_t(64) << 20;
constexpr int kEventsPerService = 4096;
constexpr int kFailuresPerService = 64;
/// ENet's own clock follows the wall clock, which may step: silence is measured on this one.
std::int64_t steadyMs() {
  using namespace std::chrono;
  return duration_cast<milliseconds>(steady_clock::now().time_since_epoch()).count();
}

constexpr std::int64_t kNotListening_ms = 250;  // a longer pause between two services is this end's own

/// What is kept of a connected peer. ENet's peers and packets point here, so it never moves.
struct PeerRecord {
  PeerId id = 0;
  ENetPeer* peer = nullptr;
  std::array<std::size_t, kChannelCount> outstanding_bytes{};
  std::int64_t heard_ms = 0;
  enet_uint32 last_receive_time = 0;
  bool announced = false;  // the caller has seen `connected`
};

/// ENet frees a packet when it was acknowledged, or dropped with its peer.
void onPacketFreed(ENetPacket* packet) { *static_cast<std::size_t*>(packet->userData) -= packet->dataLength; }

class EnetTransport final : public Transport {
 public:
  explicit EnetTransport(ENetHost* host) : host_(host), last_service_ms_(steadyMs()) {}
  ~EnetTransport() override {
    for (auto& [id, record] : records_) enet_peer_disconnect_now(record->peer, enet_uint32(CloseCode::left));
    enet_host_destroy(host_);  // before the records, which freed packets point to
  }
  EnetTransport(const EnetTransport&) = delete;
  EnetTransport& operator=(const EnetTransport&) = delete;

  std::vector<TransportEvent> service(int wait_ms) override;
  void send(PeerId peer, Channel channel, std::span<const std::uint8_t> bytes) override;
  std::size_t outstandingBytes(PeerId peer, Channel channel) const override;
  std::int64_t silenceMs(PeerId peer) const override;
  void closeAfterQueue(PeerId peer, CloseCode code) override;
  void close(PeerId peer, CloseCode code) override;
  int failureCount() const override { return failure_count_; }

  /// Makes the record of a peer; called for outgoing connections at once, for incoming ones when they stand.
  PeerRecord& adopt(ENetPeer* peer);

 private:
  PeerRecord* find(PeerId id) const {
    const auto found = records_.find(id);
    return found == records_.end() ? nullptr : found->second.get();
  }
  void notePause();
  void take(ENetEvent& event, std::vector<TransportEvent>& events);

  ENetHost* host_;
  std::unordered_map<PeerId, std::unique_ptr<PeerRecord>> records_;
  PeerId next_id_ = 1;
  int failure_count_ = 0;
  std::int64_t now_ms_ = 0;
  std::int64_t last_service_ms_;
};

PeerRecord& EnetTransport::adopt(ENetPeer* peer) {
  auto record = std::make_unique<PeerRecord>();
  record->id = next_id_++;
  record->peer = peer;
  record->heard_ms = now_ms_;
  peer->data = record.get();
  enet_peer_timeout(peer, kTimeoutLimit, kTimeoutLowest_ms, kTimeoutHighest_ms);
  return *(records_[record->id] = std::move(record));
}

/// Time spent elsewhere since the last service is nobody's silence.
void EnetTransport::notePause() {
  const std::int64_t time_ms = steadyMs();
  const std::int64_t passed_ms = time_ms - last_service_ms_;
  last_service_ms_ = time_ms;
  now_ms_ += passed_ms;
  if (passed_ms <= kNotListening_ms) return;
  for (auto& [id, record] : records_) record->heard_ms += passed_ms;
}

std::vector<TransportEvent> EnetTransport::service(int wait_ms) {
  notePause();
  std::vector<TransportEvent> events;
  int failures = 0;
  auto wait = enet_uint32(std::max(wait_ms, 0));
  for (int i = 0; i < kEventsPerService; ++i) {
    ENetEvent event{};
    const int outcome = enet_host_service(host_, &event, wait);
    wait = 0;
    if (outcome == 0) break;
    if (outcome > 0) {
      take(event, events);
      continue;
    }
    // One bad datagram (over 4096 bytes, say) makes it fail; the rest of the traffic is fine.
    ++failure_count_;
    if (++failures >= kFailuresPerService) break;
  }
  const std::int64_t time_ms = steadyMs();
  now_ms_ += time_ms - last_service_ms_;
  last_service_ms_ = time_ms;
  for (auto& [id, record] : records_) {  // acknowledgements count as being heard, and ENet asks for one every 500 ms
    if (record->peer->lastReceiveTime == record->last_receive_time) continue;
    record->last_receive_time = record->peer->lastReceiveTime;
    record->heard_ms = now_ms_;
  }
  return events;
}

void EnetTransport::take(ENetEvent& event, std::vector<TransportEvent>& events) {
  auto* record = static_cast<PeerRecord*>(event.peer->data);
  switch (event.type) {
    case ENET_EVENT_TYPE_CONNECT:
      if (record == nullptr && event.peer->channelCount < kChannelCount) {
        enet_peer_disconnect_now(event.peer, 0);  // what is sent on a channel it lacks would vanish unseen
        break;
      }
      if (record == nullptr) record = &adopt(event.peer);
      record->heard_ms = now_ms_;
      record->announced = true;
      events.push_back({TransportEvent::Kind::connected, record->id, Channel::control, CloseCode::none, {}});
      break;
    case ENET_EVENT_TYPE_DISCONNECT:
      event.peer->data = nullptr;  // the slot will serve others
      if (record == nullptr) break;
      events.push_back({TransportEvent::Kind::disconnected, record->id, Channel::control, CloseCode(event.data), {}});
      records_.erase(record->id);
      break;
    case ENET_EVENT_TYPE_RECEIVE:
      if (record != nullptr && event.channelID < kChannelCount) {
        record->heard_ms = now_ms_;
        const std::span data(event.packet->data, event.packet->dataLength);
        events.push_back({TransportEvent::Kind::message,
                          record->id,
                          Channel(event.channelID),
                          CloseCode::none,
                          {data.begin(), data.end()}});
      }
      enet_packet_destroy(event.packet);
      break;
    case ENET_EVENT_TYPE_NONE:
      break;
  }
}

void EnetTransport::send(PeerId peer, Channel channel, std::span<const std::uint8_t> bytes) {
  PeerRecord* record = find(peer);
  if (record == nullptr) return;
  ENetPacket* packet = enet_packet_create(bytes.data(), bytes.size(), ENET_PACKET_FLAG_RELIABLE);
  SPOOR_ASSERT(packet != nullptr);
  std::size_t& outstanding = record->outstanding_bytes[std::size_t(channel)];
  outstanding += bytes.size();
  packet->userData = &outstanding;
  packet->freeCallback = onPacketFreed;
  if (enet_peer_send(record->peer, enet_uint8(channel), packet) != 0 && packet->referenceCount == 0) {
    enet_packet_destroy(packet);
  }
}

std::size_t EnetTransport::outstandingBytes(PeerId peer, Channel channel) const {
  const PeerRecord* record = find(peer);
  return record == nullptr ? 0 : record->outstanding_bytes[std::size_t(channel)];
}

std::int64_t EnetTransport::silenceMs(PeerId peer) const {
  const PeerRecord* record = find(peer);
  return record == nullptr ? 0 : std::max<std::int64_t>(now_ms_ - record->heard_ms, 0);
}

void EnetTransport::closeAfterQueue(PeerId peer, CloseCode code) {
  if (PeerRecord* record = find(peer)) enet_peer_disconnect_later(record->peer, enet_uint32(code));
}

void EnetTransport::close(PeerId peer, CloseCode code) {
  if (PeerRecord* record = find(peer)) enet_peer_disconnect(record->peer, enet_uint32(code));
}

/// ENet's global set-up; on this system it only seeds a clock, once is enough.
Status initializeEnet() {
  static const int outcome = enet_initialize();
  if (outcome != 0) return Error{"network: ENet cannot be initialised"};
  return {};
}

}  // namespace

Result<EnetServer> listenEnet(std::uint16_t port, std::size_t peers_limit) {
  if (const auto status = initializeEnet(); !status) return Error{status.error()};
  const ENetAddress address{ENET_HOST_ANY, port};
  ENetHost* host = enet_host_create(&address, peers_limit, kChannelCount, 0, 0);
  if (host == nullptr) return Error{"cannot listen on UDP port " + std::to_string(port) + ": the port is taken"};
  host->maximumPacketSize = kFrameLimitBytes;  // ENet has one limit for both directions
  host->maximumWaitingData = kServerWaitingLimitBytes;
  ENetAddress bound{};
  if (enet_socket_get_address(host->socket, &bound) == 0) host->address.port = bound.port;
  const std::uint16_t bound_port = host->address.port;
  return EnetServer{std::make_unique<EnetTransport>(host), bound_port};
}

Result<EnetClient> connectEnet(const std::string& host_name, std::uint16_t port) {
  if (const auto status = initializeEnet(); !status) return Error{status.error()};
  ENetAddress address{};
  if (enet_address_set_host(&address, host_name.c_str()) != 0) return Error{"cannot resolve host '" + host_name + "'"};
  address.port = port;
  ENetHost* host = enet_host_create(nullptr, 1, kChannelCount, 0, 0);
  if (host == nullptr) return Error{"network: no UDP socket for a client"};
  host->maximumPacketSize = kFrameLimitBytes;
  host->maximumWaitingData = kClientWaitingLimitBytes;
  auto transport = std::make_unique<EnetTransport>(host);
  ENetPeer* peer = enet_host_connect(host, &address, kChannelCount, 0);
  if (peer == nullptr) return Error{"network: no connection to " + host_name + " can be started"};
  const PeerId server = transport->adopt(peer).id;
  return EnetClient{std::move(transport), server};
}

}  // namespace spoor
