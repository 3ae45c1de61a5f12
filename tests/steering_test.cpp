// Parameters that change in a running session: at their tick, from the console, and those that cannot be.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <future>
#include <map>

#include "server/console.h"
#include "server/report.h"
#include "server/tick_loop.h"
#include "tests/scenes.h"

namespace spoor::test {
namespace {

/// A body that drives 30 cells across level ground, through its middle.
ScenePack drivePack(int width = 70, int height = 30) {
  ScenePack pack = flatPack(width, height);
  const int x_q = width * 500 - 15000, y_q = height * 500;
  addBody(pack, boxMesh(4000, 3000, 2000), x_q, y_q, 700);
  pack.paths[0] = {{{x_q, y_q}, {x_q + 30000, y_q}}, 1300, 0, 0};
  return pack;
}

ParameterChange changeOf(const std::string& text) {
  auto change = parseChange(text);
  EXPECT_TRUE(change) << change.error();
  return change ? std::move(*change) : ParameterChange{};
}

bool anyHas(const std::vector<std::string>& lines, const std::string& part) {
  return std::ranges::any_of(lines, [&](const std::string& line) { return line.find(part) != std::string::npos; });
}

/// A session run to its end.
struct Steered {
  std::vector<std::string> said;
  std::map<std::int32_t, Parameters> changes;  // as recorded
  Parameters parameters;                       // at the end
  std::uint64_t hash = 0;
  std::int32_t ticks = 0;
  LoopFigures figures;
};

Steered runSession(const World& world, LoopOptions options) {
  const auto path = std::filesystem::path(::testing::TempDir()) / ("spoor_steering_" + std::to_string(getpid()));
  Steered run;
  {
    auto writer = SessionWriter::create(path.string(), encodePack(world.pack));
    EXPECT_TRUE(writer) << writer.error();
    Simulation simulation = world.simulate();
    options.rate_hz = 0;
    run.figures = runTicks(simulation, world.base, options, nullptr, writer->get(),
                           [&](const std::string& line) { run.said.push_back(line); });
    EXPECT_TRUE((*writer)->close());
    run.parameters = simulation.state().parameters;
    run.hash = stateHash(simulation.state());
    run.ticks = simulation.state().tick;
  }
  auto reader = SessionReader::open(path.string());
  EXPECT_TRUE(reader) << reader.error();
  for (auto tick = (*reader)->next(); tick && *tick; tick = (*reader)->next())
    if ((*tick)->parameters) run.changes[(*tick)->tick] = *(*tick)->parameters;
  std::filesystem::remove(path);
  return run;
}

TEST(Steering, ChangesHoldFromTheirTickOn) {
  const World world(drivePack());
  const Steered plain = runSession(world, {.ticks = 20});
  const Steered run =
      runSession(world, {.ticks = 20,
                         .changes = {changeOf("12:capacityRounds=1"), changeOf("5:slopeThreshold=0.5,roughness=0.5"),
                                     changeOf("12:capacityRounds=3"), changeOf("30:capacityRounds=9")}});
  ASSERT_EQ(run.changes.size(), 2u);
  const Parameters& five = run.changes.at(5);
  EXPECT_EQ(five.materials[0].slope_threshold_q, 500);
  EXPECT_EQ(five.materials[0].roughness_q16, 32768);
  EXPECT_EQ(five.capacity_rounds, world.pack.parameters.capacity_rounds);
  EXPECT_EQ(run.changes.at(12).capacity_rounds, 3) << "of one tick, the last given counts";
  EXPECT_EQ(run.changes.at(12).materials[0].slope_threshold_q, 500) << "what was changed stays";
  EXPECT_EQ(run.parameters, run.changes.at(12));
  EXPECT_EQ(run.ticks, 20);
  EXPECT_NE(run.hash, plain.hash);
  EXPECT_TRUE(anyHas(run.said, "tick 5: roughness 1 -> 0.5, slopeThreshold ")) << run.said[0];
  EXPECT_TRUE(anyHas(run.said, "tick 12: capacityRounds 2 -> 3"));
}

TEST(Steering, WhatIsSoAlreadyIsNoChange) {
  const World world(drivePack());
  const Steered run = runSession(world, {.ticks = 8, .changes = {changeOf("3:capacityRounds=2")}});
  EXPECT_TRUE(run.changes.empty());
  EXPECT_EQ(run.hash, runSession(world, {.ticks = 8}).hash);
  EXPECT_TRUE(anyHas(run.said, "tick 3: the parameters are so already"));
}

TEST(Steering, WhatCannotBeChangesNothingAndTheSessionGoesOn) {
  const World world(drivePack(20000, 20000));
  const Steered run =
      runSession(world, {.ticks = 8,
                         .changes = {changeOf("2:activeAreas=false"), changeOf("3:activeAreaMargin=409.6"),
                                     changeOf("4:jumpFloodingVariant=JFA")}});
  EXPECT_EQ(run.ticks, 8);
  EXPECT_TRUE(run.changes.empty());
  EXPECT_EQ(run.hash, runSession(world, {.ticks = 8}).hash);
  EXPECT_TRUE(anyHas(run.said, "tick 2: parameters: active_areas is 0 in a world of 20000 x 20000 cells"));
  EXPECT_TRUE(
      anyHas(run.said, "tick 3: the parameters stay as they were: bodies and craters meet 1"));  // .. tens of thousands
  EXPECT_TRUE(anyHas(run.said, "tick 4: jumpFloodingVariant: goes with nearest = jump_flooding"));
}

TEST(Steering, TheConsolesChangesComeWithTheNextTick) {
  const World world(drivePack());
  ChangeQueue queue;
  ASSERT_TRUE(queue.push({0, *parseAssignments("roughness=0.25")}));
  ASSERT_TRUE(queue.push({0, *parseAssignments("compression=0.5,roughness=0.75")}));
  const Steered run =
      runSession(world, {.ticks = 8, .changes = {changeOf("1:roughness=0.5,spreadCells=3")}, .console = &queue});
  ASSERT_EQ(run.changes.size(), 1u);
  EXPECT_EQ(run.changes.at(1).materials[0].roughness_q16, 49152);
  EXPECT_EQ(run.changes.at(1).materials[0].compression_q16, 32768);
  EXPECT_EQ(run.changes.at(1).spread_cells, 3);
  EXPECT_TRUE(queue.tryTake().empty());
}

TEST(Steering, AFullQueueTakesNoMore) {
  ChangeQueue queue;
  for (std::size_t i = 0; i < ChangeQueue::kLimit; ++i) EXPECT_TRUE(queue.push({}));
  EXPECT_FALSE(queue.push({}));
  EXPECT_EQ(queue.tryTake().size(), ChangeQueue::kLimit);
  EXPECT_TRUE(queue.push({}));
}

/// The native backend, which from its second tick on says that it kept soil back.
class Withholding final : public Backend {
 public:
  std::string name() const override { return inner_->name(); }
  std::string renderer() const override { return inner_->renderer(); }
  Status submit(TickPlan plan, const BaseTerrain& base, const WorldState& state) override {
    return inner_->submit(std::move(plan), base, state);
  }
  Result<TickEffect> settle(WorldState& state) override {
    auto effect = inner_->settle(state);
    if (effect) effect->kept_back = std::exchange(kept_back_, kept_back_ + 100);
    return effect;
  }
  Status collect(WorldState& state, std::vector<TileChange>& changes) override {
    return inner_->collect(state, changes);
  }
  void tilesChanged(std::span<Tile* const> tiles) override { inner_->tilesChanged(tiles); }
  void forget() override { inner_->forget(); }
  BackendMemory memory() const override { return inner_->memory(); }

 private:
  std::unique_ptr<Backend> inner_ = makeNativeBackend({.thread_count = 1});
  std::int64_t kept_back_ = 0;
};

TEST(Steering, SoilThatIsKeptBackIsSaidOnceAndCounted) {
  const World world(drivePack());
  Simulation simulation(world.base, world.id, std::make_unique<Withholding>());
  std::vector<std::string> said;
  SessionReport report;
  report.figures = runTicks(simulation, world.base, {.ticks = 4, .rate_hz = 0}, nullptr, nullptr,
                            [&](const std::string& line) { said.push_back(line); });
  EXPECT_EQ(std::ranges::count_if(said, [](const auto& line) { return line.find("no room") != line.npos; }), 1);
  EXPECT_TRUE(anyHas(said, "tick 2: 100 units of soil")) << said[0];
  EXPECT_EQ(report.figures.kept_back, 600);
  EXPECT_NE(tableOf(report).find("kept back              600 units"), std::string::npos) << tableOf(report);
  EXPECT_NE(jsonOf(report).text().find("\"kept_back\": 600"), std::string::npos);
}

TEST(Steering, ChangesAsTextSayWhatIsWrong) {
  const struct {
    const char *text, *part;
  } wrong[] = {
      {"", "does not begin with a tick"},
      {"roughness=1", "does not begin with a tick"},
      {"0:roughness=1", "does not begin with a tick"},
      {"-4:roughness=1", "does not begin with a tick"},
      {"4", "does not begin with a tick"},
      {"4 :roughness=1", "does not begin with a tick"},
      {"99999999999:roughness=1", "does not begin with a tick"},
      {"4:", "'' is not NAME=VALUE"},
      {"4:roughness=1,", "'' is not NAME=VALUE"},
      {"4:roughness=1,roughness=1", "given twice"},
      {"4:terrainSize=4", "it shapes the world"},
      {"4:numVerticesPerRow=4", "as clients draw it"},
  };
  for (const auto& [text, part] : wrong) {
    const auto change = parseChange(text);
    ASSERT_FALSE(change) << text;
    EXPECT_NE(change.error().find(part), std::string::npos) << change.error();
  }
}

/// A console on a pipe.
class ConsoleOnPipe : public ::testing::Test {
 protected:
  void SetUp() override { ASSERT_EQ(::pipe(pipe_), 0); }
  void TearDown() override {
    ::close(pipe_[0]);
    if (pipe_[1] >= 0) ::close(pipe_[1]);
  }
  /// What the console says to an input, which comes in pieces, and ends.
  std::vector<std::string> answerTo(const std::vector<std::string>& pieces) {
    std::vector<std::string> said;
    std::promise<void> ended;
    const Console console(pipe_[0], queue_, craters_, snowfalls_, [&](const std::string& line) {
      said.push_back(line);
      if (line == "console: the input has ended") ended.set_value();
    });
    for (const std::string& piece : pieces) EXPECT_EQ(::write(pipe_[1], piece.data(), piece.size()), piece.size());
    ::close(std::exchange(pipe_[1], -1));
    EXPECT_EQ(ended.get_future().wait_for(std::chrono::seconds(60)), std::future_status::ready);
    return said;
  }

  int pipe_[2] = {-1, -1};
  ChangeQueue queue_;
  CraterQueue craters_;
  SnowfallQueue snowfalls_;
};

TEST_F(ConsoleOnPipe, LinesBecomeChangesHoweverTheyArrive) {
  const auto said =
      answerTo({"rough", "ness=0.25\n\n  \r\ncompression=0.5, spreadCells=4\r\n", "capacityRounds=", "2"});
  EXPECT_EQ(said.size(), 1u);
  const auto changes = queue_.tryTake();
  ASSERT_EQ(changes.size(), 3u);
  EXPECT_EQ(changes[0].tick, 0);
  EXPECT_EQ(changes[0].values[0].parameter->name, "roughness");
  EXPECT_EQ(changes[0].values[0].value, 0.25);
  ASSERT_EQ(changes[1].values.size(), 2u);
  EXPECT_EQ(changes[1].values[1].value, 4);
  EXPECT_EQ(changes[2].values[0].value, 2) << "the last line needs no end";
}

TEST_F(ConsoleOnPipe, CratersAreQueuedAndBadOnesSaid) {
  const auto said =
      answerTo({"crater 1,2,0.5,1,0.3\n", "  crater 1,2,0.5\ncrater\nroughness=0.5\ncrater 3,2,0.5,1,0.3,0.1,0.2"});
  ASSERT_EQ(said.size(), 3u);
  EXPECT_EQ(said[0], "console: crater: '1,2,0.5' is not X,Y,R1,R2,D5[,H4|balanced][,NOISE]; there is none");
  EXPECT_EQ(said[1], "console: 'crater' is not NAME=VALUE; nothing changes");
  const auto craters = craters_.tryTake();
  ASSERT_EQ(craters.size(), 2u);
  EXPECT_TRUE(craters[0].balanced);
  EXPECT_EQ(craters[1].crater.rim_height_q, 1000);
  EXPECT_EQ(queue_.tryTake().size(), 1u);
}

TEST_F(ConsoleOnPipe, SnowfallsAreQueuedAndBadOnesSaid) {
  const auto said =
      answerTo({"snow 0,1,5,6,36000,2\n", " snow 1,2,3,4,5\nsnow 0,0,1,1,1,1,9\nsnow\nsnow 0,0,1,1,nan,1\n"});
  ASSERT_EQ(said.size(), 4u);
  EXPECT_EQ(said[0], "console: snow: '1,2,3,4,5' is not X0,Y0,X1,Y1,MM_PER_HOUR,SECONDS[,SEED]; there is none");
  EXPECT_EQ(said[1], "console: 'snow' is not NAME=VALUE; nothing changes");
  EXPECT_NE(said[2].find("MM_PER_HOUR: 'nan' is not a number within"), std::string::npos);
  const auto snowfalls = snowfalls_.tryTake();
  ASSERT_EQ(snowfalls.size(), 2u);
  EXPECT_EQ(snowfalls[0], (SnowfallWish{{0, 1, 5, 6}, 36000, 2, {}}));
  EXPECT_EQ(snowfalls[1].seed, 9u);
}

TEST_F(ConsoleOnPipe, BadLinesAreSaidAndChangeNothing) {
  const auto said =
      answerTo({"hello\nroughness=7\nterrainSize=3\n" + std::string(1, '\0') + "\n",
                std::string(Console::kLineLimit + 1, 'x') + "=1\n", "roughness=0.5\n", std::string(20000, 'y')});
  ASSERT_EQ(said.size(), 7u);
  EXPECT_EQ(said[0], "console: 'hello' is not NAME=VALUE; nothing changes");
  EXPECT_EQ(said[1], "console: roughness: '7' is not a number within 0 .. 1; nothing changes");
  EXPECT_NE(said[2].find("terrainSize: cannot change"), std::string::npos);
  EXPECT_EQ(said[3], "console: '?' is not NAME=VALUE; nothing changes");
  EXPECT_EQ(said[4], "console: a line of more than 4096 bytes; nothing changes");
  EXPECT_EQ(said[5], said[4]);
  EXPECT_EQ(queue_.tryTake().size(), 1u) << "the good one among them";
}

TEST_F(ConsoleOnPipe, EndsWhileItsInputStaysOpen) {
  std::vector<std::string> said;
  {
    const Console console(pipe_[0], queue_, craters_, snowfalls_,
                          [&](const std::string& line) { said.push_back(line); });
  }
  EXPECT_TRUE(said.empty());
}

}  // namespace
}  // namespace spoor::test
