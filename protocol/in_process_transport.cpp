#include "protocol/in_process_transport.h"

#include <algorithm>

#include "shared/base/assert.h"

namespace spoor {

/// The listener's end of all lines (line 0), or a client's end of one.
class InProcessTransport final : public Transport {
 public:
  InProcessTransport(InProcessNetwork& network, PeerId line) : network_(network), line_(line) {}
  ~InProcessTransport() override {
    for (auto& [id, line] : network_.lines_) {
      if (isServer() || id == line_) close(isServer() ? id : kServer, CloseCode::left);
    }
  }
  InProcessTransport(const InProcessTransport&) = delete;
  InProcessTransport& operator=(const InProcessTransport&) = delete;

  static constexpr PeerId kServer = 1;  // what a client calls the server

  std::vector<TransportEvent> service(int) override {
    std::vector<TransportEvent> events;
    if (!isServer())
      network_.collect(line_, false, events);
    else
      for (auto& [id, line] : network_.lines_) network_.collect(id, true, events);
    return events;
  }

  void send(PeerId peer, Channel channel, std::span<const std::uint8_t> bytes) override {
    TransportEvent event{TransportEvent::Kind::message, peer, channel, CloseCode::none, {bytes.begin(), bytes.end()}};
    network_.post(lineOf(peer), isServer(), std::move(event));
  }

  std::size_t outstandingBytes(PeerId peer, Channel channel) const override {
    const auto& line = network_.lines_.at(lineOf(peer));
    return (isServer() ? line.outstanding_at_server : line.outstanding_at_client)[std::size_t(channel)];
  }

  std::int64_t silenceMs(PeerId peer) const override {
    const auto& line = network_.lines_.at(lineOf(peer));
    if (!line.cut) return 0;  // as ENet's pings see to
    return network_.now_ms_ - (isServer() ? line.server_heard_ms : line.client_heard_ms);
  }

  void closeAfterQueue(PeerId peer, CloseCode code) override { closeLine(peer, code); }

  void close(PeerId peer, CloseCode code) override {
    auto& line = network_.lines_.at(lineOf(peer));
    if (isServer() ? line.closed_at_server : line.closed_at_client) return;
    std::erase_if((isServer() ? line.to_client : line.to_server).transits,
                  [](const auto& transit) { return !transit.acknowledges; });
    closeLine(peer, code);
  }

  int failureCount() const override { return 0; }
  PeerId line() const { return line_; }

 private:
  bool isServer() const { return line_ == 0; }
  PeerId lineOf(PeerId peer) const { return isServer() ? peer : line_; }
  void closeLine(PeerId peer, CloseCode code) {
    auto& line = network_.lines_.at(lineOf(peer));
    bool& closed = isServer() ? line.closed_at_server : line.closed_at_client;
    if (closed) return;
    TransportEvent event{TransportEvent::Kind::disconnected, peer, Channel::control, code, {}};
    network_.post(lineOf(peer), isServer(), std::move(event));
    closed = true;
  }

  InProcessNetwork& network_;
  PeerId line_;
};

InProcessNetwork::InProcessNetwork(std::uint64_t seed, const Conditions& conditions)
    : conditions_(conditions), random_(seed) {
  SPOOR_ASSERT(conditions.loss_permille < 1000);
}

InProcessNetwork::~InProcessNetwork() = default;

std::unique_ptr<Transport> InProcessNetwork::listen() { return std::make_unique<InProcessTransport>(*this, 0); }

InProcessNetwork::Client InProcessNetwork::connect() {
  const PeerId id = next_line_++;
  Line& line = lines_[id];
  line.server_heard_ms = line.client_heard_ms = now_ms_;
  post(id, true, {TransportEvent::Kind::connected, id, Channel::control, CloseCode::none, {}});
  post(id, false, {TransportEvent::Kind::connected, id, Channel::control, CloseCode::none, {}});
  return {std::make_unique<InProcessTransport>(*this, id), InProcessTransport::kServer};
}

void InProcessNetwork::cut(const Transport& client) {
  Line& line = lines_.at(static_cast<const InProcessTransport&>(client).line());
  line.cut = true;
  line.server_heard_ms = line.client_heard_ms = now_ms_;
  line.to_server.transits.clear();
  line.to_client.transits.clear();
}

int InProcessNetwork::draw(int lowest, int highest) {
  // Not std::uniform_int_distribution: its results differ between standard libraries.
  return lowest + int(random_() % std::uint64_t(highest - lowest + 1));
}

/// When a message sent now arrives: after its delay and what it loses, and never before an earlier one of its channel.
std::int64_t InProcessNetwork::arrival(Lane& lane, Channel channel) {
  std::int64_t arrives_ms = now_ms_ + draw(conditions_.lowest_delay_ms, conditions_.highest_delay_ms);
  while (draw(0, 999) < conditions_.loss_permille) arrives_ms += conditions_.resend_after_ms;
  std::int64_t& last = lane.last_arrival_ms[std::size_t(channel)];
  return last = std::max(last, arrives_ms);
}

void InProcessNetwork::post(PeerId id, bool from_server, TransportEvent event) {
  Line& line = lines_.at(id);
  if (line.cut || (from_server ? line.closed_at_server : line.closed_at_client)) return;
  Lane& lane = from_server ? line.to_client : line.to_server;
  if (event.kind == TransportEvent::Kind::message) {
    auto& outstanding = from_server ? line.outstanding_at_server : line.outstanding_at_client;
    outstanding[std::size_t(event.channel)] += event.bytes.size();
  }
  Transit transit{std::move(event), 0, false, 0};
  transit.arrives_ms = arrival(lane, transit.event.channel);
  if (transit.event.kind == TransportEvent::Kind::disconnected) {  // the last word on every channel
    for (const auto arrives_ms : lane.last_arrival_ms) transit.arrives_ms = std::max(transit.arrives_ms, arrives_ms);
  } else if (transit.event.kind == TransportEvent::Kind::connected) {  // and the first
    lane.last_arrival_ms.fill(transit.arrives_ms);
  }
  lane.transits.push_back(std::move(transit));
}

void InProcessNetwork::collect(PeerId id, bool at_server, std::vector<TransportEvent>& events) {
  Line& line = lines_.at(id);
  Lane& lane = at_server ? line.to_server : line.to_client;
  Lane& back = at_server ? line.to_client : line.to_server;
  auto& outstanding = at_server ? line.outstanding_at_server : line.outstanding_at_client;
  bool& closed = at_server ? line.closed_at_server : line.closed_at_client;
  const auto due = [&](const Transit& transit) { return transit.arrives_ms <= now_ms_; };
  for (Transit& transit : lane.transits) {
    if (!due(transit)) continue;
    const Channel channel = transit.event.channel;
    if (transit.acknowledges) {
      outstanding[std::size_t(channel)] -= transit.acknowledged_bytes;
      continue;
    }
    if (transit.event.kind == TransportEvent::Kind::message) {
      Transit answer{{}, now_ms_ + conditions_.lowest_delay_ms, true, transit.event.bytes.size()};
      answer.event.channel = channel;
      back.transits.push_back(std::move(answer));
    }
    if (transit.event.kind == TransportEvent::Kind::disconnected) {
      // Answered, so that the end that closed hears of it too.
      post(id, at_server, {TransportEvent::Kind::disconnected, id, Channel::control, transit.event.code, {}});
      closed = true;
    }
    transit.event.peer = at_server ? id : InProcessTransport::kServer;
    events.push_back(std::move(transit.event));
  }
  std::erase_if(lane.transits, due);
}

}  // namespace spoor
