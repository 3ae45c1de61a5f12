// Clients that talk nonsense: each is let go with a reason, and nobody else notices. On the in-process network.
#include <random>

#include "tests/network_rig.h"

namespace spoor::test {
namespace {

/// One client that talks for itself; it must be let go with a reason while another goes on.
void expectLetGo(const std::function<void(Player&, Rig&)>& talk, const std::string& reason) {
  ScriptedSession session;
  Rig rig(kNear, session);
  Player& honest = rig.join("honest");
  rig.play(10);
  Player& hostile = rig.connect();
  rig.play(1);
  talk(hostile, rig);
  rig.play(20);
  ASSERT_TRUE(hostile.refusal) << reason;
  EXPECT_TRUE(contains(*hostile.refusal, reason)) << *hostile.refusal;
  EXPECT_TRUE(hostile.is_disconnected);
  rig.finish();
  EXPECT_EQ(honest.error, "");
  EXPECT_TRUE(honest.follower->ended());
  expectEqualState(honest, session);
}

/// Says hello, gets the pack and a snapshot.
void joinByHand(Player& player, Rig& rig) {
  player.say(Hello{kProtocolVersion, "by hand"});
  player.say(SnapshotRequest{});
  rig.play(5);
}

TEST(Hostile, BytesThatAreNoMessage) {
  expectLetGo([](Player& p, Rig&) { p.sayBytes(std::vector<std::uint8_t>(300, 0x41)); }, "wrong magic");
  expectLetGo([](Player& p, Rig&) { p.sayBytes({}); }, "cut off");
}

TEST(Hostile, AMessageOnlyServersSend) {
  expectLetGo([](Player& p, Rig&) { p.say(Goodbye{"over", 3}); }, "wrong side");
}

TEST(Hostile, ARequestBeforeTheHello) {
  expectLetGo([](Player& p, Rig&) { p.say(SnapshotRequest{}); }, "no hello");
}

TEST(Hostile, ASecondHello) {
  expectLetGo(
      [](Player& p, Rig&) {
        p.say(Hello{kProtocolVersion, "x"}), p.say(Hello{kProtocolVersion, "x"});
      },
      "second hello");
}

TEST(Hostile, ASecondPackRequest) {
  expectLetGo(
      [](Player& p, Rig&) {
        p.say(Hello{kProtocolVersion, "x"}), p.say(PackRequest{}), p.say(PackRequest{});
      },
      "out of turn");
}

TEST(Hostile, SnapshotRequestsWithoutEnd) {
  const auto talk = [](Player& p, Rig& rig) {
    joinByHand(p, rig);
    for (int i = 0; i < 20; ++i) p.say(SnapshotRequest{}), rig.run(20);
  };
  expectLetGo(talk, "more than 16 snapshots a minute");
}

TEST(Hostile, AConfirmationBeforeTheSnapshot) {
  expectLetGo([](Player& p, Rig&) { p.say(Hello{kProtocolVersion, "x"}), p.say(Confirm{1, 2}); }, "out of turn");
}

TEST(Hostile, AConfirmationOfTheFuture) {
  expectLetGo([](Player& p, Rig& rig) { joinByHand(p, rig), p.say(Confirm{1000, 2}); }, "tick 1000 out of turn");
}

TEST(Hostile, AConfirmationOfThePast) {
  expectLetGo([](Player& p, Rig& rig) { joinByHand(p, rig), p.say(Confirm{2, 2}); }, "tick 2 out of turn");
}

TEST(Hostile, AnotherProtocolVersion) {
  expectLetGo([](Player& p, Rig&) { p.say(Hello{1, "x"}); }, "server speaks protocol 4, this client 1");
}

TEST(Hostile, RandomMessagesNeverStopASession) {
  std::mt19937_64 random(5);
  ScriptedSession session;
  Rig rig(kNear, session);
  Player& honest = rig.join("honest");
  for (int i = 0; i < 60; ++i) {
    Player& hostile = rig.connect();
    rig.play(1);
    for (int said = 0; said < 8; ++said) {
      switch (random() % 6) {
        case 0:
          hostile.say(Hello{kProtocolVersion, "x"});
          break;
        case 1:
          hostile.say(PackRequest{});
          break;
        case 2:
          hostile.say(SnapshotRequest{SnapshotCause(random() % 4)});
          break;
        case 3:
          hostile.say(Confirm{std::int32_t(random() % 80), random()});
          break;
        case 4:
          hostile.say(CraterRequest{std::uint32_t(random()), {{.x_q = std::int32_t(random())}, random() % 2 == 0}});
          break;
        default:
          hostile.sayBytes(std::vector<std::uint8_t>(random() % 40, std::uint8_t(random())));
          break;
      }
    }
  }
  rig.play(10);
  rig.book.sayGoodbye("over");
  rig.run(1000);
  rig.book.letGo();
  rig.run(1000);
  EXPECT_EQ(honest.error, "");
  EXPECT_TRUE(honest.follower->ended());
  expectEqualState(honest, session);
}

}  // namespace
}  // namespace spoor::test
