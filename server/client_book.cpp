#include "server/client_book.h"

#include <spdlog/spdlog.h>

#include <algorithm>

#include "shared/base/assert.h"
#include "shared/base/json.h"

namespace spoor {
namespace {

constexpr std::size_t kBulkWindowBytes = std::size_t(256) << 10;            // unacknowledged per client
constexpr std::size_t kTicksOutstandingLimitBytes = std::size_t(16) << 20;  // unacknowledged per client
constexpr std::size_t kSnapshotsLimit = 16;                                 // asked for by one client within ...
constexpr std::int64_t kSnapshotsPeriod_ms = 60000;
constexpr std::size_t kReportsKept = 1024;
constexpr const char* kOverReason = "crater: the session is over";

}  // namespace

ClientBook::ClientBook(Transport& transport, const ScenePack& pack, std::vector<std::uint8_t> encoded_pack,
                       const BookOptions& options)
    : transport_(transport),
      pack_(pack),
      options_(options),
      pack_bytes_(encoded_pack.size()),
      mirror_(pack, packId(encoded_pack)),
      pack_package_(makeBulkPackage(BulkKind::pack, std::move(encoded_pack))) {}

void ClientBook::publish(TickUpdate update) {
  SPOOR_ASSERT(update.tick == mirror_.tick() + 1 && !is_over_);
  if (const Status status = mirror_.apply(update); !status) {
    spdlog::error("the published ticks do not add up, no snapshots from here on: {}", status.error());
  }
  const auto follows = [](const auto& entry) { return entry.second.stage == Stage::following; };
  if (std::ranges::none_of(clients_, follows)) return;
  const std::int32_t tick = update.tick;
  const auto frame = encodeMessage(std::move(update));
  if (!frame) {  // clients see the gap and ask for a snapshot
    spdlog::error("tick {} is not sent: {}", tick, frame.error());
    return;
  }
  std::vector<PeerId> too_slow;
  for (const auto& [peer, client] : clients_) {
    if (client.stage != Stage::following) continue;
    transport_.send(peer, Channel::ticks, *frame);
    ClientReport& report = reports_.at(client.report_number);
    ++report.ticks_sent;
    report.tick_bytes_sent += frame->size();
    if (transport_.outstandingBytes(peer, Channel::ticks) > kTicksOutstandingLimitBytes) too_slow.push_back(peer);
  }
  for (const PeerId peer : too_slow) {
    release(peer, CloseCode::too_slow, "too slow: more than 16 MiB of ticks not acknowledged");
  }
}

void ClientBook::serve(std::int64_t now_ms, int wait_ms) {
  for (const TransportEvent& event : transport_.service(wait_ms)) {
    if (event.kind == TransportEvent::Kind::connected) {
      clients_[event.peer].connected_ms = now_ms;
      continue;
    }
    if (event.kind == TransportEvent::Kind::disconnected) {
      onDisconnected(event.peer, event.code);
      continue;
    }
    const auto found = clients_.find(event.peer);
    if (found != clients_.end()) onMessage(event.peer, found->second, event.bytes, now_ms);
  }
  checkTime(now_ms);
  for (auto& [peer, client] : clients_) pumpBulk(peer, client);
  mirror_.dropSnapshots([this](const BulkPackage* package) {
    return std::ranges::any_of(clients_, [package](const auto& entry) { return entry.second.sending == package; });
  });
}

void ClientBook::onMessage(PeerId peer, Client& client, std::span<const std::uint8_t> bytes, std::int64_t now_ms) {
  const auto message = decodeMessage(bytes, Sender::client);
  if (!message) return release(peer, CloseCode::refused, message.error());
  const bool is_hello = kindOf(*message) == MessageKind::hello;
  if (is_hello != (client.stage == Stage::greeting)) {
    return release(peer, CloseCode::refused, is_hello ? "a second hello" : "no hello before the first request");
  }
  switch (kindOf(*message)) {
    case MessageKind::hello:
      return onHello(peer, client, std::get<Hello>(*message));
    case MessageKind::pack_request:
      return onPackRequest(peer, client);
    case MessageKind::snapshot_request:
      return onSnapshotRequest(peer, client, std::get<SnapshotRequest>(*message), now_ms);
    case MessageKind::confirm:
      return onConfirm(peer, client, std::get<Confirm>(*message));
    case MessageKind::crater_request:
      return onCraterRequest(peer, client, std::get<CraterRequest>(*message), now_ms);
    case MessageKind::welcome:
    case MessageKind::bulk_chunk:
    case MessageKind::tick_update:
    case MessageKind::goodbye:
    case MessageKind::refused:
    case MessageKind::crater_reply:
      break;  // decodeMessage does not let a client send these
  }
}

void ClientBook::onDisconnected(PeerId peer, CloseCode code) {
  closing_.erase(peer);
  const auto found = clients_.find(peer);
  if (found == clients_.end()) return;
  if (found->second.stage != Stage::greeting) {
    ClientReport& report = reports_.at(found->second.report_number);
    report.in_sync = false;
    report.left_because = code == CloseCode::none ? "connection lost" : "left";
    spdlog::info("client '{}' is gone: {}", report.name, report.left_because);
  }
  clients_.erase(found);
  trimReports();
}

void ClientBook::onHello(PeerId peer, Client& client, const Hello& hello) {
  if (hello.protocol_version != kProtocolVersion) {
    return release(peer, CloseCode::refused,
                   "server speaks protocol " + std::to_string(kProtocolVersion) + ", this client " +
                       std::to_string(hello.protocol_version));
  }
  if (is_over_) return release(peer, CloseCode::refused, "the session is over");
  const auto seated = std::ranges::count_if(clients_, [](const auto& e) { return e.second.stage != Stage::greeting; });
  if (seated >= options_.max_clients) {
    return release(peer, CloseCode::refused, "the server is full (" + std::to_string(seated) + " clients)");
  }
  client.stage = Stage::welcomed;
  client.report_number = next_report_++;
  reports_[client.report_number].name = hello.name;
  spdlog::info("client '{}' joins at tick {}", hello.name, mirror_.tick());
  send(peer, Channel::control,
       Welcome{kProtocolVersion, mirror_.packId(), mirror_.tick(), pack_bytes_, pack_.ticks_per_second});
}

void ClientBook::onPackRequest(PeerId peer, Client& client) {
  if (client.has_asked_for_pack || client.sending != nullptr || client.stage == Stage::following) {
    return release(peer, CloseCode::refused, "a pack request out of turn");
  }
  client.has_asked_for_pack = true;
  client.sending = &pack_package_;
  client.sent_bytes = 0;
}

void ClientBook::onSnapshotRequest(PeerId peer, Client& client, const SnapshotRequest& request, std::int64_t now_ms) {
  if (client.sending != nullptr) return release(peer, CloseCode::refused, "a snapshot request out of turn");
  auto& asked_ms = client.snapshots_ms;
  while (!asked_ms.empty() && now_ms - asked_ms.front() > kSnapshotsPeriod_ms) asked_ms.pop_front();
  if (asked_ms.size() >= kSnapshotsLimit) {
    return release(peer, CloseCode::refused, "asks for more than 16 snapshots a minute");
  }
  asked_ms.push_back(now_ms);
  const auto package = mirror_.snapshot();
  if (!package) return release(peer, CloseCode::refused, package.error());
  ClientReport& report = reports_.at(client.report_number);
  if (request.cause != SnapshotCause::join) {
    // A differing hash has been counted with its confirmation.
    if (request.cause != SnapshotCause::hash_mismatch) ++report.mismatches;
    report.in_sync = false;
    spdlog::warn("client '{}' asks for a new snapshot at tick {}, for {}", report.name, mirror_.tick(),
                 toText(request.cause));
  }
  client.stage = Stage::following;
  client.sending = *package;
  client.sent_bytes = 0;
  client.lowest_confirmation = mirror_.tick();
}

void ClientBook::onConfirm(PeerId peer, Client& client, const Confirm& confirm) {
  if (client.stage != Stage::following || confirm.tick < client.lowest_confirmation || confirm.tick > mirror_.tick()) {
    return release(peer, CloseCode::refused, "a confirmation of tick " + std::to_string(confirm.tick) + " out of turn");
  }
  const auto hash = mirror_.hashAt(confirm.tick);
  if (!hash) return release(peer, CloseCode::refused, "too far behind the session");
  client.lowest_confirmation = confirm.tick + 1;
  ClientReport& report = reports_.at(client.report_number);
  report.confirmed_tick = confirm.tick;
  report.confirmed_hash = confirm.state_hash;
  report.in_sync = confirm.state_hash == *hash;
  if (!report.in_sync) {
    ++report.mismatches;
    spdlog::warn("client '{}' holds hash {} at tick {}, the server {}", report.name, hexText(confirm.state_hash),
                 confirm.tick, hexText(*hash));
  }
  if (is_over_ && report.in_sync && confirm.tick == mirror_.tick()) release(peer, CloseCode::done, {});
}

void ClientBook::onCraterRequest(PeerId peer, Client& client, const CraterRequest& request, std::int64_t now_ms) {
  ++reports_.at(client.report_number).craters_asked;
  if (!client.craters.count(pack_.crater_limits, now_ms))
    return release(peer, CloseCode::refused,
                   "asks for more than " + std::to_string(pack_.crater_limits.requests_per_minute) + " + " +
                       std::to_string(CraterRequests::kExcessLimit) + " craters a minute");
  if (client.stage != Stage::following)
    return refuseCrater(peer, client, request.sequence, "crater: this client does not follow the session yet");
  if (is_over_) return refuseCrater(peer, client, request.sequence, kOverReason);
  if (unanswered_ >= options_.craters_limit)
    return refuseCrater(peer, client, request.sequence,
                        "crater: " + std::to_string(unanswered_) + " wait for a tick already");
  const auto crater = client.craters.admit(pack_, mirror_.poses(), request, now_ms);
  if (!crater) return refuseCrater(peer, client, request.sequence, crater.error());
  ++unanswered_;
  orders_.push_back({client.report_number, request.sequence, *crater});
}

void ClientBook::refuseCrater(PeerId peer, Client& client, std::uint32_t sequence, const std::string& reason) {
  ++reports_.at(client.report_number).craters_refused;
  send(peer, Channel::control, CraterReply{sequence, false, 0, 0, reason});
}

void ClientBook::answer(std::span<const CraterAnswer> answers) {
  std::map<std::uint64_t, PeerId> peers;
  if (!answers.empty())
    for (const auto& [peer, client] : clients_)
      if (client.stage != Stage::greeting) peers[client.report_number] = peer;
  SPOOR_ASSERT(answers.size() <= unanswered_);
  unanswered_ -= answers.size();
  for (const CraterAnswer& answer : answers) {
    const auto found = peers.find(answer.client);
    if (found == peers.end()) continue;
    Client& client = clients_.at(found->second);
    client.craters.close(answer.sequence);
    if (answer.tick == 0)
      refuseCrater(found->second, client, answer.sequence, answer.reason);
    else
      send(found->second, Channel::control, CraterReply{answer.sequence, true, answer.tick, answer.id, ""});
  }
}

void ClientBook::checkTime(std::int64_t now_ms) {
  std::vector<PeerId> late, silent;
  for (const auto& [peer, client] : clients_) {
    if (client.stage == Stage::greeting && now_ms - client.connected_ms > options_.hello_limit_ms)
      late.push_back(peer);
    else if (transport_.silenceMs(peer) > options_.silence_limit_ms)
      silent.push_back(peer);
  }
  for (const PeerId peer : late) release(peer, CloseCode::refused, "no hello in time");
  const std::string reason = "no data for " + std::to_string(options_.silence_limit_ms / 1000) + " s";
  for (const PeerId peer : silent) release(peer, CloseCode::none, reason);
}

/// Hands over as much bulk as the window holds, so that ticks and messages never queue behind it.
void ClientBook::pumpBulk(PeerId peer, Client& client) {
  if (client.sending == nullptr) return;
  ClientReport& report = reports_.at(client.report_number);
  while (transport_.outstandingBytes(peer, Channel::bulk) < kBulkWindowBytes) {
    const BulkChunk chunk = chunkAt(*client.sending, client.sent_bytes);
    const auto frame = encodeMessage(chunk);
    SPOOR_ASSERT(frame);  // a chunk fits its limits
    transport_.send(peer, Channel::bulk, *frame);
    report.snapshot_bytes_sent += frame->size();
    client.sent_bytes += chunk.bytes.size();
    if (client.sent_bytes < client.sending->stored.size()) continue;
    client.sending = nullptr;
    return;
  }
}

void ClientBook::send(PeerId peer, Channel channel, const Message& message) {
  const auto frame = encodeMessage(message);
  SPOOR_ASSERT(frame);  // only tick updates can be too large
  transport_.send(peer, channel, *frame);
}

void ClientBook::release(PeerId peer, CloseCode code, const std::string& reason) {
  const auto found = clients_.find(peer);
  SPOOR_ASSERT(found != clients_.end());
  if (code != CloseCode::done) {
    std::string name = "(no hello yet)";
    if (found->second.stage != Stage::greeting) {
      ClientReport& report = reports_.at(found->second.report_number);
      name = report.name;
      report.in_sync = false;
      report.left_because = reason;
    }
    spdlog::warn("client '{}' is let go: {}", name, reason);
  }
  if (code == CloseCode::refused) send(peer, Channel::control, Refused{kProtocolVersion, reason});
  // What is queued for a client that does not take it is not worth keeping.
  if (code == CloseCode::refused || code == CloseCode::done)
    transport_.closeAfterQueue(peer, code);
  else
    transport_.close(peer, code);
  closing_.insert(peer);
  clients_.erase(found);
  trimReports();
}

/// Reconnecting for ever must not fill the memory: of those gone, the oldest reports go first.
void ClientBook::trimReports() {
  for (auto report = reports_.begin(); reports_.size() > kReportsKept && report != reports_.end();) {
    report = report->second.left_because.empty() ? std::next(report) : reports_.erase(report);
  }
}

void ClientBook::sayGoodbye(const std::string& reason) {
  is_over_ = true;
  orders_.clear();
  std::vector<PeerId> unknown, finished;
  for (auto& [peer, client] : clients_) {
    if (client.stage == Stage::greeting) {
      unknown.push_back(peer);
      continue;
    }
    for (const std::uint32_t sequence : client.craters.pending()) refuseCrater(peer, client, sequence, kOverReason);
    client.craters = {};
    send(peer, Channel::control, Goodbye{reason, mirror_.tick()});
    const ClientReport& report = reports_.at(client.report_number);
    if (report.in_sync && report.confirmed_tick == mirror_.tick()) finished.push_back(peer);
  }
  for (const PeerId peer : unknown) release(peer, CloseCode::refused, "the session is over");
  for (const PeerId peer : finished) release(peer, CloseCode::done, {});
}

void ClientBook::letGo() {
  while (!clients_.empty()) {
    release(clients_.begin()->first, CloseCode::refused, "the last tick was not confirmed in time");
  }
}

int ClientBook::clientsInSync() const {
  return int(std::ranges::count_if(clients_, [this](const auto& entry) {
    return entry.second.stage != Stage::greeting && reports_.at(entry.second.report_number).in_sync;
  }));
}

std::vector<ClientReport> ClientBook::reports() const {
  std::vector<ClientReport> result;
  for (const auto& [number, report] : reports_) result.push_back(report);
  return result;
}

}  // namespace spoor
