#include "tests/network_rig.h"

#include <algorithm>
#include <set>
#include <tuple>
#include <utility>

#include "shared/base/hash.h"
#include "shared/world/script.h"

namespace spoor::test {
namespace {

constexpr int kStep_ms = 2;
constexpr int kTick_ms = 16;

ScenePack smallPack() {
  ScenePack pack = noisePack(200, 150, 7, -20000, 20000, 10000000);
  addBody(pack, tetrahedronMesh(4000), 50000, 60000, 500);
  addBody(pack, boxMesh(3000, 3000, 3000), 120000, 80000, 0);
  return pack;
}

}  // namespace

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

ScriptedSession::ScriptedSession(bool rough) : ScriptedSession(smallPack()) { rough_ = rough; }

ScriptedSession::ScriptedSession(ScenePack own_pack)
    : pack(std::move(own_pack)), encoded_pack(encodePack(pack)), state(initialState(packId(encoded_pack), base)) {
  hash_at[0] = stateHash(state);
}

TileChange ScriptedSession::changeTile(TileCoordinate at, std::int32_t tick, std::size_t first_new_crater) const {
  const Tile* held = state.tiles.find(at);
  auto tile = makeTile(at, {&base, &state.craters}, tick);
  if (held != nullptr) {
    tile->height() = held->height();
    addCraters(at, tile->height(), *tile->bedrock, state.craters, first_new_crater, tile->craters);
  }
  const PlaneCells before = tile->height();
  const std::uint64_t seed = mix64(std::uint64_t(tick) << 32 | std::uint64_t(at.y) << 16 | std::uint64_t(at.x));
  // Two cells side by side share their soil out anew: nothing is lost.
  for (std::size_t i = 0; i < rules::kTileCells; i += 2) {
    const std::uint64_t draw = mix64(seed + i);
    const bool inside = at.x * rules::kTileSize + int(i) % rules::kTileSize + 1 < pack.width_cells &&
                        at.y * rules::kTileSize + int(i) / rules::kTileSize < pack.height_cells;
    if (!inside || (!rough_ && draw % 25 != 0)) continue;
    std::int32_t& first = tile->height()[i];
    std::int32_t& second = tile->height()[i + 1];
    const std::int64_t soil = std::int64_t(first) - (*tile->bedrock)[i];
    const std::int64_t other = std::int64_t(second) - (*tile->bedrock)[i + 1];
    const auto wanted =
        rough_ ? std::int64_t(draw >> 8) % (soil + other + 1) - soil : std::int64_t(draw >> 40) % 100 - 50;
    const auto moved_q = std::int32_t(std::clamp(wanted, -soil, other));
    first += moved_q;
    second -= moved_q;
  }
  tile->hash = tileHash(*tile);
  tile->wake_mask = tick % 3 == 0 ? 0 : kWakeSelf;
  return differenceOf(*tile, planesWith(*tile, before), held == nullptr ? kDormantVersion : held->version_tick);
}

TickUpdate ScriptedSession::step() {
  const std::int32_t tick = state.tick + 1;
  const TileCoordinate extent = tileExtent(pack);
  const std::size_t first_new_crater = state.craters.size();
  std::vector<Crater> craters = std::exchange(arriving, {});
  for (std::size_t i = 0; i < craters.size(); ++i) {
    craters[i].tick = tick;
    craters[i].id = std::uint32_t(first_new_crater + i);
  }
  state.craters.add(craters);
  std::set<TileCoordinate> cratered;
  for (const Tile* tile : state.tiles.meeting(pack, craters)) cratered.insert(tile->at);
  std::vector<TileChange> tiles;
  for (std::int32_t y = 0; y < extent.y; ++y) {
    for (std::int32_t x = 0; x < extent.x; ++x) {
      if (rough_ || (x + y + tick) % 4 == 0 || cratered.contains({x, y}))
        tiles.push_back(changeTile({x, y}, tick, first_new_crater));
    }
  }
  const Status status = applyTiles(state, base, tiles, tick, first_new_crater);
  EXPECT_TRUE(status) << status.error();
  state.tick = tick;
  state.previous_poses = std::move(state.poses);
  state.poses = Script(base).poses(tick);
  std::optional<Parameters> parameters;
  if (const auto found = changes.find(tick); found != changes.end()) parameters = state.parameters = found->second;
  hash_at[tick] = stateHash(state);
  return {tick, hash_at[tick], state.poses, encodeTiles(tiles), parameters, craters};
}

std::vector<TransportEvent> Meddler::service(int wait_ms) {
  auto events = inner_->service(wait_ms);
  if (!change) return events;
  std::erase_if(events, [this](TransportEvent& event) {
    if (event.kind != TransportEvent::Kind::message) return false;
    auto message = decodeMessage(event.bytes, Sender::server);
    EXPECT_TRUE(message);
    if (!change(*message)) return true;
    event.bytes = *encodeMessage(*message);
    return false;
  });
  return events;
}

void Player::say(const Message& message) { sayBytes(*encodeMessage(message)); }

Rig::Rig(const InProcessNetwork::Conditions& conditions, ScriptedSession& with_session, const BookOptions& options)
    : network(1234, conditions),
      session(with_session),
      server_transport(network.listen()),
      book(*server_transport, session.pack, session.encoded_pack, options) {}

Player& Rig::connect() {
  auto client = network.connect();
  auto player = std::make_unique<Player>();
  player->transport = std::make_unique<Meddler>(std::move(client.transport));
  player->server = client.server;
  players.push_back(std::move(player));
  return *players.back();
}

Player& Rig::join(const std::string& name) {
  Player& player = connect();
  player.follower = std::make_unique<Follower>(*player.transport, player.server, FollowerOptions{"rig:1", name, 10000},
                                               network.nowMs());
  return player;
}

void Rig::kill(Player& player) {
  network.cut(player.transport->inner());
  player.is_frozen = true;
}

void Rig::stepPlayers() {
  for (auto& player : players) {
    if (player->is_frozen) continue;
    if (player->follower) {
      const Status status = player->follower->update(network.nowMs(), 0);
      if (!status) player->error = status.error();
      continue;
    }
    for (const TransportEvent& event : player->transport->service(0)) {
      if (event.kind == TransportEvent::Kind::disconnected) player->is_disconnected = true;
      if (event.kind != TransportEvent::Kind::message) continue;
      const auto message = decodeMessage(event.bytes, Sender::server);
      ASSERT_TRUE(message) << message.error();
      if (const auto* refused = std::get_if<Refused>(&*message)) player->refusal = refused->reason;
      if (const auto* reply = std::get_if<CraterReply>(&*message)) player->replies.push_back(*reply);
    }
  }
}

void Rig::run(int time_ms) {
  for (int passed_ms = 0; passed_ms < time_ms; passed_ms += kStep_ms) {
    network.advance(kStep_ms);
    book.serve(network.nowMs(), 0);
    for (PeerId peer = 1; peer <= players.size(); ++peer) {
      most_bulk_outstanding = std::max(most_bulk_outstanding, server_transport->outstandingBytes(peer, Channel::bulk));
    }
    stepPlayers();
  }
}

void Rig::runUntil(const std::function<bool()>& done, int limit_ms) {
  for (int passed_ms = 0; passed_ms < limit_ms && !done(); passed_ms += kStep_ms) run(kStep_ms);
  EXPECT_TRUE(done()) << "not within " << limit_ms << " ms";
}

void Rig::play(int tick_count) {
  for (int i = 0; i < tick_count; ++i) {
    std::vector<CraterOrder> orders = book.takeCraters();
    std::ranges::sort(orders, {}, [](const CraterOrder& order) { return std::tuple(order.client, order.sequence); });
    std::vector<CraterAnswer> answers;
    for (const CraterOrder& order : orders) {
      const auto id = std::uint32_t(session.state.craters.size() + session.arriving.size());
      answers.push_back({order.client, order.sequence, session.state.tick + 1, id});
      session.arriving.push_back(order.crater);
    }
    book.publish(session.step());
    book.answer(answers);
    run(kTick_ms);
  }
}

std::vector<ClientReport> Rig::finish() {
  book.sayGoodbye("over");
  runUntil([this] { return book.allDone(); });
  run(1000);
  return book.reports();
}

void expectEqualState(const Player& player, const ScriptedSession& session) {
  ASSERT_TRUE(player.follower->inSync());
  const WorldState& held = player.follower->state();
  EXPECT_EQ(held.tick, session.state.tick);
  EXPECT_EQ(stateHash(held), stateHash(session.state));
  EXPECT_TRUE(recount(held));
  EXPECT_EQ(held.ledger, session.state.ledger);
  for (const Tile* tile : session.state.tiles.sorted()) {
    ASSERT_NE(held.tiles.find(tile->at), nullptr);
    EXPECT_EQ(held.tiles.find(tile->at)->height(), tile->height());
  }
}

}  // namespace spoor::test
