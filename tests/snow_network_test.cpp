// Clients that follow a real session with materials, drift, a body that grows, and snow, over a bad line.
#include <gtest/gtest.h>

#include "shared/world/script.h"
#include "tests/network_rig.h"

namespace spoor::test {
namespace {

MaterialRules rulesOf(std::int32_t threshold_q, std::int32_t diffusion_q16) {
  MaterialRules rules;
  rules.slope_threshold_q = threshold_q;
  rules.diagonal_threshold_q = threshold_q * 3 / 2;
  rules.compression_q16 = 20000;
  rules.diffusion_q16 = diffusion_q16;
  rules.friction_inverse_q32 = 1 << 21;
  return rules;
}

/// 20 x 15 m of rolling ground, two materials by height, a body that pushes and grows, and snow on a part of it.
ScenePack snowPack() {
  ScenePack pack = noisePack(200, 150, 7, -20000, 20000, 100000);
  pack.materials = {{"mud", {80, 60, 40}, MaterialTexture::mud}, {"sand", {220, 190, 140}, MaterialTexture::sand}};
  pack.material_map.kind = MaterialMapKind::rules;
  pack.material_map.rules = {{1, 0, 1 << 29, 0, 1 << 29}};
  pack.parameters.materials = {rulesOf(1200, 16384), rulesOf(700, 65536)};
  pack.parameters.slopes = SlopeRule::drift;
  pack.parameters.obstacle_threshold_q = 10;
  addBody(pack, boxMesh(6000, 5000, 4000), 60000, 60000, 1500);
  pack.paths[0] = {{{60000, 60000}, {130000, 90000}}, 900, 0, 0};
  Body& body = pack.bodies[0];
  body.force_n = 30000;
  body.first_scale_q16 = 30000;
  body.last_scale_tick = 50;
  pack.snowfalls = {{{0, 0, 120, 150}, std::int64_t(20) << 32, 10, 60, 9}};
  return pack;
}

/// The session: a simulation, whose ticks are published as a server does.
class SnowOnTheWire : public ::testing::Test {
 protected:
  void play(Rig& rig, int tick_count) {
    for (int i = 0; i < tick_count; ++i) {
      const std::int32_t tick = simulation_.state().tick + 1;
      std::optional<Parameters> parameters;
      std::vector<Snowfall> snowfalls;
      if (tick == 30) {
        parameters = world_.pack.parameters;
        parameters->materials[1].slope_threshold_q = 300;
      }
      if (tick == 35) snowfalls = {{{60, 20, 200, 150}, std::int64_t(35) << 32, 36, 80, 5}};
      const auto result = simulation_.step(script_.poses(tick), parameters, {}, snowfalls);
      ASSERT_TRUE(result) << result.error();
      ASSERT_EQ(result->ledger.error(), 0);
      rig.book.publish(result->update);
      rig.run(16);
    }
  }

  /// The client holds what the server simulates: hash, sums, cells, wake masks and dormant ground.
  void expectEqual(const Player& player) {
    ASSERT_TRUE(player.error.empty()) << player.error;
    ASSERT_TRUE(player.follower->inSync());
    const WorldState& held = player.follower->state();
    const WorldState& state = simulation_.state();
    EXPECT_EQ(held.tick, state.tick);
    EXPECT_EQ(stateHash(held), stateHash(state));
    EXPECT_EQ(held.ledger, state.ledger);
    EXPECT_EQ(held.snowfalls, state.snowfalls);
    EXPECT_EQ(held.parameters, state.parameters);
    EXPECT_TRUE(recount(held));
    for (const Tile* tile : state.tiles.sorted()) {
      const Tile* other = held.tiles.find(tile->at);
      ASSERT_NE(other, nullptr);
      EXPECT_EQ(other->wake_mask, tile->wake_mask);
      const TilePlanes planes = planesOf(*tile), others = planesOf(*other);
      for (int plane = 0; plane < kPlaneCount; ++plane) {
        static const PlaneCells none{};
        EXPECT_EQ(planes[plane] ? *planes[plane] : none, others[plane] ? *others[plane] : none) << plane;
      }
    }
  }

  World world_{snowPack()};
  Script script_{world_.base};
  Simulation simulation_ = world_.simulate();
  ScriptedSession session_{snowPack()};  // for its pack alone
};

TEST_F(SnowOnTheWire, AClientFollowsSnowMaterialsAndDrift) {
  Rig rig(kFar, session_);
  Player& player = rig.join("steady");
  rig.runUntil([&] { return player.follower->inSync(); });
  play(rig, 90);
  const auto reports = rig.finish();
  expectEqual(player);
  ASSERT_EQ(reports.size(), 1u);
  EXPECT_EQ(reports[0].mismatches, 0);
  const WorldState& state = simulation_.state();
  EXPECT_GT(state.ledger.events, 0);
  EXPECT_GT(state.ledger.compacted, 0);
  EXPECT_EQ(state.poses[0].scale_q16, kFullScale);
  int with_material = 0, snowed = 0;
  for (const Tile* tile : state.tiles.sorted()) {
    with_material += planesOf(*tile)[int(Plane::material)] != nullptr ? 1 : 0;
    snowed += tile->at.x < 1 ? 1 : 0;
  }
  EXPECT_GT(with_material, 0);
  // On ground that nobody reached, in the part where both fell and in its own beat: 51 * 20 and 45 * 35 units.
  const DormantGround ground = dormantGround(player.follower->state(), world_.base);
  EXPECT_EQ(ground.height(100, 140) - world_.base.height(100, 140), 51 * 20 + 45 * 35);
  EXPECT_EQ(ground.height(10, 140) - world_.base.height(10, 140), 51 * 20);
}

TEST_F(SnowOnTheWire, WhoJoinsWhileItSnowsHoldsTheSame) {
  Rig rig(kFar, session_);
  play(rig, 40);
  Player& late = rig.join("late");
  play(rig, 25);
  rig.runUntil([&] { return late.follower->inSync(); });
  Player& later = rig.join("later");
  play(rig, 25);
  rig.runUntil([&] { return later.follower->inSync(); });
  const auto reports = rig.finish();
  expectEqual(late);
  expectEqual(later);
  for (const ClientReport& report : reports) EXPECT_EQ(report.mismatches, 0) << report.name;
}

TEST_F(SnowOnTheWire, AnotherSnowOrMaterialIsNoticed) {
  Rig rig(kNear, session_);
  Player& player = rig.join("deceived");
  bool changed = false;
  player.transport->change = [&](Message& message) {
    auto* update = std::get_if<TickUpdate>(&message);
    if (update == nullptr || update->snowfalls.empty()) return true;
    changed = true;
    ++update->snowfalls[0].seed;
    return true;
  };
  rig.runUntil([&] { return player.follower->inSync(); });
  play(rig, 90);
  const auto reports = rig.finish();
  EXPECT_TRUE(changed);
  ASSERT_EQ(reports.size(), 1u);
  EXPECT_GT(reports[0].mismatches, 0);
  expectEqual(player);  // repaired by a snapshot
}

}  // namespace
}  // namespace spoor::test
