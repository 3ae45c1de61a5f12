// Stage depth: which cells a mesh covers and how low it reaches, against edge functions over every cell.
#include <gtest/gtest.h>

#include <random>

#include "shared/base/fixed.h"
#include "tests/stage_rig.h"

namespace spoor::test {
namespace {

constexpr int kNone = rules::kNoUnderside;

class DepthStage : public OnEveryBackend {
 protected:
  std::unique_ptr<StageRig> rigOf(const World& world) const { return makeStageRig(GetParam(), world); }
};

struct Rectangle {
  int columns, rows;
};

/// One triangle over a 5 x 5 world: level along x, rising from 0 in the south to 5000 in the north-west corner.
Mesh slopingTriangle() {
  Mesh mesh;
  mesh.name = "triangle";
  mesh.vertices = {{0, 0, 0}, {5000, 0, 0}, {0, 5000, 5000}};
  mesh.triangles = {{0, 1, 2}};
  deriveEdges(mesh);
  return mesh;
}

TEST_P(DepthStage, ASlopingTriangleOverFiveByFiveCells) {
  ScenePack pack = flatPack(5, 5);
  addBody(pack, slopingTriangle(), 0, 0, 0);
  const World world(std::move(pack));
  const auto rig = rigOf(world);
  rig->press({placeBody(world.pack, 0, Pose{})});
  // Cells inside have the plane's height at their centre; those on an edge its lowest point within the cell.
  const std::vector<std::int32_t> expected = {0,    0,    0,     0,     0,      // y = 0
                                              1000, 1500, 1500,  1003,  3,      //
                                              2000, 2500, 2003,  1003,  kNone,  //
                                              3000, 3003, 2003,  kNone, kNone,  //
                                              4000, 3003, kNone, kNone, kNone};
  EXPECT_EQ(rig->underside(), expected);
}

TEST_P(DepthStage, ABoxCoversEveryCellThatItTouches) {
  ScenePack pack = flatPack(5, 5);
  addBody(pack, boxMesh(2000, 2000, 500), 2500, 2500, 300);
  const World world(std::move(pack));
  const auto rig = rigOf(world);
  rig->press({placeBody(world.pack, 0, initialState(world.id, world.base).poses[0])});
  std::vector<std::int32_t> expected(25, kNone);
  for (const int i : {6, 7, 8, 11, 12, 13, 16, 17, 18}) expected[std::size_t(i)] = -300;
  EXPECT_EQ(rig->underside(), expected);
}

TEST_P(DepthStage, ABladeThinnerThanACellStillPresses) {
  ScenePack pack = flatPack(5, 5);
  addBody(pack, bladeMesh(3000, 1000), 2500, 2500, 200);
  const World world(std::move(pack));
  const auto rig = rigOf(world);
  rig->press({placeBody(world.pack, 0, initialState(world.id, world.base).poses[0])});
  std::vector<std::int32_t> expected(25, kNone);
  for (const int i : {7, 12, 17, 22}) expected[std::size_t(i)] = -200;  // from y = 1000 to y = 4000, both inclusive
  EXPECT_EQ(rig->underside(), expected);
}

TEST_P(DepthStage, BeneathAnArchTheGapStaysHigh) {
  ScenePack pack = flatPack(9, 3);
  addBody(pack, archMesh(8000, 1000, 3000), 4500, 1500, 100);
  const World world(std::move(pack));
  const auto rig = rigOf(world);
  rig->press({placeBody(world.pack, 0, initialState(world.id, world.base).poses[0])});
  const auto cells = rig->underside();
  const std::vector<std::int32_t> middle(cells.begin() + 9, cells.begin() + 18);
  EXPECT_EQ(middle, (std::vector<std::int32_t>{-100, -100, -100, 1400, 1400, 1400, -100, -100, -100}));
}

TEST_P(DepthStage, WhatIsHigherThanTheFrustumIsNotSeen) {
  ScenePack pack = flatPack(9, 3);
  pack.parameters.frustum_height_q = 100000;  // above bedrock, which lies 100000 deep
  addBody(pack, archMesh(8000, 1000, 3000), 4500, 1500, 100);
  const World world(std::move(pack));
  const auto rig = rigOf(world);
  rig->press({placeBody(world.pack, 0, initialState(world.id, world.base).poses[0])});
  const auto cells = rig->underside();
  const std::vector<std::int32_t> middle(cells.begin() + 9, cells.begin() + 18);
  EXPECT_EQ(middle, (std::vector<std::int32_t>{-100, -100, -100, kNone, kNone, kNone, -100, -100, -100}));
}

TEST_P(DepthStage, TheLowestOfSeveralBodiesCounts) {
  ScenePack pack = flatPack(5, 5);
  addBody(pack, boxMesh(2000, 2000, 500), 2000, 2500, 100);
  addBody(pack, boxMesh(2000, 2000, 500), 3500, 2500, 400);
  const World world(std::move(pack));
  const auto poses = initialState(world.id, world.base).poses;
  const PlacedBody first = placeBody(world.pack, 0, poses[0]), second = placeBody(world.pack, 1, poses[1]);
  const auto rig = rigOf(world), reversed = rigOf(world);
  rig->press({first, second});
  reversed->press({second, first});
  EXPECT_EQ(rig->underside()[11], -100);
  EXPECT_EQ(rig->underside()[12], -400);
  EXPECT_EQ(rig->underside(), reversed->underside());
}

/// Meshes of all shapes, in any pose, in and out of the world: the stage and the oracle draw the same.
void checkRandomBodies(const BackendCase& backend_case, int width, int height, int size_cells, std::uint32_t seed) {
  std::mt19937 engine(seed);
  const auto pick = [&](int low, int high) { return low + int(engine() % std::uint32_t(high - low + 1)); };
  ScenePack pack = flatPack(width, height);
  const int size = size_cells * pack.cell_q;
  for (const Mesh& mesh : {boxMesh(size, size / 3, size), wedgeMesh(size, size, size / 2), tetrahedronMesh(size / 2),
                           archMesh(size, size / 2, size), bladeMesh(size, size / 4)})
    addBody(pack, mesh, 0, 0, 0);
  if (seed % 2 == 1) pack.parameters.frustum_height_q = pack.soil_depth_q + 300;
  const World world(std::move(pack));
  for (int round = 0; round < 6; ++round) {
    std::vector<PlacedBody> bodies;
    const auto rig = makeStageRig(backend_case, world);
    DenseWorld dense = denseCopy(*rig);
    for (int i = 0; i < 5; ++i) {
      const Pose pose{pick(-2000, (width + 2) * 1000),
                      pick(-2000, (height + 2) * 1000),
                      pick(-5000, 5000),
                      Turn(engine()),
                      Turn(engine()),
                      Turn(engine()),
                      Turn(engine())};
      bodies.push_back(placeBody(world.pack, i, pose));
      oracleDepth(dense, placeForOracle(world.pack, i, pose));
    }
    oracleFrustum(dense, world.pack.parameters.frustum_height_q);
    rig->press(bodies);
    ASSERT_EQ(rig->underside(), insideCells(dense, dense.underside)) << width << " x " << height << ", round " << round;
  }
}

TEST_P(DepthStage, EqualsTheOracleOnWorldsOfAnySize) {
  for (const auto& [columns, rows] : {Rectangle{77, 131}, Rectangle{1, 200}, Rectangle{65, 1}, Rectangle{64, 64}})
    checkRandomBodies(GetParam(), columns, rows, 12, std::uint32_t(columns));
}

TEST_P(DepthStage, EqualsTheOracleForABodyOfThreeTiles) { checkRandomBodies(GetParam(), 203, 197, 200, 3); }

TEST(Depth, DomainsThatShareRowsOfATileKeepTheLowestUndersideOfEach) {
  ScenePack pack = flatPack(128, 64);
  for (int i = 0; i < 20; ++i) addBody(pack, boxMesh(1500, 60000, 3000), 3500 + i * 6000, 32000, i * 7919 % 20000);
  const World world(std::move(pack));
  const auto poses = initialState(world.id, world.base).poses;
  SubStep sub_step;
  for (int i = 0; i < 20; ++i) {
    sub_step.bodies.push_back(placeBody(world.pack, i, poses[std::size_t(i)]));
    const CellBox& box = sub_step.bodies.back().box;
    sub_step.domains.push_back({{box.x0 - 1, 0, box.x1 + 1, 64}, {i}});
  }
  NativeStageRig rig(world, 4);
  for (int round = 0; round < 400; ++round) {
    rig.area.clearUnderside(world.pack, rig.pool);
    runDepth(rig.context, sub_step);
    for (int y = 0; y < 64; ++y)
      for (const int x : {0, 64}) {
        const std::int32_t* cells = &rig.area.underside[rig.area.offsetAt(x, y)];
        ASSERT_EQ(rig.area.lowest_underside[rig.area.segmentAt(x, y)], *std::min_element(cells, cells + 64))
            << "round " << round;
      }
  }
}

SPOOR_ON_EVERY_BACKEND(DepthStage);

/// A random triangle, corners within a window of `span` subcells; some small ones, some with level or upright edges.
std::array<rules::RasterPoint, 3> randomTriangle(std::mt19937& engine, int span) {
  const auto pick = [&](int range) { return int(engine() % std::uint32_t(2 * range + 1)) - range; };
  std::array<rules::RasterPoint, 3> corners;
  for (auto& corner : corners) corner = {pick(span), pick(span), pick(rules::kRasterHeightSpan / 2)};
  if (engine() % 4 == 0) corners[1].y = corners[0].y;
  if (engine() % 4 == 0) corners[2].x = corners[0].x;
  if (engine() % 4 == 0)  // on cell centres, where ties are
    for (auto& corner : corners) {
      corner.x = int(floorDiv(corner.x, 256)) * 256 + 128;
      corner.y = int(floorDiv(corner.y, 256)) * 256 + 128;
    }
  return corners;
}

TEST(Depth, ASpanHoldsExactlyTheCentresInsideTheTriangle) {
  std::mt19937 engine(11);
  for (int round = 0; round < 400; ++round) {
    const int cells = round % 2 == 0 ? 3 : 40;
    const auto [a, b, c] = randomTriangle(engine, cells * 256);
    const auto triangle = rules::rasterTriangle(a, b, c);
    if (triangle.area == 0) continue;
    for (int y = -cells - 1; y <= cells; ++y) {
      const auto span = rules::triangleSpan(triangle, y, {-cells - 1, cells + 1});
      for (int x = -cells - 1; x <= cells; ++x)
        ASSERT_EQ(x >= span.begin && x < span.end, coversCentre(a, b, c, x, y))
            << "round " << round << ", cell " << x << ", " << y;
    }
  }
}

TEST(Depth, ACentreOnASharedEdgeBelongsToOneTriangle) {
  std::mt19937 engine(12);
  int on_edge = 0;
  for (int round = 0; round < 300; ++round) {
    // A fan around one point, all corners on cell centres: a centre strictly inside the fan lies in exactly one part.
    const auto snap = [&] { return int(engine() % 17) * 256 - 8 * 256 + 128; };
    const rules::RasterPoint middle{128, 128, 0};
    const rules::RasterPoint ring[] = {{std::abs(snap()) + 256, snap(), 0},
                                       {snap(), std::abs(snap()) + 256, 0},
                                       {-std::abs(snap()) - 256, snap(), 0},
                                       {snap(), -std::abs(snap()) - 256, 0}};
    for (int y = -9; y <= 9; ++y)
      for (int x = -9; x <= 9; ++x) {
        int parts = 0, touching = 0;
        for (int i = 0; i < 4; ++i) {
          const auto &p = ring[i], &q = ring[(i + 1) % 4];
          const std::int64_t area =
              std::int64_t(p.x - middle.x) * (q.y - middle.y) - std::int64_t(p.y - middle.y) * (q.x - middle.x);
          if (area <= 0) goto next_round;  // not a fan
          parts += coversCentre(middle, p, q, x, y) ? 1 : 0;
          const std::int64_t side = std::int64_t(p.x - middle.x) * (y * 256) - std::int64_t(p.y - middle.y) * (x * 256);
          touching += side == 0 ? 1 : 0;
        }
        ASSERT_LE(parts, 1) << "round " << round << ", cell " << x << ", " << y;
        if (x == 0 && y == 0) {
          ASSERT_EQ(parts, 1) << "the fan's own middle";
        }
        on_edge += touching > 0 && parts == 1 ? 1 : 0;
      }
  next_round:;
  }
  EXPECT_GT(on_edge, 500);
}

TEST(Depth, HeightsAlongARowLieAtMostTwoUnitsBelowThePlane) {
  std::mt19937 engine(13);
  int checked = 0;
  for (int round = 0; round < 3000; ++round) {
    const int cells = round % 3 == 0 ? 2047 : 30;
    const auto [a, b, c] = randomTriangle(engine, cells * 256);
    const auto triangle = rules::rasterTriangle(a, b, c);
    if (triangle.area == 0) continue;
    const int y = int(engine() % std::uint32_t(2 * cells)) - cells;
    const auto span = rules::triangleSpan(triangle, y, {-cells - 1, cells + 1});
    if (span.end <= span.begin) continue;
    const int first = rules::triangleHeight(triangle, span.begin, y);
    ASSERT_EQ(first, planeHeight(a, b, c, span.begin, y)) << "round " << round;
    for (int x = span.begin; x < span.end; ++x, ++checked) {
      const int height = rules::triangleHeightAlong(first, triangle.step, triangle.step_fraction, x - span.begin,
                                                    triangle.lowest, triangle.highest);
      const std::int64_t below = planeHeight(a, b, c, x, y) - height;
      ASSERT_TRUE(below >= 0 && below <= 2) << below << " units, round " << round << ", cell " << x << ", " << y;
    }
  }
  EXPECT_GT(checked, 100000);
}

TEST(Depth, AnEdgeCoversEveryCellThatItsPointsLieIn) {
  std::mt19937 engine(14);
  for (int round = 0; round < 500; ++round) {
    const auto [a, b, c] = randomTriangle(engine, (round % 2 == 0 ? 2 : 20) * 256);
    const auto edge = rules::rasterEdge(a, b), back = rules::rasterEdge(b, a);
    for (int u = edge.u0; u <= edge.u1; ++u) {
      const std::int64_t length = std::max(edge.u1 - edge.u0, 1);
      const std::int64_t v = edge.v0 + floorDiv(std::int64_t(edge.v1 - edge.v0) * (u - edge.u0), length);
      const std::int64_t z = edge.z0 + floorDiv(std::int64_t(edge.z1 - edge.z0) * (u - edge.u0), length);
      const auto column = rules::edgeColumn(edge, int(floorDiv(u, 256)));
      ASSERT_LE(column.first, floorDiv(v, 256)) << "round " << round;
      ASSERT_GE(column.last, floorDiv(v, 256)) << "round " << round;
      ASSERT_LE(column.height, z) << "round " << round;
      const auto same = rules::edgeColumn(back, int(floorDiv(u, 256)));
      ASSERT_TRUE(column.first == same.first && column.last == same.last && column.height == same.height)
          << "round " << round;
    }
  }
}

}  // namespace
}  // namespace spoor::test
