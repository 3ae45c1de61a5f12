// Scene packs as bytes.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>

#include "tests/scenes.h"

namespace spoor::test {
namespace {

/// A pack with something in every field.
ScenePack fullPack() {
  ScenePack pack = groundPack(9, 7, std::vector<std::int32_t>(63, 1234), 77);
  pack.name = "full";
  pack.seed = 0x123456789abcdefu;
  pack.ticks_per_second = 30;
  pack.default_ticks = 99;
  pack.parameters.obstacle_threshold_q = 5;
  addBody(pack, archMesh(4000, 2000, 1000), 3000, 4000, 55);
  addBody(pack, tetrahedronMesh(900), 2000, 1000, -5);
  pack.paths[0] = {{{1, 2}, {300, 400}}, 17, 3, 1};
  pack.bodies[1] = {"wheel", 1, 0, {1, -2, 3}, 4, 5, 6, 7, 8, 1};
  return pack;
}

/// The same pack over noise.
void makeNoise(ScenePack& pack) {
  pack.base_kind = BaseKind::noise;
  pack.samples = {};
  pack.noise = {17, 1 << 20, 3, -5, 6};
}

TEST(Pack, DecodesToWhatWasEncoded) {
  const ScenePack pack = fullPack();
  ASSERT_TRUE(validatePack(pack)) << validatePack(pack).error();
  const auto bytes = encodePack(pack);
  const auto decoded = decodePack(bytes);
  ASSERT_TRUE(decoded) << decoded.error();
  EXPECT_EQ(encodePack(*decoded), bytes);
  EXPECT_EQ(decoded->name, "full");
  EXPECT_EQ(decoded->seed, pack.seed);
  EXPECT_EQ(decoded->samples.height_q, pack.samples.height_q);
  EXPECT_EQ(decoded->meshes[0].vertices, pack.meshes[0].vertices);
  EXPECT_EQ(decoded->meshes[1].edges, pack.meshes[1].edges);
  EXPECT_EQ(decoded->paths[0].waypoints[1].y_q, 400);
  EXPECT_EQ(decoded->bodies[1].offset_q, pack.bodies[1].offset_q);
  EXPECT_EQ(decoded->bodies[1].follows_slope, 1);
}

TEST(Pack, DecodeRejectsEveryTruncation) {
  const auto bytes = encodePack(fullPack());
  for (std::size_t size = 0; size < bytes.size(); ++size)
    ASSERT_FALSE(decodePack(std::span(bytes).first(size))) << size << " of " << bytes.size() << " bytes";
}

TEST(Pack, DecodeRejectsATrailingByte) {
  auto bytes = encodePack(fullPack());
  bytes.push_back(0);
  EXPECT_FALSE(decodePack(bytes));
}

TEST(Pack, DecodeNamesAWrongMagicAndAWrongVersion) {
  auto bytes = encodePack(fullPack());
  bytes[4] = 77;
  EXPECT_NE(decodePack(bytes).error().find("version 77"), std::string::npos);
  bytes[0] ^= 1;
  EXPECT_NE(decodePack(bytes).error().find("magic"), std::string::npos);
}

TEST(Pack, EveryFieldIsInTheId) {
  const auto original = packId(encodePack(fullPack()));
  const std::function<void(ScenePack&)> changes[] = {
      [](ScenePack& p) { p.name = "else"; },
      [](ScenePack& p) { ++p.seed; },
      [](ScenePack& p) { ++p.cell_q; },
      [](ScenePack& p) { ++p.soil_depth_q; },
      [](ScenePack& p) { ++p.parameters.obstacle_threshold_q; },
      [](ScenePack& p) { ++p.parameters.materials[0].slope_threshold_q; },
      [](ScenePack& p) { ++p.parameters.materials[0].diagonal_threshold_q; },
      [](ScenePack& p) { ++p.parameters.sweeps_per_tick; },
      [](ScenePack& p) { ++p.samples.height_q[62]; },
      [](ScenePack& p) { ++p.meshes[1].vertices[3][2]; },
      [](ScenePack& p) { std::swap(p.meshes[0].triangles[0], p.meshes[0].triangles[1]); },
      [](ScenePack& p) { ++p.paths[0].speed_q_per_tick; },
      [](ScenePack& p) { ++p.paths[0].waypoints[1].x_q; },
      [](ScenePack& p) { ++p.bodies[0].sinkage_q; },
      [](ScenePack& p) { ++p.bodies[1].phase_q; },
  };
  int index = 0;
  for (const auto& change : changes) {
    ScenePack pack = fullPack();
    change(pack);
    EXPECT_NE(packId(encodePack(pack)), original) << "change " << index;
    ++index;
  }
}

TEST(Pack, ValidateNamesTheFieldThatIsOutOfRange) {
  const std::pair<const char*, std::function<void(ScenePack&)>> wrong[] = {
      {"width_cells", [](ScenePack& p) { p.width_cells = 0; }},
      {"height_cells", [](ScenePack& p) { p.height_cells = kWorldCellsLimit + 1; }},
      {"width_q", [](ScenePack& p) { p.width_cells = 1 << 23; }},
      {"cell_q", [](ScenePack& p) { p.cell_q = 0; }},
      {"soil_depth_q", [](ScenePack& p) { p.soil_depth_q = -1; }},
      {"obstacle_threshold_q", [](ScenePack& p) { p.parameters.obstacle_threshold_q = -1; }},
      {"slope_threshold_q", [](ScenePack& p) { p.parameters.materials[0].slope_threshold_q = -1; }},
      {"diagonal_threshold_q", [](ScenePack& p) { p.parameters.materials[0].diagonal_threshold_q = -1; }},
      {"sweeps_per_tick", [](ScenePack& p) { p.parameters.sweeps_per_tick = 1001; }},
      {"column_count", [](ScenePack& p) { p.samples.column_count = 0; }},
      {"height_q", [](ScenePack& p) { p.samples.height_q.pop_back(); }},
      {"sample_height", [](ScenePack& p) { p.samples.height_q[5] = 1 << 30; }},
      {"octaves", [](ScenePack& p) { makeNoise(p), p.noise.octaves = 9; }},
      {"highest_q", [](ScenePack& p) { makeNoise(p), p.noise.highest_q = -6; }},
      {"noise given", [](ScenePack& p) { p.noise.seed = 1; }},
      {"samples given", [](ScenePack& p) { makeNoise(p), p.samples.column_count = 1; }},
      {"no triangles", [](ScenePack& p) { p.meshes[0].triangles.clear(); }},
      {"vertex it does not have", [](ScenePack& p) { p.meshes[0].triangles[2][1] = 16; }},
      {"vertex it does not have", [](ScenePack& p) { p.meshes[0].edges[2][1] = 16; }},
      {"reaches farther", [](ScenePack& p) { p.meshes[1].vertices[0][0] = 1 << 20; }},
      {"waypoints", [](ScenePack& p) { p.paths[0].waypoints.clear(); }},
      {"speed_q_per_tick", [](ScenePack& p) { p.paths[0].speed_q_per_tick = -1; }},
      {"closed", [](ScenePack& p) { p.paths[0].closed = 2; }},
      {"mesh_index", [](ScenePack& p) { p.bodies[0].mesh_index = 2; }},
      {"path_index", [](ScenePack& p) { p.bodies[1].path_index = -1; }},
      {"wheel", [](ScenePack& p) { p.bodies[1].follows_slope = 2; }},
  };
  for (const auto& [name, change] : wrong) {
    ScenePack pack = fullPack();
    change(pack);
    const Status status = validatePack(pack);
    ASSERT_FALSE(status) << name;
    EXPECT_NE(status.error().find(name), std::string::npos) << status.error();
  }
}

TEST(Pack, DecodeRejectsAnInvalidIndex) {
  ScenePack pack = fullPack();
  const auto good = encodePack(pack);
  // The last body's record begins with its mesh index, right after its name.
  const std::string name = "wheel";
  const auto at = std::search(good.begin(), good.end(), name.begin(), name.end());
  auto bytes = good;
  bytes[std::size_t(at - good.begin()) + name.size()] = 9;
  EXPECT_FALSE(decodePack(bytes));
}

TEST(Pack, DecodeSurvivesDamagedBytes) {
  const auto good = encodePack(fullPack());
  std::mt19937 engine(61);
  int accepted = 0;
  for (int round = 0; round < 20000; ++round) {
    auto bytes = good;
    for (auto left = 1 + engine() % 4; left > 0; --left) bytes[engine() % bytes.size()] = std::uint8_t(engine());
    const auto pack = decodePack(bytes);
    if (!pack) continue;
    ++accepted;  // a changed number may well be valid; then it must be so all through
    ASSERT_TRUE(validatePack(*pack));
    ASSERT_EQ(encodePack(*pack).size(), bytes.size());
  }
  EXPECT_GT(accepted, 0);
}

}  // namespace
}  // namespace spoor::test
