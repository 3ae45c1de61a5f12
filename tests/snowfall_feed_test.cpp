// Snowfalls as text, and on their way from command line and console into a session's ticks and its file.
#include "server/snowfall_feed.h"

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

/// A body that drives across level ground of 16 x 8 m.
ScenePack drivePack() {
  ScenePack pack = flatPack(160, 80);
  addBody(pack, boxMesh(4000, 3000, 2000), 20000, 40000, 700);
  pack.paths[0] = {{{20000, 40000}, {50000, 40000}}, 1300, 0, 0};
  return pack;
}

TEST(SnowfallText, IsReadIntoPeoplesUnits) {
  const auto wish = parseSnowfall(" 0,-1.5, 1e2,4,36000 ,2.5,4294967295");
  ASSERT_TRUE(wish) << wish.error();
  EXPECT_EQ(*wish, (SnowfallWish{{0, -1.5, 100, 4}, 36000, 2.5, 4294967295u}));
  const auto timed = parseTimedSnowfall("40:0,0,1,1,1,1");
  ASSERT_TRUE(timed) << timed.error();
  EXPECT_EQ(timed->tick, 40);
  EXPECT_FALSE(timed->wish.seed);
}

TEST(SnowfallText, SaysWhatIsWrong) {
  const struct {
    std::string text;
    const char* part;
  } wrong[] = {
      {"", "does not begin with a tick"},
      {"0,0,1,1,1,1", "does not begin with a tick"},
      {"0:0,0,1,1,1,1", "does not begin with a tick"},
      {"-3:0,0,1,1,1,1", "does not begin with a tick"},
      {"99999999999:0,0,1,1,1,1", "does not begin with a tick"},
      {"4", "does not begin with a tick"},
      {"4:", "'' is not X0,Y0,X1,Y1,MM_PER_HOUR,SECONDS[,SEED]"},
      {"4:0,0,1,1,1", "is not X0,Y0,X1,Y1,MM_PER_HOUR,SECONDS[,SEED]"},
      {"4:0,0,1,1,1,1,1,1", "has more than 7 fields"},
      {"4:" + std::string(100000, ','), "has more than 7 fields"},
      {"4:x,0,1,1,1,1", "X0: 'x' is not a number within -210000 .. 210000 m"},
      {"4:0,,1,1,1,1", "Y0: '' is not"},
      {"4:0,0,inf,1,1,1", "X1: 'inf' is not"},
      {"4:0,0,1,210001,1,1", "Y1: '210001' is not"},
      {"4:0,0,1,1,-1,1", "MM_PER_HOUR: '-1' is not"},
      {"4:0,0,1,1,nan,1", "MM_PER_HOUR: 'nan' is not"},
      {"4:0,0,1,1,1,1s", "SECONDS: '1s' is not"},
      {"4:0,0,1,1,1,1,-1", "SEED: '-1' is not a whole number within 0 .. 4294967295"},
      {"4:0,0,1,1,1,1,4294967296", "SEED: '4294967296' is not"},
      {"4:0,0,1,1,1,1,\x1b[31m", "SEED: '?[31m' is not"},
  };
  for (const auto& [text, part] : wrong) {
    const auto timed = parseTimedSnowfall(text);
    ASSERT_FALSE(timed) << text;
    EXPECT_NE(timed.error().find(part), std::string::npos) << timed.error();
    EXPECT_LT(timed.error().size(), 200u);
  }
}

TEST(SnowfallText, BecomesCellsTicksAndARate) {
  const ScenePack pack = drivePack();  // cells of 0.1 m, 60 ticks a second
  const auto snowfall = resolveSnowfall(pack, {{1.04, -5, 3.06, 90}, 36000, 2, 7}, 11);
  ASSERT_TRUE(snowfall) << snowfall.error();
  EXPECT_EQ(snowfall->area, (CellBox{10, 0, 31, 80}));
  EXPECT_EQ(snowfall->rate_q32, 7158278827);  // 36 m an hour are 100 units a second: 100 / 60 * 2^32
  EXPECT_EQ(snowfall->first_tick, 11);
  EXPECT_EQ(snowfall->last_tick, 130);
  EXPECT_EQ(snowfall->seed, 7u);
  EXPECT_EQ(describeSnowfall(pack, *snowfall), "(1, 0) to (3.1, 8) m, 36000 mm per hour, ticks 11 .. 130, seed 7");
  const auto drawn = resolveSnowfall(pack, {{0, 0, 1, 1}, 1, 0, {}}, 3);
  ASSERT_TRUE(drawn) << drawn.error();
  EXPECT_EQ(drawn->last_tick, 3) << "a tick at least";
  EXPECT_NE(drawn->seed, resolveSnowfall(pack, {{0, 0, 1, 1}, 1, 0, {}}, 4)->seed);
  EXPECT_EQ(drawn->seed, resolveSnowfall(pack, {{0, 0, 1, 1}, 1, 0, {}}, 3)->seed);
}

TEST(SnowfallText, WhatNoSessionTakesIsRefused) {
  const ScenePack pack = drivePack();
  const auto refused = [&](const SnowfallWish& wish, std::int32_t tick = 1) {
    const auto snowfall = resolveSnowfall(pack, wish, tick);
    return snowfall ? std::string("taken") : snowfall.error();
  };
  EXPECT_EQ(refused({{0, 0, 16, 8}, 1, 1, {}}), "taken");
  EXPECT_EQ(refused({{16, 0, 20, 8}, 1, 1, {}}), "area: it holds no cell of the world");
  EXPECT_EQ(refused({{3, 2, 2, 5}, 1, 1, {}}), "area: it holds no cell of the world");
  EXPECT_EQ(refused({{0, 0, 1, 1}, 0, 1, {}}), "rate: 0 mm per hour are not more than 0 and at most 88473600");
  EXPECT_EQ(refused({{0, 0, 1, 1}, 88473600, 1, {}}), "taken");
  EXPECT_EQ(refused({{0, 0, 1, 1}, 88473601, 1, {}}),
            "rate: 88473601 mm per hour are not more than 0 and at most 88473600");
  EXPECT_EQ(refused({{0, 0, 1, 1}, 88473600, 60, {}}), "rate: too much in all; the limit is 8388608 units of 0.1 mm");
  EXPECT_EQ(refused({{0, 0, 1, 1}, 1e-9, 1e8, {}}), "duration: 100000000 s are not within 0 .. 2^30 ticks");
}

struct Ran {
  std::vector<std::string> said;
  LoopFigures figures;
  std::vector<Snowfall> snowfalls;
  std::map<std::int32_t, std::vector<Snowfall>> recorded;
  std::uint64_t hash = 0, replayed = 0;
};

/// Runs a session, reads its file and runs that again.
Ran runOn(const World& world, LoopOptions options) {
  const auto path = std::filesystem::path(::testing::TempDir()) / ("spoor_snow_" + std::to_string(getpid()));
  Ran ran;
  {
    auto writer = SessionWriter::create(path.string(), encodePack(world.pack));
    EXPECT_TRUE(writer) << writer.error();
    Simulation simulation = world.simulate();
    options.rate_hz = 0;
    ran.figures = runTicks(simulation, world.base, options, nullptr, writer->get(),
                           [&](const std::string& line) { ran.said.push_back(line); });
    EXPECT_TRUE((*writer)->close());
    ran.snowfalls = simulation.state().snowfalls;
    ran.hash = stateHash(simulation.state());
    EXPECT_EQ(simulation.state().ledger.error(), 0);
    EXPECT_TRUE(recount(simulation.state()));
  }
  auto reader = SessionReader::open(path.string());
  EXPECT_TRUE(reader) << reader.error();
  Simulation again = world.simulate();
  for (auto tick = (*reader)->next(); tick && *tick; tick = (*reader)->next()) {
    const TickRecord& record = **tick;
    if (!record.snowfalls.empty()) ran.recorded[record.tick] = record.snowfalls;
    const auto result = again.step(record.poses, record.parameters, record.craters, record.snowfalls);
    EXPECT_TRUE(result) << result.error();
    EXPECT_EQ(result->update.state_hash, record.state_hash) << "tick " << record.tick;
    EXPECT_EQ(result->ledger, record.ledger);
  }
  ran.replayed = stateHash(again.state());
  std::filesystem::remove(path);
  return ran;
}

TEST(SnowfallFeed, ThoseOfCommandLineAndConsoleAreRecordedAndReplayed) {
  ScenePack pack = drivePack();
  pack.snowfalls = {{{0, 0, 40, 40}, std::int64_t(1) << 32, 5, 50, 3}};
  const World world(pack);
  SnowfallQueue console;
  ASSERT_TRUE(console.push({{0, 0, 16, 8}, 36000, 0.5, 1}));
  const Ran ran = runOn(world, {.ticks = 60,
                                .snowfalls = {{20, {{2, 2, 9, 6}, 90000, 0.25, 4}}, {70, {{0, 0, 1, 1}, 1, 1, 5}}},
                                .console_snowfalls = &console});
  ASSERT_EQ(ran.snowfalls.size(), 3u);
  EXPECT_EQ(ran.snowfalls[0], pack.snowfalls[0]);
  EXPECT_EQ(ran.recorded.size(), 2u) << "the scene's are in the pack";
  EXPECT_EQ(ran.recorded.at(1), std::vector<Snowfall>{ran.snowfalls[1]});
  EXPECT_EQ(ran.recorded.at(20), std::vector<Snowfall>{ran.snowfalls[2]});
  EXPECT_EQ(ran.snowfalls[2].first_tick, 20);
  EXPECT_EQ(ran.snowfalls[2].last_tick, 34);
  EXPECT_EQ(ran.replayed, ran.hash);
  EXPECT_NE(ran.hash, runOn(world, {.ticks = 60}).hash);
  EXPECT_TRUE(anyHas(ran.said, "tick 20: snowfall on (2, 2) to (9, 6) m, 90000 mm per hour, ticks 20 .. 34, seed 4"));
  SessionReport report;
  report.figures = ran.figures;
  EXPECT_NE(tableOf(report).find("snowfalls              2 besides the scene's; 0 left out"), std::string::npos);
  EXPECT_NE(jsonOf(report).text().find("\"snowfall_count\": 2"), std::string::npos);
}

TEST(SnowfallFeed, WhatCannotBeIsSaidAndTheSessionGoesOn) {
  const World world(drivePack());
  SnowfallQueue console;
  ASSERT_TRUE(console.push({{900, 0, 901, 1}, 1, 1, {}}));
  LoopOptions options{.ticks = 8, .console_snowfalls = &console};
  for (std::size_t i = 0; i <= kSnowfallsLimit; ++i) options.snowfalls.push_back({2, {{0, 0, 1, 1}, 1, 1, {}}});
  const Ran ran = runOn(world, options);
  EXPECT_EQ(ran.snowfalls.size(), kSnowfallsLimit);
  EXPECT_EQ(ran.figures.snowfalls, std::int64_t(kSnowfallsLimit));
  EXPECT_EQ(ran.figures.snowfalls_refused, 2);
  EXPECT_TRUE(anyHas(ran.said, "tick 1: snowfall: area: it holds no cell of the world; there is none"));
  EXPECT_TRUE(anyHas(ran.said, "tick 2: snowfall: a session has 64 of them at most; there is none"));
  EXPECT_EQ(ran.replayed, ran.hash);
}

}  // namespace
}  // namespace spoor::test
