// The published scheme in real numbers, and the drift rule beside the same equations.
#include "tests/bench/gilardi.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/backends.h"
#include "tests/scenes.h"

namespace spoor::test {
namespace {

constexpr double kSand = std::numbers::pi / 4;

DriftField fieldOf(int side, double (*height)(int x, int y)) {
  DriftField field;
  field.columns = field.rows = side;
  field.repose = kSand;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) field.height.push_back(height(x - side / 2, y - side / 2));
  return field;
}

double spike(int x, int y) { return x == 0 && y == 0 ? 1 : 0; }
double column(int x, int y) { return std::abs(x) <= 5 && std::abs(y) <= 5 ? 12 : 0; }
double flat(int, int) { return 0; }

TEST(Gilardi, OneStepIsEquation7) {
  DriftField field = fieldOf(5, spike);
  field.diffusion = 0.5;
  stepGilardi(field, 0.1, DriftWeights::none);
  EXPECT_NEAR(field.at(2, 2), 1 - 0.1 * 0.5 * 4, 1e-12);
  EXPECT_NEAR(field.at(1, 2), 0.1 * 0.5, 1e-12);
  EXPECT_NEAR(field.at(1, 1), 0, 1e-12);
}

TEST(Gilardi, AForceDigsBehindAndHeapsAhead) {
  DriftField field = fieldOf(5, flat);
  field.friction_inverse = 0.01;
  field.force_x.assign(25, 0);
  field.force_x[12] = 100;
  stepGilardi(field, 0.5, DriftWeights::none);
  EXPECT_NEAR(field.at(1, 2), -0.25, 1e-12);
  EXPECT_NEAR(field.at(2, 2), 0, 1e-12);
  EXPECT_NEAR(field.at(3, 2), 0.25, 1e-12);
}

TEST(Gilardi, AWeightIsTheDisplacementBeyondTheAngleOfRepose) {
  DriftField field = fieldOf(5, spike);
  field.height[12] = 0.6;  // moves by -1.2 along each axis
  stepGilardi(field, 1, DriftWeights::displacement);
  const double weight = (1.2 - kSand) / (std::numbers::pi / 2 - kSand);
  EXPECT_NEAR(field.at(2, 2), 0.6 - 2 * weight * 1.2, 1e-12);
  EXPECT_NEAR(field.at(1, 2), 0, 1e-12) << "0.6 is less than the angle";
}

TEST(Gilardi, LosesVolumeWithItsWeightsAndIsUnstableAboveAQuarter) {
  DriftField weighted = fieldOf(64, column), quick = weighted, slow = weighted, conserved = weighted;
  const double before = weighted.volume();
  for (int i = 0; i < 200; ++i) {
    stepGilardi(weighted, 0.1, DriftWeights::displacement);
    stepGilardi(slow, 0.24, DriftWeights::none);
    stepGilardi(quick, 0.3, DriftWeights::none);
    stepConserved(conserved, 0.04, DriftWeights::displacement);
  }
  EXPECT_GT(std::abs(weighted.volume() - before), 1);
  EXPECT_NEAR(conserved.volume(), before, 1e-6);
  EXPECT_LE(slow.height[std::size_t(32 * 64 + 32)], 12);
  EXPECT_GT(std::abs(quick.height[std::size_t(32 * 64 + 32)]), 1e6);
}

/// A world of one tile of soil, 100 cells deep, and the same as a field.
struct Twins {
  ScenePack pack;
  DriftField field;
};

Twins twinsOf(DriftWeights weights) {
  Twins twins;
  twins.pack = noisePack(64, 64, 3, 0, 40000, 50000);
  ScenePack& pack = twins.pack;
  pack.width_cells = pack.height_cells = 64;
  pack.cell_q = 500;
  pack.soil_depth_q = 100 * pack.cell_q;
  pack.base_kind = BaseKind::noise;
  pack.samples = {};
  pack.noise = {3, std::int64_t(1) << 28, 3, 0, 40000};
  pack.bodies.clear();
  Parameters& parameters = pack.parameters;
  parameters = {};
  parameters.slopes = SlopeRule::drift;
  parameters.drift_weights = weights;
  parameters.drift_step_q16 = kOneQ16 / 32;
  parameters.sweeps_per_tick = 1;
  parameters.active_areas = 0;
  parameters.materials[0].slope_threshold_q = pack.cell_q;
  parameters.materials[0].repose_q16 = kOneQ16 / 2;
  const BaseTerrain base(pack);
  twins.field.columns = twins.field.rows = 64;
  twins.field.repose = kSand;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) twins.field.height.push_back(double(base.height(x, y)) / pack.cell_q);
  return twins;
}

TEST(Drift, IsItsEquationsInRealNumbersButForRounding) {
  for (const DriftWeights weights : {DriftWeights::none, DriftWeights::displacement, DriftWeights::slope}) {
    Twins twins = twinsOf(weights);
    const BaseTerrain base(twins.pack);
    Simulation simulation(base, packId(encodePack(twins.pack)), makeNativeBackend());
    const std::vector<double> before = twins.field.height;
    constexpr int kSteps = 40;
    for (int tick = 0; tick < kSteps; ++tick) {
      ASSERT_TRUE(simulation.step({}));
      stepConserved(twins.field, 1.0 / 32, weights);
    }
    double largest = 0, moved = 0;
    const Tile* tile = simulation.state().tiles.find({0, 0});
    ASSERT_NE(tile, nullptr);
    for (std::size_t i = 0; i < twins.field.height.size(); ++i) {
      largest = std::max(largest, std::abs(tile->height()[i] - twins.field.height[i] * twins.pack.cell_q));
      moved = std::max(moved, std::abs(twins.field.height[i] - before[i]) * twins.pack.cell_q);
    }
    EXPECT_GT(moved, 1000) << int(weights) << ": units of 0.1 mm";
    EXPECT_LT(largest, 8) << int(weights) << ": four edges' rounding, and what they spread";
  }
}

}  // namespace
}  // namespace spoor::test
