#include "client/follower.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "shared/base/assert.h"
#include "shared/world/tile_snow.h"

namespace spoor {
namespace {

constexpr std::size_t kWaitingLimitBytes = std::size_t(64) << 20;

std::string seconds(std::int64_t time_ms) {
  std::string text = std::to_string(time_ms / 1000);
  if (time_ms % 1000 != 0) text += "." + std::to_string(time_ms % 1000 / 100);
  return text + " s";
}

std::size_t sizeOf(const TickUpdate& update) {
  return sizeof(TickUpdate) + update.poses.size() * sizeof(Pose) + update.tiles.size() +
         update.craters.size() * sizeof(Crater);
}

}  // namespace

Follower::Follower(Transport& transport, PeerId server, FollowerOptions options, std::int64_t now_ms)
    : transport_(transport), server_(server), options_(std::move(options)), stage_since_ms_(now_ms) {}

Status Follower::update(std::int64_t now_ms, int wait_ms) {
  if (failure_) return Error{*failure_};
  if (is_ended_) {
    (void)transport_.service(wait_ms);  // so that the connection closes in order
    return {};
  }
  Status status = serve(now_ms, wait_ms);
  noteEnd();
  if (is_ended_) return {};
  if (!status) failure_ = status.error();
  return status;
}

Status Follower::serve(std::int64_t now_ms, int wait_ms) {
  for (const TransportEvent& event : transport_.service(wait_ms)) {
    if (event.kind == TransportEvent::Kind::connected) {
      stage_ = Stage::greeting;
      stage_since_ms_ = now_ms;
      send(Hello{kProtocolVersion, options_.client_name});
      continue;
    }
    if (event.kind == TransportEvent::Kind::disconnected) return onDisconnected(event.code);
    auto message = decodeMessage(event.bytes, Sender::server);
    if (!message) {
      return Error{"server " + options_.server_name + " sent bytes that are no message: " + message.error()};
    }
    Status status;
    if (auto* tick = std::get_if<TickUpdate>(&*message))
      status = onTick(std::move(*tick));
    else
      status = onMessage(*message);
    if (!status) return status;
  }
  return checkTime(now_ms);
}

Status Follower::onMessage(const Message& message) {
  switch (kindOf(message)) {
    case MessageKind::welcome:
      return onWelcome(std::get<Welcome>(message));
    case MessageKind::bulk_chunk:
      return onBulkChunk(std::get<BulkChunk>(message));
    case MessageKind::goodbye:
      return onGoodbye(std::get<Goodbye>(message));
    case MessageKind::refused:
      return onRefused(std::get<Refused>(message));
    case MessageKind::crater_reply:
      return onCraterReply(std::get<CraterReply>(message));
    case MessageKind::crater_request:
    case MessageKind::tick_update:
    case MessageKind::hello:
    case MessageKind::pack_request:
    case MessageKind::snapshot_request:
    case MessageKind::confirm:
      break;
  }
  return unexpected(message);
}

Error Follower::unexpected(const Message& message) const {
  return Error{"server " + options_.server_name + " sent a " + toText(kindOf(message)) + " out of turn"};
}

Status Follower::onWelcome(const Welcome& welcome) {
  if (stage_ != Stage::greeting) return unexpected(welcome);
  if (welcome.protocol_version != kProtocolVersion) {
    return Error{"server speaks protocol " + std::to_string(welcome.protocol_version) + ", this client " +
                 std::to_string(kProtocolVersion)};
  }
  pack_id_ = welcome.pack_id;
  announced_pack_bytes_ = welcome.pack_bytes;
  bulk_.emplace(BulkKind::pack);
  stage_ = Stage::fetching_pack;
  send(PackRequest{});
  return {};
}

Status Follower::onBulkChunk(const BulkChunk& chunk) {
  if (!bulk_) return unexpected(chunk);
  const std::string from = "server " + options_.server_name + ": ";
  if (const Status status = bulk_->add(chunk); !status) return Error{from + status.error()};
  if (stage_ == Stage::fetching_pack && bulk_->rawBytes() != announced_pack_bytes_) {
    return Error{from + "the pack is of another size than the welcome said"};
  }
  if (!bulk_->complete()) return {};
  auto bytes = bulk_->unpack();
  bulk_.reset();
  if (!bytes) return Error{from + bytes.error()};
  return stage_ == Stage::fetching_pack ? onPack(std::move(*bytes)) : onSnapshot(*bytes);
}

Status Follower::onPack(std::vector<std::uint8_t> bytes) {
  const std::string from = "server " + options_.server_name + ": ";
  if (packId(bytes) != pack_id_) {
    return Error{from + "the pack's id is " + toText(packId(bytes)) + ", announced was " + toText(pack_id_)};
  }
  auto pack = decodePack(bytes);
  if (!pack) return Error{from + pack.error()};
  pack_ = std::move(*pack);
  base_.emplace(*pack_);
  requestSnapshot(SnapshotCause::join);
  return {};
}

Status Follower::onSnapshot(std::span<const std::uint8_t> bytes) {
  auto snapshot = decodeSnapshot(bytes, pack_id_, *base_);
  if (!snapshot) return Error{"server " + options_.server_name + ": " + snapshot.error()};
  if (state_) {  // a tile may turn out to be dormant after all
    for (const Tile* tile : std::as_const(state_->tiles).sorted()) changed_.insert(tile->at);
  }
  state_ = std::move(*snapshot);
  for (const Tile* tile : std::as_const(state_->tiles).sorted()) changed_.insert(tile->at);
  stage_ = Stage::following;
  confirm();
  // Ticks up to the snapshot's are in it already. One that fails asks for yet another snapshot; the rest then waits on.
  while (!waiting_.empty() && stage_ == Stage::following) {
    const TickUpdate update = std::move(waiting_.front());
    waiting_.pop_front();
    waiting_bytes_ -= sizeOf(update);
    apply(update);
  }
  return {};
}

Status Follower::onTick(TickUpdate update) {
  if (stage_ == Stage::following) {
    apply(update);
    return {};
  }
  if (stage_ != Stage::fetching_snapshot) return unexpected(std::move(update));
  waiting_bytes_ += sizeOf(update);
  waiting_.push_back(std::move(update));
  if (waiting_bytes_ <= kWaitingLimitBytes) return {};
  return Error{"server " + options_.server_name + " sent more than 64 MiB of ticks before the snapshot they belong to"};
}

void Follower::apply(const TickUpdate& update) {
  if (update.tick <= state_->tick) return;
  if (update.tick > state_->tick + 1) {
    return heal(SnapshotCause::missing_tick,
                "tick " + std::to_string(update.tick) + " came after tick " + std::to_string(state_->tick));
  }
  const Status status = applyTick(*state_, *base_, update);
  if (!status && state_->tick != update.tick) return heal(SnapshotCause::tile_mismatch, status.error());
  const auto changes = decodeTiles(update.tiles, *pack_);
  for (const TileChange& change : *changes) changed_.insert(change.at);
  for (const Tile* tile : tilesInSnow(*state_, update.tick, SnowTiles::all)) changed_.insert(tile->at);
  confirm();
  if (!status) heal(SnapshotCause::hash_mismatch, status.error());
}

/// Keeps what is held on show until a snapshot replaces it.
void Follower::heal(SnapshotCause cause, const std::string& what) {
  ++mismatch_count_;
  spdlog::warn("{}; asking for a new snapshot", what);
  requestSnapshot(cause);
}

void Follower::requestSnapshot(SnapshotCause cause) {
  bulk_.emplace(BulkKind::snapshot);
  stage_ = Stage::fetching_snapshot;
  send(SnapshotRequest{cause});
}

void Follower::confirm() { send(Confirm{state_->tick, stateHash(*state_)}); }

void Follower::send(const Message& message) {
  if (const auto frame = encodeMessage(message)) transport_.send(server_, Channel::control, *frame);
}

Status Follower::onGoodbye(const Goodbye& goodbye) {
  if (stage_ == Stage::connecting || stage_ == Stage::greeting || final_tick_) return unexpected(goodbye);
  if (state_ && goodbye.final_tick < state_->tick) {
    return Error{"server " + options_.server_name + " ends at tick " + std::to_string(goodbye.final_tick) +
                 ", but sent tick " + std::to_string(state_->tick)};
  }
  final_tick_ = goodbye.final_tick;
  return {};
}

Status Follower::onRefused(const Refused& refused) const {
  if (refused.protocol_version != kProtocolVersion) {
    return Error{"server speaks protocol " + std::to_string(refused.protocol_version) + ", this client " +
                 std::to_string(kProtocolVersion)};
  }
  return Error{"server " + options_.server_name + " let this client go: " + refused.reason};
}

Status Follower::onCraterReply(const CraterReply& reply) {
  if (asked_.erase(reply.sequence) == 0) return unexpected(reply);
  outcomes_.push_back({reply.sequence, reply.tick, reply.id, reply.reason});
  return {};
}

std::uint32_t Follower::requestCrater(const CraterWish& wish) {
  SPOOR_ASSERT(inSync());
  asked_.insert(++last_request_);
  send(CraterRequest{last_request_, wish});
  return last_request_;
}

/// The connection stands no longer: an end in order only where the last tick has been confirmed.
Status Follower::onDisconnected(CloseCode code) {
  if (final_tick_ && stage_ == Stage::following && state_->tick == *final_tick_) {
    is_ended_ = true;
    return {};
  }
  const std::string& server = options_.server_name;
  if (stage_ == Stage::connecting) return Error{"no answer from " + server};
  if (final_tick_) {
    return Error{"server " + server + " ended the session before its last tick, " + std::to_string(*final_tick_) +
                 ", was here"};
  }
  switch (code) {
    case CloseCode::none:
      return Error{"server " + server + " went away (connection lost)"};
    case CloseCode::too_slow:
      return Error{"server " + server + " let this client go: too slow"};
    case CloseCode::refused:
      return Error{"server " + server + " let this client go"};
    case CloseCode::done:
    case CloseCode::left:
      break;
  }
  return Error{"connection closed by server " + server + " without goodbye"};
}

Status Follower::checkTime(std::int64_t now_ms) const {
  const std::int64_t limit_ms = options_.timeout_ms;
  const bool is_answered = stage_ != Stage::connecting && stage_ != Stage::greeting;
  if (!is_answered && now_ms - stage_since_ms_ > limit_ms) {
    return Error{"no answer from " + options_.server_name + " within " + seconds(limit_ms)};
  }
  if (is_answered && transport_.silenceMs(server_) > limit_ms) {
    return Error{"server " + options_.server_name + " went away (no data for " + seconds(limit_ms) + ")"};
  }
  return {};
}

/// The session has ended well when the confirmation of its last tick has arrived; the server's closing proves that too.
void Follower::noteEnd() {
  if (!final_tick_ || stage_ != Stage::following || state_->tick != *final_tick_) return;
  if (transport_.outstandingBytes(server_, Channel::control) == 0) is_ended_ = true;
}

std::vector<TileCoordinate> Follower::takeChangedTiles() {
  std::vector<TileCoordinate> result(changed_.begin(), changed_.end());
  changed_.clear();
  return result;
}

}  // namespace spoor
