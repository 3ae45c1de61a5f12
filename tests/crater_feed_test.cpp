// Craters of the scene, the command line, the console and the clients on their way into a session's ticks.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "server/report.h"
#include "server/tick_loop.h"
#include "tests/scenes.h"

namespace spoor::test {
namespace {

bool anyHas(const std::vector<std::string>& lines, const std::string& part) {
  return std::ranges::any_of(lines, [&](const std::string& line) { return line.find(part) != std::string::npos; });
}

Crater craterAt(std::int32_t x_q, std::int32_t y_q, std::int32_t depth_q = 3000) {
  Crater crater;
  crater.x_q = x_q;
  crater.y_q = y_q;
  crater.inner_radius_q = 4000;
  crater.crest_radius_q = 8000;
  crater.rim_height_q = 500;
  crater.depth_q = depth_q;
  return crater;
}

/// A body that drives across level ground of 8 x 4 m, and craters of the scene at ticks 3 (two) and 6.
ScenePack cratersPack() {
  ScenePack pack = flatPack(80, 40);
  addBody(pack, boxMesh(4000, 3000, 2000), 20000, 20000, 700);
  pack.paths[0] = {{{20000, 20000}, {50000, 20000}}, 1300, 0, 0};
  pack.crater_limits.radius_q = 20000;
  pack.craters = {craterAt(30000, 20000), craterAt(36000, 22000), craterAt(60000, 10000)};
  pack.craters[0].tick = pack.craters[1].tick = 3;
  pack.craters[2].tick = 6;
  for (std::uint32_t id = 0; id < 3; ++id) pack.craters[id].id = id;
  return pack;
}

/// Clients without a network.
class FakeHost final : public SessionHost {
 public:
  std::uint16_t port() const override { return 0; }
  void publish(TickUpdate update) override { updates.push_back(std::move(update)); }
  std::vector<CraterOrder> tryTakeCraters() override {
    const auto due = std::exchange(orders[taken_++], {});
    return due;
  }
  void answer(std::vector<CraterAnswer> more) override {
    for (const CraterAnswer& one : more)
      EXPECT_TRUE(one.tick == 0 || one.tick == std::int32_t(updates.size())) << "answered before it was published";
    answers.insert(answers.end(), more.begin(), more.end());
  }
  int clientsInSync() const override { return 0; }
  std::vector<ClientReport> finish(double) override { return {}; }

  std::map<int, std::vector<CraterOrder>> orders;  // by how often tryTakeCraters was called before
  std::vector<TickUpdate> updates;
  std::vector<CraterAnswer> answers;

 private:
  int taken_ = 0;
};

struct Ran {
  std::vector<std::string> said;
  LoopFigures figures;
  std::vector<Crater> craters;
  std::uint64_t hash = 0;
  std::int32_t ticks = 0;
};

Ran runOn(const World& world, LoopOptions options, SessionHost* host = nullptr, SessionWriter* writer = nullptr) {
  Ran ran;
  Simulation simulation = world.simulate();
  options.rate_hz = 0;
  ran.figures = runTicks(simulation, world.base, options, host, writer,
                         [&](const std::string& line) { ran.said.push_back(line); });
  const auto records = simulation.state().craters.records();
  ran.craters.assign(records.begin(), records.end());
  ran.hash = stateHash(simulation.state());
  ran.ticks = simulation.state().tick;
  EXPECT_EQ(simulation.state().ledger.error(), 0);
  EXPECT_TRUE(recount(simulation.state()));
  return ran;
}

TEST(CraterFeed, TheScenesCratersComeAtTheirTicks) {
  const World world(cratersPack());
  FakeHost host;
  const Ran ran = runOn(world, {.ticks = 10}, &host);
  EXPECT_EQ(ran.craters, world.pack.craters);
  EXPECT_EQ(ran.figures.craters, 3);
  EXPECT_EQ(ran.figures.craters_refused, 0);
  EXPECT_EQ(ran.figures.unbalanced_ticks, 0);
  ASSERT_EQ(host.updates.size(), 10u);
  for (const TickUpdate& update : host.updates)
    EXPECT_EQ(update.craters.size(), update.tick == 3 ? 2u : update.tick == 6 ? 1u : 0u) << update.tick;
  SessionReport report;
  report.figures = ran.figures;
  EXPECT_NE(tableOf(report).find("craters                3; 0 left out"), std::string::npos) << tableOf(report);
  EXPECT_NE(jsonOf(report).text().find("\"crater_count\": 3"), std::string::npos);
}

TEST(CraterFeed, OfOneTickTheOrderIsSceneCommandLineConsoleClients) {
  const World world(cratersPack());
  CraterQueue console;
  ASSERT_TRUE(console.push({craterAt(41000, 10000), false}));
  FakeHost host;
  // Both of tick 1, in the order of arrival.
  host.orders[0] = {{2, 1, craterAt(45000, 10000)}, {0, 9, craterAt(43000, 10000)}, {2, 0, craterAt(44000, 10000)}};
  host.orders[2] = {{0, 10, craterAt(46000, 10000)}};
  const Ran ran =
      runOn(world, {.ticks = 4, .craters = {{1, {craterAt(40000, 10000), false}}}, .console_craters = &console}, &host);
  std::vector<std::int32_t> x_q;
  for (const Crater& crater : ran.craters) x_q.push_back(crater.x_q);
  EXPECT_EQ(x_q, (std::vector<std::int32_t>{40000, 41000, 43000, 44000, 45000, 30000, 36000, 46000}));
  ASSERT_EQ(host.answers.size(), 4u);
  EXPECT_EQ(host.answers[0].sequence, 9u);
  EXPECT_EQ(host.answers[0].id, 2u);
  EXPECT_EQ(host.answers[0].tick, 1);
  EXPECT_EQ(host.answers[3].sequence, 10u);
  EXPECT_EQ(host.answers[3].id, 7u);
  EXPECT_EQ(host.answers[3].tick, 3);
  EXPECT_TRUE(anyHas(ran.said, "tick 1: crater 0 at (4, 1) m, R1 0.4 m, R2 0.8 m, D5 0.3 m, H4 0.05 m"));
  EXPECT_TRUE(anyHas(ran.said, "tick 3: crater 7 at (4.6, 1) m")) << "asked for";
  EXPECT_TRUE(anyHas(ran.said, "asked for by client 0"));
}

TEST(CraterFeed, TheOrderOfArrivalDoesNotShow) {
  const World world(cratersPack());
  const std::vector<CraterOrder> orders = {
      {0, 4, craterAt(30000, 20000, 2000)}, {0, 5, craterAt(31000, 20000, 2500)}, {1, 1, craterAt(30000, 21000, 1500)}};
  FakeHost there, back;
  there.orders[4] = orders;
  back.orders[4] = {orders[2], orders[1], orders[0]};
  const Ran first = runOn(world, {.ticks = 12}, &there), second = runOn(world, {.ticks = 12}, &back);
  EXPECT_EQ(first.hash, second.hash);
  EXPECT_EQ(first.craters, second.craters);
}

TEST(CraterFeed, WishesThatCannotBeAreSaidAndCounted) {
  const World world(cratersPack());
  CraterQueue console;
  ASSERT_TRUE(console.push({craterAt(900000, 10000), false}));
  ASSERT_TRUE(console.push({craterAt(30000, 10000), false}));
  CraterWish large{craterAt(30000, 10000), true};
  large.crater.crest_radius_q = 30000;
  const Ran ran = runOn(world, {.ticks = 4, .craters = {{2, large}}, .console_craters = &console});
  EXPECT_EQ(ran.craters.size(), 3u);
  EXPECT_EQ(ran.figures.craters_refused, 2);
  EXPECT_TRUE(anyHas(ran.said, "tick 1: crater: all of it lies off the map"));
  EXPECT_TRUE(anyHas(ran.said, "tick 2: crater: R3 = 2 R2 - R1 is 5.6 m, the scene allows 2 m; there is none"));
}

/// As many orders as one tick takes with nothing else in it.
std::vector<CraterOrder> fullTick() {
  std::vector<CraterOrder> orders(kTickCratersLimit, {5, 0, craterAt(-9000, 10000)});
  for (std::size_t i = 0; i < orders.size(); ++i) orders[i].sequence = std::uint32_t(i);
  return orders;
}

TEST(CraterFeed, WhatATickCannotTakeIsLeftOutAndTheScenesStay) {
  const World world(cratersPack());
  FakeHost host;
  host.orders[2] = fullTick();  // and two of the scene's
  const Ran ran = runOn(world, {.ticks = 8}, &host);
  EXPECT_EQ(ran.ticks, 8);
  EXPECT_EQ(ran.craters, world.pack.craters);
  EXPECT_EQ(ran.figures.craters_refused, std::int64_t(kTickCratersLimit));
  ASSERT_EQ(host.answers.size(), kTickCratersLimit);
  EXPECT_EQ(host.answers[7].tick, 0);
  EXPECT_EQ(host.answers[7].reason, "65538 craters in one tick, the limit is 65536");
  EXPECT_TRUE(
      anyHas(ran.said, "tick 3: 65536 craters, 0 of them the scene's, are left out: 65538 craters in one tick"));
}

TEST(CraterFeed, AChangeOfParametersOutlivesCratersThatCannotCome) {
  const World world(cratersPack());
  FakeHost host;
  host.orders[2] = fullTick();
  auto change = parseChange("3:roughness=0.5");
  ASSERT_TRUE(change) << change.error();
  const Ran ran = runOn(world, {.ticks = 8, .changes = {*change}}, &host);
  EXPECT_TRUE(anyHas(ran.said, "tick 3: roughness 1 -> 0.5"));
  EXPECT_FALSE(anyHas(ran.said, "the parameters stay as they were"));
  EXPECT_EQ(ran.craters.size(), 3u);
}

TEST(CraterFeed, ParametersThatCannotBeDoNotCostTheCraters) {
  ScenePack pack = flatPack(20000, 20000);
  addBody(pack, boxMesh(4000, 3000, 2000), 10000000, 10000000, 700);
  pack.paths[0] = {{{10000000, 10000000}, {10030000, 10000000}}, 1300, 0, 0};
  pack.crater_limits.radius_q = 20000;
  pack.craters = {craterAt(10000000, 10000000)};
  pack.craters[0].tick = 3;
  const World world(pack);
  auto change = parseChange("3:activeAreaMargin=409.6");
  ASSERT_TRUE(change) << change.error();
  FakeHost host;
  host.orders[2] = {{0, 1, craterAt(10001000, 10000000)}};
  const Ran ran = runOn(world, {.ticks = 5, .changes = {*change}}, &host);
  EXPECT_TRUE(anyHas(ran.said, "tick 3: the parameters stay as they were: "));
  EXPECT_EQ(ran.craters.size(), 2u);
  EXPECT_EQ(ran.figures.craters_refused, 0);
}

TEST(CraterFeed, ARecordedSessionNeedsNothingElse) {
  const World world(cratersPack());
  const auto path = std::filesystem::path(::testing::TempDir()) / ("spoor_craters_" + std::to_string(getpid()));
  FakeHost host;
  host.orders[4] = {{0, 1, craterAt(33000, 21000)}};
  Ran ran;
  {
    auto writer = SessionWriter::create(path.string(), encodePack(world.pack));
    ASSERT_TRUE(writer) << writer.error();
    ran = runOn(world, {.ticks = 12}, &host, writer->get());
    ASSERT_TRUE((*writer)->close());
  }
  ASSERT_EQ(ran.craters.size(), 4u);
  auto reader = SessionReader::open(path.string());
  ASSERT_TRUE(reader) << reader.error();
  Simulation replay = world.simulate();
  for (auto tick = (*reader)->next(); tick && *tick; tick = (*reader)->next()) {
    const auto result = replay.step((*tick)->poses, (*tick)->parameters, (*tick)->craters);
    ASSERT_TRUE(result) << result.error();
    EXPECT_EQ(result->update.state_hash, (*tick)->state_hash) << (*tick)->tick;
    EXPECT_EQ(result->ledger, (*tick)->ledger);
  }
  EXPECT_EQ(replay.state().tick, 12);
  EXPECT_EQ(stateHash(replay.state()), ran.hash);
  std::filesystem::remove(path);
}

TEST(CraterText, IsReadInMetres) {
  const auto wish = parseCrater(" 1.5, -2 ,0.1,0.25,0.3,0.05,0.5");
  ASSERT_TRUE(wish) << wish.error();
  EXPECT_EQ(wish->crater.x_q, 15000);
  EXPECT_EQ(wish->crater.y_q, -20000);
  EXPECT_EQ(wish->crater.inner_radius_q, 1000);
  EXPECT_EQ(wish->crater.crest_radius_q, 2500);
  EXPECT_EQ(wish->crater.depth_q, 3000);
  EXPECT_EQ(wish->crater.rim_height_q, 500);
  EXPECT_EQ(wish->crater.noise_q16, 32768);
  EXPECT_FALSE(wish->balanced);
  EXPECT_TRUE(parseCrater("1,2,3,4,5")->balanced);
  EXPECT_TRUE(parseCrater("1,2,3,4,5,balanced,1")->balanced);
  EXPECT_EQ(parseCrater("1,2,3,4,5,balanced,1")->crater.noise_q16, 65535);
  EXPECT_NE(parseCrater("1,2,3,4,5")->crater.noise_seed, parseCrater("1,2.0001,3,4,5")->crater.noise_seed);
  const auto timed = parseTimedCrater("120:1,2,3,4,5");
  ASSERT_TRUE(timed) << timed.error();
  EXPECT_EQ(timed->tick, 120);
}

TEST(CraterText, SaysWhatIsWrong) {
  const struct {
    const char *text, *part;
  } wrong[] = {
      {"", "does not begin with a tick"},
      {"1,2,3,4,5", "does not begin with a tick"},
      {"0:1,2,3,4,5", "does not begin with a tick"},
      {"99999999999:1,2,3,4,5", "does not begin with a tick"},
      {"5:", "'' is not X,Y,R1,R2,D5[,H4|balanced][,NOISE]"},
      {"5:1,2,3,4", "is not X,Y,R1,R2,D5"},
      {"5:1,2,3,4,5,6,0.5,8", "has more than 7 fields"},
      {"5:1,two,3,4,5", "Y: 'two' is not a number of metres"},
      {"5:1,2,3,4 m,5", "R2: '4 m' is not a number of metres"},
      {"5:1,2,nan,4,5", "R1: 'nan' is not a number of metres"},
      {"5:1e300,2,3,4,5", "X: '1e300' is not a number of metres"},
      {"5:1,2,3,4,5,flat", "H4: 'flat' is not a number of metres"},
      {"5:1,2,3,4,5,balanced,1.5", "NOISE: '1.5' is not a number within 0 .. 1"},
  };
  for (const auto& [text, part] : wrong) {
    const auto timed = parseTimedCrater(text);
    ASSERT_FALSE(timed) << text;
    EXPECT_NE(timed.error().find(part), std::string::npos) << timed.error();
  }
}

}  // namespace
}  // namespace spoor::test
