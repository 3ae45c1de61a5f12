// Sessions over real sockets on 127.0.0.1: a few, with bounded waits; everything else is network_test.cpp's.
#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "client/session.h"
#include "protocol/enet_transport.h"
#include "server/session_host.h"
#include "tests/network_rig.h"

namespace spoor::test {
namespace {

using Clock = std::chrono::steady_clock;
using ClientPointer = std::unique_ptr<ClientSession>;

std::unique_ptr<SessionHost> openHost(const ScriptedSession& session) {
  auto host = SessionHost::open({}, session.pack, session.encoded_pack);
  EXPECT_TRUE(host) << host.error();
  return std::move(*host);
}

ClientPointer startClient(std::uint16_t port, double timeout_s = 10) {
  auto client = ClientSession::start({"127.0.0.1", port, "socket test", timeout_s});
  EXPECT_TRUE(client) << client.error();
  return std::move(*client);
}

/// Updates until `done` or 10 s are over or a client fails; returns the failure.
std::string updateUntil(const std::vector<ClientSession*>& clients, const std::function<bool()>& done) {
  const auto until = Clock::now() + std::chrono::seconds(10);
  while (!done()) {
    if (Clock::now() > until) return "not within 10 s";
    for (ClientSession* client : clients) {
      if (const Status status = client->update(1); !status) return status.error();
    }
  }
  return {};
}

void sendDatagram(std::uint16_t port, const std::vector<char>& bytes) {
  const int handle = ::socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  EXPECT_EQ(::sendto(handle, bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&address), sizeof address),
            ssize_t(bytes.size()));
  ::close(handle);
}

TEST(Sockets, ClientsJoinFollowAndFinish) {
  ScriptedSession session;
  const auto host = openHost(session);
  const auto first = startClient(host->port());
  ASSERT_EQ(updateUntil({first.get()}, [&] { return host->clientsInSync() == 1; }), "");
  for (int i = 0; i < 20; ++i) host->publish(session.step());
  const auto late = startClient(host->port());
  ASSERT_EQ(updateUntil({first.get(), late.get()}, [&] { return late->inSync(); }), "");
  sendDatagram(host->port(), std::vector<char>(6000, 'x'));  // ENet's service fails on it; nobody else must notice
  sendDatagram(host->port(), std::vector<char>(100, 'x'));
  for (int i = 0; i < 20; ++i) host->publish(session.step());

  std::vector<ClientReport> reports;
  std::thread finishing([&] { reports = host->finish(10); });
  const std::string error = updateUntil({first.get(), late.get()}, [&] { return first->ended() && late->ended(); });
  finishing.join();
  ASSERT_EQ(error, "");
  ASSERT_EQ(reports.size(), 2u);
  for (const ClientReport& report : reports) {
    EXPECT_TRUE(report.in_sync);
    EXPECT_EQ(report.left_because, "");
    EXPECT_EQ(report.confirmed_tick, 40);
    EXPECT_EQ(report.confirmed_hash, session.hash_at[40]);
    EXPECT_EQ(report.mismatches, 0);
  }
  EXPECT_EQ(stateHash(late->state()), session.hash_at[40]);
  EXPECT_EQ(late->pack().name, session.pack.name);
}

TEST(Sockets, ACraterGoesToTheTickLoopAndItsOutcomeBack) {
  ScenePack pack = noisePack(200, 150, 7, -20000, 20000, 10000000);
  addBody(pack, tetrahedronMesh(4000), 50000, 60000, 500);
  pack.crater_limits.radius_q = pack.crater_limits.request_radius_q = 30000;
  pack.crater_limits.request_height_q = 5000;
  ScriptedSession session(pack);
  const auto host = openHost(session);
  const auto client = startClient(host->port());
  ASSERT_EQ(updateUntil({client.get()}, [&] { return client->inSync(); }), "");
  CraterWish wish;
  wish.crater.x_q = wish.crater.y_q = 60000;
  wish.crater.crest_radius_q = 10000;
  wish.crater.depth_q = 3000;
  const std::uint32_t first = client->requestCrater(wish);
  wish.crater.depth_q = -1;
  const std::uint32_t second = client->requestCrater(wish);
  std::vector<CraterOrder> orders;
  ASSERT_EQ(updateUntil({client.get()}, [&] { return !(orders = host->tryTakeCraters()).empty(); }), "");
  ASSERT_EQ(orders.size(), 1u);
  EXPECT_EQ(orders[0].sequence, first);
  session.arriving = {orders[0].crater};
  host->publish(session.step());
  host->answer({{orders[0].client, orders[0].sequence, 1, 0}});
  std::map<std::uint32_t, CraterOutcome> outcomes;
  const auto heard = [&] {
    for (const CraterOutcome& outcome : client->takeCraterOutcomes()) outcomes[outcome.sequence] = outcome;
    return outcomes.size() == 2 && client->state().tick == 1;
  };
  ASSERT_EQ(updateUntil({client.get()}, heard), "");
  EXPECT_EQ(outcomes[first].tick, 1);
  EXPECT_EQ(outcomes[second].tick, 0);
  EXPECT_EQ(client->state().craters.size(), 1u);
  EXPECT_EQ(stateHash(client->state()), session.hash_at[1]);
}

TEST(Sockets, AClosedPortIsAnError) {
  std::uint16_t port = 0;
  {
    const auto taken = listenEnet(0, 1);
    ASSERT_TRUE(taken);
    port = taken->port;
  }
  const auto client = startClient(port, 0.3);
  EXPECT_EQ(updateUntil({client.get()}, [] { return false; }),
            "no answer from 127.0.0.1:" + std::to_string(port) + " within 0.3 s");
}

TEST(Sockets, ATakenPortIsAnError) {
  auto taken = listenEnet(0, 1);
  ASSERT_TRUE(taken);
  const auto again = listenEnet(taken->port, 1);
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error(), "cannot listen on UDP port " + std::to_string(taken->port) + ": the port is taken");
}

TEST(Sockets, AnUnknownHostIsAnError) {
  const auto client = ClientSession::start({"no such host", 1, "viewer", 1});
  ASSERT_FALSE(client);
  EXPECT_EQ(client.error(), "cannot resolve host 'no such host'");
}

TEST(Sockets, AnUnprintableNameIsAnError) {
  EXPECT_FALSE(ClientSession::start({"127.0.0.1", 1, "", 1}));
  EXPECT_FALSE(ClientSession::start({"127.0.0.1", 1, "a\nb", 1}));
}

/// A server in this thread, to be stopped at will.
struct HandServer {
  explicit HandServer(const ScriptedSession& session)
      : server(std::move(*listening)),
        book(std::make_unique<ClientBook>(*server.transport, session.pack, session.encoded_pack, BookOptions{})) {}

  Result<EnetServer> listening = listenEnet(0, 4);
  EnetServer server;
  std::unique_ptr<ClientBook> book;
};

TEST(Sockets, AServerThatFallsSilentIsAnError) {
  ScriptedSession session;
  HandServer hand(session);
  const auto client = startClient(hand.server.port, 0.7);
  ASSERT_EQ(updateUntil({client.get()}, [&] { return hand.book->serve(0, 0), client->inSync(); }), "");
  EXPECT_EQ(updateUntil({client.get()}, [] { return false; }),
            "server 127.0.0.1:" + std::to_string(hand.server.port) + " went away (no data for 0.7 s)");
}

TEST(Sockets, AServerThatClosesWithoutGoodbyeIsAnError) {
  ScriptedSession session;
  auto hand = std::make_unique<HandServer>(session);
  const std::string port = std::to_string(hand->server.port);
  const auto client = startClient(hand->server.port);
  ASSERT_EQ(updateUntil({client.get()}, [&] { return hand->book->serve(0, 0), client->inSync(); }), "");
  hand.reset();
  EXPECT_EQ(updateUntil({client.get()}, [] { return false; }),
            "connection closed by server 127.0.0.1:" + port + " without goodbye");
}

TEST(Sockets, AClientThatLeavesIsReported) {
  ScriptedSession session;
  const auto host = openHost(session);
  auto client = startClient(host->port());
  ASSERT_EQ(updateUntil({client.get()}, [&] { return host->clientsInSync() == 1; }), "");
  client.reset();
  ASSERT_EQ(updateUntil({}, [&] { return host->clientsInSync() == 0; }), "");
  const auto reports = host->finish(1);
  ASSERT_EQ(reports.size(), 1u);
  EXPECT_EQ(reports[0].left_because, "left");
  EXPECT_FALSE(reports[0].in_sync);
}

TEST(Sockets, AHostWithoutClientsFinishesAtOnce) {
  ScriptedSession session;
  const auto host = openHost(session);
  host->publish(session.step());
  const auto before = Clock::now();
  EXPECT_TRUE(host->finish(30).empty());
  EXPECT_LT(Clock::now() - before, std::chrono::seconds(5));
}

}  // namespace
}  // namespace spoor::test
