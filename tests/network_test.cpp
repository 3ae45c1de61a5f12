// Sessions on the seeded in-process network: who joins, when, and what goes wrong. Time is an argument; nothing sleeps.
#include <algorithm>

#include "tests/network_rig.h"

namespace spoor::test {
namespace {

/// The first report of a name: who joins first is up to the network.
const ClientReport& reportOf(const std::vector<ClientReport>& reports, const std::string& name) {
  return *std::ranges::find(reports, name, &ClientReport::name);
}

TEST(Join, AtTickZeroFollowsToTheEnd) {
  for (const auto& conditions : {kNear, kFar}) {
    ScriptedSession session;
    Rig rig(conditions, session);
    Player& a = rig.join("a");
    Player& b = rig.join("b");
    rig.runUntil([&] { return rig.book.clientsInSync() == 2; });
    rig.play(50);
    const auto reports = rig.finish();
    ASSERT_EQ(reports.size(), 2u);
    EXPECT_FALSE(rig.book.isClosing());
    for (const ClientReport& report : reports) {
      EXPECT_TRUE(report.in_sync);
      EXPECT_EQ(report.confirmed_tick, 50);
      EXPECT_EQ(report.confirmed_hash, session.hash_at[50]);
      EXPECT_EQ(report.mismatches, 0);
      EXPECT_EQ(report.ticks_sent, 50);
      EXPECT_GT(report.tick_bytes_sent, 0u);
      EXPECT_GT(report.snapshot_bytes_sent, 0u);
      EXPECT_EQ(report.left_because, "");
    }
    for (const Player* player : {&a, &b}) {
      EXPECT_EQ(player->error, "");
      EXPECT_TRUE(player->follower->ended());
      expectEqualState(*player, session);
    }
  }
}

TEST(Join, MidSessionGetsASnapshotAndTheTicksAfterIt) {
  ScriptedSession session;
  Rig rig(kFar, session);
  Player& first = rig.join("first");
  rig.play(40);
  Player& late = rig.join("late");
  rig.play(60);
  EXPECT_TRUE(late.follower->inSync());
  const auto reports = rig.finish();
  ASSERT_EQ(reports.size(), 2u);
  EXPECT_TRUE(reports[1].in_sync);
  EXPECT_LT(reports[1].ticks_sent, 60);
  expectEqualState(first, session);
  expectEqualState(late, session);
  EXPECT_EQ(late.follower->mismatchCount(), 0);
}

TEST(Join, AfterAChangeOfParametersHoldsThemToo) {
  ScriptedSession session;
  Parameters first = session.pack.parameters, second = first;
  first.slopes = SlopeRule::flux;
  first.materials[0].compression_q16 = 30000;
  second.nearest = NearestSearch::jump_flooding;
  session.changes = {{10, first}, {70, second}};
  Rig rig(kFar, session);
  Player& early = rig.join("early");
  rig.play(40);
  Player& late = rig.join("late");
  rig.play(20);
  rig.runUntil([&] { return late.follower->inSync(); });
  EXPECT_EQ(late.follower->state().parameters, first) << "from the snapshot";
  rig.play(40);
  const auto reports = rig.finish();
  ASSERT_EQ(reports.size(), 2u);
  for (const Player* player : {&early, &late}) {
    EXPECT_EQ(player->follower->mismatchCount(), 0);
    EXPECT_EQ(player->follower->state().parameters, second);
    expectEqualState(*player, session);
  }
  EXPECT_EQ(reportOf(reports, "late").confirmed_hash, session.hash_at[100]);
}

TEST(Join, AfterTheGoodbyeIsRefused) {
  ScriptedSession session;
  Rig rig(kNear, session);
  rig.play(3);
  rig.book.sayGoodbye("over");
  Player& late = rig.join("late");
  rig.run(100);
  EXPECT_TRUE(contains(late.error, "the session is over")) << late.error;
}

TEST(Join, BeyondTheLimitIsRefused) {
  ScriptedSession session;
  Rig rig(kNear, session, {.max_clients = 1});
  Player& first = rig.join("first");
  rig.run(50);
  Player& second = rig.join("second");
  rig.run(100);
  EXPECT_TRUE(contains(second.error, "full")) << second.error;
  EXPECT_EQ(first.error, "");
  EXPECT_EQ(rig.book.clientsInSync(), 1);
}

TEST(Join, WhileTheSessionEndsStillReachesTheLastTick) {
  ScriptedSession session;
  Rig rig(kFar, session);
  rig.play(20);
  Player& late = rig.join("late");
  rig.runUntil([&] { return rig.book.reports().size() == 1; });
  const auto reports = rig.finish();
  EXPECT_TRUE(reports[0].in_sync);
  EXPECT_TRUE(late.follower->ended());
  expectEqualState(late, session);
}

TEST(Rejoin, AKilledClientComesBackToTheServersHash) {
  ScriptedSession session;
  Rig rig(kFar, session, {.silence_limit_ms = 500});
  Player& steady = rig.join("steady");
  Player& killed = rig.join("viewer");
  rig.play(30);
  rig.kill(killed);
  rig.play(30);
  Player& again = rig.join("viewer");
  rig.play(60);
  const auto reports = rig.finish();
  ASSERT_EQ(reports.size(), 3u);
  EXPECT_EQ(reportOf(reports, "viewer").left_because, "no data for 0 s");
  EXPECT_FALSE(reportOf(reports, "viewer").in_sync);
  EXPECT_TRUE(reports[2].in_sync);
  EXPECT_EQ(reports[2].confirmed_hash, session.hash_at[120]);
  expectEqualState(steady, session);
  expectEqualState(again, session);
}

TEST(Changes, EveryChangedTileIsNamedOnce) {
  ScriptedSession session;
  Rig rig(kNear, session);
  Player& player = rig.join("a");
  rig.play(10);
  rig.runUntil([&] { return player.follower->inSync() && player.follower->state().tick == 10; });
  const auto all = player.follower->takeChangedTiles();
  EXPECT_EQ(all.size(), session.state.tiles.size());
  EXPECT_TRUE(std::ranges::is_sorted(all));
  EXPECT_TRUE(player.follower->takeChangedTiles().empty());
  rig.play(1);
  rig.run(50);
  for (const TileCoordinate at : player.follower->takeChangedTiles()) EXPECT_EQ((at.x + at.y + 11) % 4, 0);
}

/// Runs a session in which one tick reaches a client changed; the client must heal and end on the server's state.
void healAfter(const std::function<bool(TickUpdate&)>& change_tick, SnapshotCause cause) {
  ScriptedSession session;
  Rig rig(kNear, session);
  Player& player = rig.join("a");
  Player& other = rig.join("b");
  rig.runUntil([&] { return rig.book.clientsInSync() == 2; });
  player.transport->change = [&](Message& message) {
    auto* tick = std::get_if<TickUpdate>(&message);
    return tick == nullptr || tick->tick != 20 || change_tick(*tick);
  };
  rig.play(40);
  const auto reports = rig.finish();
  EXPECT_EQ(player.error, "");
  EXPECT_EQ(player.follower->mismatchCount(), 1) << int(cause);
  EXPECT_EQ(reportOf(reports, "a").mismatches, cause == SnapshotCause::hash_mismatch ? 0 : 1);
  EXPECT_TRUE(reportOf(reports, "a").in_sync);
  EXPECT_EQ(reportOf(reports, "b").mismatches, 0);
  expectEqualState(player, session);
  expectEqualState(other, session);
}

TEST(Heal, ACorruptTileIsReplacedByASnapshot) {
  healAfter([](TickUpdate& tick) { return tick.tiles.back() ^= 1, true; }, SnapshotCause::tile_mismatch);
}

TEST(Heal, TilesThatCannotBeReadAreReplacedByASnapshot) {
  healAfter([](TickUpdate& tick) { return tick.tiles.resize(10), true; }, SnapshotCause::tile_mismatch);
}

TEST(Heal, AWrongStateHashIsReplacedByASnapshot) {
  // The client's own state is right, so the server does not count it.
  healAfter([](TickUpdate& tick) { return tick.state_hash ^= 1, true; }, SnapshotCause::hash_mismatch);
}

TEST(Heal, LostParametersAreReplacedByASnapshot) {
  ScriptedSession session;
  session.changes[20] = session.pack.parameters;
  session.changes[20].capacity_rounds = 1;
  Rig rig(kNear, session);
  Player& player = rig.join("a");
  rig.runUntil([&] { return rig.book.clientsInSync() == 1; });
  player.transport->change = [&](Message& message) {
    if (auto* tick = std::get_if<TickUpdate>(&message); tick != nullptr && tick->tick == 20) tick->parameters.reset();
    return true;
  };
  rig.play(40);
  const auto reports = rig.finish();
  EXPECT_EQ(player.follower->mismatchCount(), 1);
  EXPECT_EQ(reports[0].mismatches, 1);
  EXPECT_EQ(player.follower->state().parameters, session.changes[20]);
  expectEqualState(player, session);
}

TEST(Heal, ParametersThatDoNotGoWithThePackAreReplacedByASnapshot) {
  // Within their ranges, but this world is too large to be simulated whole.
  ScriptedSession session(noisePack(20000, 150, 7, -20000, 20000, 50000));
  Rig rig(kNear, session);
  Player& player = rig.join("a");
  rig.runUntil([&] { return rig.book.clientsInSync() == 1; });
  player.transport->change = [&](Message& message) {
    auto* tick = std::get_if<TickUpdate>(&message);
    if (tick == nullptr || tick->tick != 3) return true;
    tick->parameters = session.pack.parameters;
    tick->parameters->active_areas = 0;
    return true;
  };
  rig.play(6);
  rig.finish();
  EXPECT_EQ(player.follower->mismatchCount(), 1);
  EXPECT_EQ(player.error, "");
  expectEqualState(player, session);
}

TEST(Heal, AMissingTickIsReplacedByASnapshot) {
  healAfter([](TickUpdate&) { return false; }, SnapshotCause::missing_tick);
}

TEST(Heal, AStateThatDiffersIsCountedByTheServer) {
  ScriptedSession session;
  Rig rig(kNear, session);
  Player& player = rig.join("a");
  rig.runUntil([&] { return rig.book.clientsInSync() == 1; });
  player.transport->change = [&](Message& message) {
    if (auto* tick = std::get_if<TickUpdate>(&message); tick != nullptr && tick->tick == 5) tick->poses[0].x_q += 1;
    return true;
  };
  rig.play(20);
  const auto reports = rig.finish();
  EXPECT_EQ(reports[0].mismatches, 1);
  EXPECT_EQ(player.follower->mismatchCount(), 1);
  EXPECT_TRUE(reports[0].in_sync);
  expectEqualState(player, session);
}

TEST(Heal, AClientThatNeverHealsIsLetGo) {
  ScriptedSession session;
  Rig rig(kNear, session);
  Player& broken = rig.join("broken");
  Player& other = rig.join("other");
  broken.transport->change = [](Message& message) {
    if (auto* tick = std::get_if<TickUpdate>(&message)) tick->state_hash ^= 1;
    return true;
  };
  rig.play(100);
  EXPECT_TRUE(contains(broken.error, "more than 16 snapshots a minute")) << broken.error;
  rig.finish();
  expectEqualState(other, session);
}

TEST(Time, AClientWithoutAHelloIsLetGo) {
  ScriptedSession session;
  Rig rig(kNear, session);
  Player& quiet = rig.connect();
  rig.run(4900);
  EXPECT_FALSE(quiet.is_disconnected);
  rig.run(300);
  EXPECT_TRUE(quiet.is_disconnected);
  EXPECT_EQ(quiet.refusal, "no hello in time");
  EXPECT_TRUE(rig.book.reports().empty());
}

TEST(Time, AServerThatFallsSilentIsAnError) {
  ScriptedSession session;
  Rig rig(kNear, session);
  Player& player = rig.join("a");
  rig.play(10);
  rig.network.cut(player.transport->inner());
  rig.run(9900);
  EXPECT_EQ(player.error, "");
  rig.run(300);
  EXPECT_EQ(player.error, "server rig:1 went away (no data for 10 s)");
}

TEST(Time, AServerThatNeverAnswersIsAnError) {
  ScriptedSession session;
  Rig rig(kNear, session);
  Player& player = rig.join("a");
  rig.network.cut(player.transport->inner());
  rig.run(10200);
  EXPECT_EQ(player.error, "no answer from rig:1 within 10 s");
}

TEST(Pace, BulkNeverFillsTheLine) {
  std::vector<std::int32_t> heights(600 * 600);
  for (std::size_t i = 0; i < heights.size(); ++i) heights[i] = std::int32_t(i * 2654435761u % 1000000007u % 100000);
  ScriptedSession session(groundPack(600, 600, heights, 1000));
  ASSERT_GT(session.encoded_pack.size(), std::size_t(1) << 20);
  Rig rig(kFar, session);
  Player& player = rig.join("a");
  rig.play(200);
  rig.finish();
  expectEqualState(player, session);
  EXPECT_GT(rig.most_bulk_outstanding, std::size_t(200) << 10);
  EXPECT_LT(rig.most_bulk_outstanding, std::size_t(300) << 10);
}

TEST(Pace, AClientThatTakesNoTicksIsLetGo) {
  ScriptedSession session(true);
  Rig rig(kNear, session);
  Player& stuck = rig.join("stuck");
  Player& other = rig.join("other");
  rig.runUntil([&] { return rig.book.clientsInSync() == 2; });
  stuck.is_frozen = true;
  rig.play(260);
  const auto reports = rig.book.reports();
  EXPECT_EQ(reportOf(reports, "stuck").left_because, "too slow: more than 16 MiB of ticks not acknowledged");
  EXPECT_LT(reportOf(reports, "stuck").tick_bytes_sent, std::uint64_t(18) << 20);
  stuck.is_frozen = false;
  rig.finish();
  EXPECT_EQ(stuck.error, "server rig:1 let this client go: too slow");
  expectEqualState(other, session);
}

TEST(End, AClientThatDoesNotConfirmIsReported) {
  ScriptedSession session;
  Rig rig(kNear, session);
  Player& stuck = rig.join("stuck");
  rig.join("other");
  rig.play(10);
  stuck.is_frozen = true;
  rig.play(5);
  rig.book.sayGoodbye("over");
  rig.run(500);
  EXPECT_FALSE(rig.book.allDone());
  rig.book.letGo();
  rig.run(100);
  const auto reports = rig.book.reports();
  EXPECT_FALSE(reportOf(reports, "stuck").in_sync);
  EXPECT_EQ(reportOf(reports, "stuck").left_because, "the last tick was not confirmed in time");
  EXPECT_TRUE(reportOf(reports, "other").in_sync);
}

}  // namespace
}  // namespace spoor::test
