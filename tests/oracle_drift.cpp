// Rule drift from the description in rules/drift.h, edge by edge in wide numbers; and how bodies push.
#include <algorithm>
#include <bit>
#include <cstdlib>

#include "shaders/rules/drift.h"
#include "shared/base/fixed.h"
#include "tests/oracle.h"

namespace spoor::test {
namespace {

using Wide = __int128;

constexpr std::int64_t kMost = (1 << 22) - 1;  // 0.1 mm; no difference of heights and no push counts for more
constexpr std::int64_t kStrengthMost = 1 << 30;

std::int64_t ceilOf(Wide numerator, std::int64_t divisor) { return std::int64_t((numerator + divisor - 1) / divisor); }

/// What an edge's flow may grow by for each unit that its ends' difference does, times 2^16.
std::int64_t fastestFlow(const Parameters& parameters, const MaterialRules& material) {
  if (parameters.drift_weights != DriftWeights::displacement) return material.diffusion_q16;
  const std::int64_t left = kOneQ16 - material.repose_q16;
  return ceilOf(Wide(material.diffusion_q16) * (kOneQ16 + left), left);
}

/// The numbers of a step that all edges share.
rules::DriftStep sharedStep(const DenseWorld& world, const Parameters& parameters) {
  const std::int64_t count = oracleDriftSteps(parameters);
  rules::DriftStep step{};
  step.weights = int(parameters.drift_weights);
  step.step = std::max(int((2 * parameters.drift_step_q16 + count) / (2 * count)), 1);
  constexpr std::int64_t kHalfPiQ32 = 6746518852;
  const std::int64_t right_angle_q = std::int64_t(Wide(world.cell_q) * kHalfPiQ32 >> 32);
  step.quarter = std::max(int(right_angle_q * step.step / 256), 1);
  while (std::uint64_t(step.quarter) << (step.shift + 1) < std::uint64_t(1) << 31) ++step.shift;
  step.inverse_quarter = rules::uint((std::uint64_t(1) << 48) / (std::uint64_t(step.quarter) << step.shift));
  return step;
}

class DriftSweepOracle {
 public:
  DriftSweepOracle(const DenseWorld& before, const Parameters& parameters, rules::uint phase, DenseWorld& world)
      : before_(before), parameters_(parameters), phase_(phase), world_(world), step_(sharedStep(before, parameters)) {}

  /// Moves soil over the edge from (x, y) to its neighbour on the side of larger x, or y.
  void flow(int x, int y, int axis) {
    const int other_x = x + (axis == 0 ? 1 : 0), other_y = y + axis;
    if (!before_.isActive(x, y) || !before_.isActive(other_x, other_y)) return;
    const std::size_t a = before_.at(x, y), b = before_.at(other_x, other_y);
    const std::vector<std::int32_t>& push = axis == 0 ? before_.push_x : before_.push_y;
    // With 8 bits below the unit; negative: from b to a.
    const std::int64_t moved = diffused(a, b) + pushed(floorDiv(std::int64_t(push[a]) + push[b], 2));
    const std::size_t giver = moved < 0 ? b : a, taker = moved < 0 ? a : b;
    const std::int64_t dither = rules::driftDither(x, y, axis, phase_);
    const std::int64_t wanted = (weighed(std::abs(moved), giver) + dither) / 256;
    const std::int64_t fits = std::min(before_.soil(giver), before_.room(taker, parameters_.obstacle_threshold_q));
    const auto flows = std::int32_t(std::min(wanted, fits / 4));
    world_.height[giver] -= flows;
    world_.height[taker] += flows;
  }

 private:
  std::int64_t rate(std::size_t cell) const {
    const std::int64_t diffusion = before_.rulesOf(parameters_, cell).diffusion_q16;
    return std::min<std::int64_t>((diffusion * step_.step + kOneQ16 / 2) / kOneQ16, kOneQ16 / 8);
  }

  std::int64_t diffused(std::size_t a, std::size_t b) const {
    const std::int64_t difference = std::clamp<std::int64_t>(before_.height[a] - before_.height[b], -kMost, kMost);
    const std::size_t higher = difference < 0 ? b : a;
    std::int64_t counts = std::abs(difference) > 1 ? std::abs(difference) : 0;
    if (parameters_.drift_weights == DriftWeights::slope) {
      const std::int64_t rests = std::max(before_.rulesOf(parameters_, higher).slope_threshold_q, 1);
      counts = std::max<std::int64_t>(std::abs(difference) - rests, 0);
    }
    const std::int64_t amount = counts * ((rate(a) + rate(b)) / 2) / 256;
    return difference < 0 ? -amount : amount;
  }

  std::int64_t pushed(std::int64_t push) const {
    const std::int64_t amount = std::min(std::abs(push), kMost) * step_.step / 256;
    return push < 0 ? -amount : amount;
  }

  /// By displacement only a share of what moves: none up to the angle of repose, all at a right angle.
  std::int64_t weighed(std::int64_t moved, std::size_t giver) const {
    if (parameters_.drift_weights != DriftWeights::displacement) return moved;
    const std::int32_t rest = before_.rulesOf(parameters_, giver).repose_q16;
    const auto inverse = rules::uint(0xffffffffu / std::uint32_t(kOneQ16 - rest));
    // The rule's header defines how the share is rounded.
    return std::int64_t(Wide(moved) * rules::driftWeight(step_, int(moved), rest, inverse) / kOneQ16);
  }

  const DenseWorld& before_;
  const Parameters& parameters_;
  rules::uint phase_;
  DenseWorld& world_;
  rules::DriftStep step_;
};

}  // namespace

int oracleDriftSteps(const Parameters& parameters) {
  // No step takes more than a unit of time, nor may flows grow by more than an eighth of what differences do.
  std::int64_t count = ceilOf(parameters.drift_step_q16, kOneQ16);
  for (const MaterialRules& material : parameters.materials)
    count = std::max(count, ceilOf(Wide(8) * fastestFlow(parameters, material) * parameters.drift_step_q16,
                                   std::int64_t(kOneQ16) * kOneQ16));
  return int(std::max<std::int64_t>(count, 1));
}

void oracleDrift(DenseWorld& world, const Parameters& parameters, std::int32_t tick, int sweep) {
  const DenseWorld before = world;
  DriftSweepOracle edges(before, parameters, rules::driftPhase(tick, sweep), world);
  for (int y = 0; y < world.inside_rows; ++y)
    for (int x = 0; x < world.inside_columns; ++x) {
      edges.flow(x, y, 0);
      edges.flow(x, y, 1);
    }
}

void oraclePush(DenseWorld& world, const Parameters& parameters, const std::vector<OraclePush>& pushes,
                int body_count) {
  std::vector<std::int64_t> sum_x(world.height.size(), 0), sum_y = sum_x;
  for (const OraclePush& push : pushes) {
    std::vector<std::size_t> contacts;
    for (int y = push.box.y0; y < push.box.y1; ++y)
      for (int x = push.box.x0; x < push.box.x1; ++x) {
        const std::size_t i = world.at(x, y);
        const bool covered = world.underside[i] != rules::kNoUnderside;
        if (covered && std::int64_t(world.underside[i]) - world.height[i] <= parameters.obstacle_threshold_q)
          contacts.push_back(i);
      }
    if (contacts.empty() || (push.dx_q == 0 && push.dy_q == 0)) continue;
    // Newtons times the side of a cell, the same on every cell; all bodies' together must fit an int.
    const std::int64_t force = std::int64_t(push.force_n) * world.cell_q / std::int64_t(contacts.size());
    const std::int64_t strength = std::min(force, kStrengthMost / body_count);
    const auto length = std::int64_t(isqrt(std::uint64_t(push.dx_q * push.dx_q + push.dy_q * push.dy_q)));
    const auto along = [&](std::int64_t part) {
      const std::int64_t direction_q30 = std::clamp(floorDiv(part << 30, length), -kStrengthMost, kStrengthMost);
      return floorDiv(strength * direction_q30, std::int64_t(1) << 30);
    };
    for (const std::size_t i : contacts) {
      sum_x[i] += along(push.dx_q);
      sum_y[i] += along(push.dy_q);
    }
  }
  for (std::size_t i = 0; i < sum_x.size(); ++i) {
    const std::int64_t inverse_q32 = world.rulesOf(parameters, i).friction_inverse_q32;
    const auto moved = [&](std::int64_t force) {
      return std::int32_t(std::clamp(std::int64_t(Wide(force) * inverse_q32 >> 32), -kMost, kMost));
    };
    world.push_x[i] = moved(sum_x[i]);
    world.push_y[i] = moved(sum_y[i]);
  }
}

}  // namespace spoor::test
