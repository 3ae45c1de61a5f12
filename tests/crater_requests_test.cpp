// Clients that ask for craters: who gets one, who is refused and why, and that all hold the same ground. On the
// in-process network.
#include <algorithm>
#include <limits>
#include <random>

#include "tests/network_rig.h"

namespace spoor::test {
namespace {

/// 20 x 15 m with two bodies at (5, 6) and (12, 8) m.
ScenePack craterPack() {
  ScenePack pack = noisePack(200, 150, 7, -20000, 20000, 10000000);
  addBody(pack, tetrahedronMesh(4000), 50000, 60000, 500);
  addBody(pack, boxMesh(3000, 3000, 3000), 120000, 80000, 0);
  pack.crater_limits.radius_q = 60000;
  pack.crater_limits.request_radius_q = 30000;
  pack.crater_limits.request_height_q = 5000;
  pack.crater_limits.request_distance_q = 50000;
  pack.crater_limits.requests_per_minute = 10;
  return pack;
}

/// R3 is 1.5 m; one that craterPack() admits.
CraterWish wishAt(std::int32_t x_q, std::int32_t y_q) {
  CraterWish wish;
  wish.crater.x_q = x_q;
  wish.crater.y_q = y_q;
  wish.crater.inner_radius_q = 5000;
  wish.crater.crest_radius_q = 10000;
  wish.crater.depth_q = 4000;
  wish.crater.noise_q16 = 9000;
  wish.balanced = true;
  return wish;
}

/// One client that follows a session of a pack.
struct Asking {
  explicit Asking(ScenePack pack, const BookOptions& options = {})
      : session(std::move(pack)), rig(kNear, session, options), player(rig.join("asking")) {
    rig.runUntil([&] { return rig.book.clientsInSync() == 1; });
    rig.play(2);
  }
  /// What becomes of one request.
  CraterOutcome ask(const CraterWish& wish) {
    const std::uint32_t sequence = player.follower->requestCrater(wish);
    rig.run(50);
    rig.play(4);
    auto outcomes = player.follower->takeCraterOutcomes();
    EXPECT_EQ(outcomes.size(), 1u);
    if (outcomes.empty()) return {};
    EXPECT_EQ(outcomes[0].sequence, sequence);
    return outcomes[0];
  }
  ScriptedSession session;
  Rig rig;
  Player& player;
};

TEST(CraterRequests, BecomeRecordsThatEveryoneHolds) {
  ScriptedSession session(craterPack());
  Rig rig(kFar, session);
  Player& asking = rig.join("asking");
  Player& other = rig.join("other");
  rig.runUntil([&] { return rig.book.clientsInSync() == 2; });
  rig.play(5);
  const std::uint32_t first = asking.follower->requestCrater(wishAt(60000, 60000));
  const std::uint32_t second = asking.follower->requestCrater(wishAt(65000, 64000));
  rig.run(300);
  rig.play(30);
  Player& late = rig.join("late");
  rig.play(30);
  const auto outcomes = asking.follower->takeCraterOutcomes();
  ASSERT_EQ(outcomes.size(), 2u);
  EXPECT_EQ(outcomes[0].sequence, first);
  EXPECT_EQ(outcomes[1].sequence, second);
  const auto records = session.state.craters.records();
  ASSERT_EQ(records.size(), 2u);
  for (const CraterOutcome& outcome : outcomes) {
    ASSERT_LT(outcome.id, 2u) << outcome.reason;
    EXPECT_EQ(records[outcome.id].tick, outcome.tick);
  }
  EXPECT_EQ(records[0].rim_height_q, balancedRimHeight(5000, 10000, 4000));
  const auto reports = rig.finish();
  for (const Player* player : {&asking, &other, &late}) {
    EXPECT_EQ(player->error, "");
    EXPECT_EQ(player->follower->mismatchCount(), 0);
    expectEqualState(*player, session);
    EXPECT_TRUE(std::ranges::equal(player->follower->state().craters.records(), records));
  }
  const auto& report = *std::ranges::find(reports, "asking", &ClientReport::name);
  EXPECT_EQ(report.craters_asked, 2);
  EXPECT_EQ(report.craters_refused, 0);
}

TEST(CraterRequests, BeyondALimitAreRefusedWithTheValueAndTheReason) {
  constexpr std::int32_t lowest = std::numeric_limits<std::int32_t>::min();
  constexpr std::int32_t highest = std::numeric_limits<std::int32_t>::max();
  const struct {
    std::function<void(CraterWish&)> spoil;
    const char* part;
  } wrong[] = {
      {[](CraterWish& w) { w.crater.crest_radius_q = 17501; }, "R3 = 2 R2 - R1 is 3.0002 m, a client may ask for 3 m"},
      {[](CraterWish& w) { w.crater.crest_radius_q = 40000; }, "R3 = 2 R2 - R1 is 7.5 m, the scene allows 6 m"},
      {[](CraterWish& w) { w.crater.depth_q = 5001; }, "D5 is 0.5001 m, a client may ask for 0.5 m"},
      {[](CraterWish& w) { w.balanced = false, w.crater.rim_height_q = 5001; }, "H4 is 0.5001 m, a client may ask for"},
      {[](CraterWish& w) { w.crater.x_q = 180000; }, "6.3246 m from the nearest body, 5 m are allowed"},
      {[](CraterWish& w) { w.crater.x_q = 210000; }, "from the nearest body, 5 m are allowed"},
      {[](CraterWish& w) { w.crater.x_q = 900000; }, "all of it lies off the map"},
      {[](CraterWish& w) { w.crater.crest_radius_q = 4999; }, "R1 0.5 m is more than R2 0.4999 m"},
      {[](CraterWish& w) { w.crater.crest_radius_q = 0; }, "R2 is 0 m, not above 0"},
      {[](CraterWish& w) { w.crater.depth_q = -1; }, "D5 is -0.0001 m"},
      {[](CraterWish& w) { w.crater.x_q = lowest; }, "off the map"},
      {[](CraterWish& w) { w.crater.y_q = highest; }, "off the map"},
      {[](CraterWish& w) { w.crater.inner_radius_q = lowest; }, "R1 is -214748.3648 m"},
      {[](CraterWish& w) { w.crater.crest_radius_q = lowest; }, "R2 is -214748.3648 m"},
      {[](CraterWish& w) { w.crater.crest_radius_q = highest; }, "the scene allows 6 m"},
      {[](CraterWish& w) { w.crater.depth_q = lowest; }, "D5 is -214748.3648 m"},
      {[](CraterWish& w) { w.balanced = false, w.crater.rim_height_q = lowest; }, "H4 is -214748.3648 m"},
  };
  Asking asking(craterPack());
  for (const auto& [spoil, part] : wrong) {
    CraterWish wish = wishAt(120000, 60000);
    spoil(wish);
    const CraterOutcome outcome = asking.ask(wish);
    EXPECT_EQ(outcome.tick, 0) << part;
    EXPECT_TRUE(contains(outcome.reason, part)) << outcome.reason;
  }
  EXPECT_EQ(asking.session.state.craters.size(), 0u);
  EXPECT_GT(asking.ask(wishAt(120000, 60000)).tick, 0) << "refusals cost nothing of what it may have";
  const auto reports = asking.rig.finish();
  EXPECT_EQ(asking.player.error, "");
  EXPECT_EQ(reports[0].craters_refused, std::int32_t(std::size(wrong)));
  expectEqualState(asking.player, asking.session);
}

TEST(CraterRequests, WithoutALimitOfDistanceMayBeAnywhere) {
  ScenePack pack = craterPack();
  pack.crater_limits.request_distance_q = 0;
  Asking asking(pack);
  EXPECT_GT(asking.ask(wishAt(199000, 1000)).tick, 0);
}

TEST(CraterRequests, AreRefusedWhereTheSceneHasNone) {
  ScenePack none = craterPack(), closed = craterPack();
  none.crater_limits = {};
  closed.crater_limits.request_radius_q = 0;
  Asking first(none);
  EXPECT_TRUE(contains(first.ask(wishAt(60000, 60000)).reason, "this scene has none"));
  Asking second(closed);
  EXPECT_TRUE(contains(second.ask(wishAt(60000, 60000)).reason, "clients may not ask"));
}

TEST(CraterRequests, BeyondTheRateAreRefusedUntilAMinuteHasPassed) {
  Asking asking(craterPack());
  for (int i = 0; i < 10; ++i) EXPECT_GT(asking.ask(wishAt(60000 + i, 60000)).tick, 0) << i;
  EXPECT_TRUE(contains(asking.ask(wishAt(60000, 60000)).reason, "more than 10 a minute"));
  for (int i = 0; i < 6; ++i) asking.rig.run(10000);
  EXPECT_GT(asking.ask(wishAt(60000, 60000)).tick, 0);
}

TEST(CraterRequests, WithoutEndLetTheClientGo) {
  ScriptedSession session(craterPack());
  Rig rig(kNear, session);
  Player& flooding = rig.join("flooding");
  Player& other = rig.join("other");
  rig.runUntil([&] { return rig.book.clientsInSync() == 2; });
  CraterWish wish = wishAt(60000, 60000);
  wish.crater.depth_q = -1;
  for (int i = 0; i < 610; ++i) flooding.follower->requestCrater(wish);
  rig.play(20);
  EXPECT_EQ(flooding.error, "") << "refused, all of them";
  flooding.follower->requestCrater(wish);
  rig.play(20);
  EXPECT_TRUE(contains(flooding.error, "more than 10 + 600 craters a minute")) << flooding.error;
  rig.finish();
  EXPECT_EQ(other.error, "");
  expectEqualState(other, session);
}

TEST(CraterRequests, ThatWaitForATickAreBounded) {
  ScenePack pack = craterPack();
  pack.crater_limits.requests_per_minute = 1000;
  Asking asking(pack);
  for (std::size_t i = 0; i <= CraterRequests::kPendingLimit; ++i)
    asking.player.follower->requestCrater(wishAt(60000, 60000));
  asking.rig.run(100);
  const auto refused = asking.player.follower->takeCraterOutcomes();
  ASSERT_EQ(refused.size(), 1u);
  EXPECT_TRUE(contains(refused[0].reason, "64 of this client's wait")) << refused[0].reason;
  asking.rig.play(2);
  EXPECT_EQ(asking.player.follower->takeCraterOutcomes().size(), CraterRequests::kPendingLimit);
  EXPECT_EQ(asking.session.state.craters.size(), CraterRequests::kPendingLimit);
}

TEST(CraterRequests, OfAllClientsTogetherAreBoundedAlsoOfThoseGone) {
  Asking asking(craterPack(), {.craters_limit = 3});
  Player& gone = asking.rig.join("gone");
  asking.rig.runUntil([&] { return asking.rig.book.clientsInSync() == 2; });
  for (int i = 0; i < 2; ++i) gone.follower->requestCrater(wishAt(60000, 60000));
  asking.rig.run(20);
  asking.rig.kill(gone);
  asking.rig.run(16000);
  for (int i = 0; i < 2; ++i) asking.player.follower->requestCrater(wishAt(60000, 60000));
  asking.rig.run(50);
  const auto refused = asking.player.follower->takeCraterOutcomes();
  ASSERT_EQ(refused.size(), 1u);
  EXPECT_TRUE(contains(refused[0].reason, "crater: 3 wait for a tick already")) << refused[0].reason;
  asking.rig.play(2);
  EXPECT_EQ(asking.session.state.craters.size(), 3u);
  EXPECT_EQ(asking.player.follower->takeCraterOutcomes().size(), 1u);
  EXPECT_GT(asking.ask(wishAt(60000, 60000)).tick, 0);
}

TEST(CraterRequests, OfAClientThatHasLeftStillCome) {
  Asking asking(craterPack());
  Player& other = asking.rig.join("other");
  asking.rig.runUntil([&] { return asking.rig.book.clientsInSync() == 2; });
  asking.player.follower->requestCrater(wishAt(60000, 60000));
  asking.rig.run(20);
  asking.rig.kill(asking.player);
  asking.rig.play(5);
  EXPECT_EQ(asking.session.state.craters.size(), 1u);
  asking.rig.run(16000);
  asking.rig.finish();
  expectEqualState(other, asking.session);
}

TEST(CraterRequests, ThatTheEndOvertakesAreRefused) {
  Asking asking(craterPack());
  asking.player.follower->requestCrater(wishAt(60000, 60000));
  asking.rig.run(20);
  const auto reports = asking.rig.finish();
  const auto outcomes = asking.player.follower->takeCraterOutcomes();
  ASSERT_EQ(outcomes.size(), 1u);
  EXPECT_TRUE(contains(outcomes[0].reason, "the session is over"));
  EXPECT_EQ(reports[0].craters_refused, 1);
  EXPECT_TRUE(asking.player.follower->ended());
}

/// A client that talks for itself, with the pack's craters open to it.
struct ByHand {
  ByHand() : session(craterPack()), rig(kNear, session), player(rig.connect()) {
    rig.play(1);
    player.say(Hello{kProtocolVersion, "by hand"});
    rig.play(5);
  }
  ScriptedSession session;
  Rig rig;
  Player& player;
};

TEST(CraterRequests, BeforeTheSnapshotAreRefused) {
  ByHand by_hand;
  by_hand.player.say(CraterRequest{1, wishAt(60000, 60000)});
  by_hand.rig.play(5);
  ASSERT_EQ(by_hand.player.replies.size(), 1u);
  EXPECT_TRUE(contains(by_hand.player.replies[0].reason, "does not follow the session yet"));
  EXPECT_FALSE(by_hand.player.is_disconnected);
}

TEST(CraterRequests, OfASequenceThatDoesNotRiseAreRefused) {
  ByHand by_hand;
  by_hand.player.say(SnapshotRequest{});
  by_hand.rig.play(5);
  for (const std::uint32_t sequence : {7u, 7u, 3u, 8u})
    by_hand.player.say(CraterRequest{sequence, wishAt(60000, 60000)});
  by_hand.rig.play(5);
  auto replies = by_hand.player.replies;
  ASSERT_EQ(replies.size(), 4u);
  EXPECT_EQ(std::ranges::count(replies, true, &CraterReply::accepted), 2);
  EXPECT_EQ(std::ranges::count_if(replies, [](const auto& r) { return contains(r.reason, "came after request 7"); }),
            2);
  EXPECT_EQ(by_hand.session.state.craters.size(), 2u);
}

TEST(CraterRequests, BeforeTheHelloLetTheClientGo) {
  ScriptedSession session(craterPack());
  Rig rig(kNear, session);
  Player& player = rig.connect();
  rig.play(1);
  player.say(CraterRequest{1, wishAt(60000, 60000)});
  rig.play(20);
  ASSERT_TRUE(player.refusal);
  EXPECT_TRUE(contains(*player.refusal, "no hello"));
}

TEST(CraterRequests, AReplyToNoneEndsTheClient) {
  Asking asking(craterPack());
  asking.player.transport->change = [](Message& message) {
    if (auto* reply = std::get_if<CraterReply>(&message)) reply->sequence = 99;
    return true;
  };
  asking.player.follower->requestCrater(wishAt(60000, 60000));
  asking.rig.play(10);
  EXPECT_TRUE(contains(asking.player.error, "sent a crater reply out of turn")) << asking.player.error;
}

TEST(CraterRequests, RandomOnesNeverStopASession) {
  std::mt19937_64 random(11);
  ScenePack pack = craterPack();
  pack.crater_limits.requests_per_minute = 60;
  Asking asking(pack);
  int refused = 0, came = 0;
  for (int i = 0; i < 300; ++i) {
    CraterWish wish = wishAt(std::int32_t(random() % 200000), std::int32_t(random() % 150000));
    Crater& crater = wish.crater;
    const auto any = [&] { return std::int32_t(random() >> (32 + random() % 31)); };
    for (std::int32_t* value : {&crater.inner_radius_q, &crater.crest_radius_q, &crater.depth_q, &crater.rim_height_q})
      if (random() % 3 == 0) *value = any();
    wish.balanced = random() % 2 == 0;
    asking.player.follower->requestCrater(wish);
    asking.rig.play(1);
  }
  asking.rig.run(100);
  asking.rig.play(1);
  for (const CraterOutcome& outcome : asking.player.follower->takeCraterOutcomes())
    ++(outcome.tick > 0 ? came : refused);
  EXPECT_EQ(came, int(asking.session.state.craters.size()));
  EXPECT_GT(came, 10);
  EXPECT_GT(refused, 100);
  asking.rig.finish();
  EXPECT_EQ(asking.player.follower->mismatchCount(), 0);
  expectEqualState(asking.player, asking.session);
}

}  // namespace
}  // namespace spoor::test
