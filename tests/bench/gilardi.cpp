#include "tests/bench/gilardi.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "shared/base/assert.h"

namespace spoor::test {
namespace {

constexpr double kQuarterTurn = std::numbers::pi / 2;

/// Equation 4.
double weightOf(double displacement, double repose) {
  return std::clamp((std::abs(displacement) - repose) / (kQuarterTurn - repose), 0.0, 1.0);
}

double forceAt(const DriftField& field, const std::vector<double>& force, int x, int y) {
  const bool inside = x >= 0 && y >= 0 && x < field.columns && y < field.rows;
  return force.empty() || !inside ? 0 : force[std::size_t(y * field.columns + x)];
}

/// Equation 6 along one axis.
double displacementAlong(const DriftField& field, int x, int y, int dx, int dy) {
  const auto heightAt = [&](int at_x, int at_y) {
    return field.at(std::clamp(at_x, 0, field.columns - 1), std::clamp(at_y, 0, field.rows - 1));
  };
  const std::vector<double>& force = dx != 0 ? field.force_x : field.force_y;
  return field.diffusion * (heightAt(x - dx, y - dy) + heightAt(x + dx, y + dy) - 2 * field.at(x, y)) -
         0.5 * field.friction_inverse * (forceAt(field, force, x + dx, y + dy) - forceAt(field, force, x - dx, y - dy));
}

/// What moves over the edge from a cell to the next one along an axis, in a unit of time.
double flowOver(const DriftField& field, int x, int y, int dx, int dy, DriftWeights weights) {
  const double difference = field.at(x, y) - field.at(x + dx, y + dy);
  const std::vector<double>& force = dx != 0 ? field.force_x : field.force_y;
  const double pushed =
      0.5 * field.friction_inverse * (forceAt(field, force, x, y) + forceAt(field, force, x + dx, y + dy));
  if (weights == DriftWeights::slope) {
    const double excess = std::max(std::abs(difference) - std::tan(field.repose), 0.0);
    return field.diffusion * std::copysign(excess, difference) + pushed;
  }
  const double moved = field.diffusion * difference + pushed;
  return weights == DriftWeights::none ? moved : moved * weightOf(moved, field.repose);
}

}  // namespace

double DriftField::volume() const { return std::accumulate(height.begin(), height.end(), 0.0); }

void stepGilardi(DriftField& field, double step, DriftWeights weights) {
  SPOOR_ASSERT(weights != DriftWeights::slope);
  std::vector<double> next = field.height;
  for (int y = 0; y < field.rows; ++y)
    for (int x = 0; x < field.columns; ++x) {
      double change = 0;
      for (const double d : {displacementAlong(field, x, y, 1, 0), displacementAlong(field, x, y, 0, 1)})
        change += weights == DriftWeights::none ? d : d * weightOf(d, field.repose);
      next[std::size_t(y * field.columns + x)] += step * change;
    }
  field.height = std::move(next);
}

void stepConserved(DriftField& field, double step, DriftWeights weights) {
  std::vector<double> next = field.height;
  const auto flow = [&](int x, int y, int dx, int dy) {
    if (x + dx >= field.columns || y + dy >= field.rows) return;
    const double moved = step * flowOver(field, x, y, dx, dy, weights);
    next[std::size_t(y * field.columns + x)] -= moved;
    next[std::size_t((y + dy) * field.columns + x + dx)] += moved;
  };
  for (int y = 0; y < field.rows; ++y)
    for (int x = 0; x < field.columns; ++x) {
      flow(x, y, 1, 0);
      flow(x, y, 0, 1);
    }
  field.height = std::move(next);
}

double diffusedGaussian(double peak, double width, double diffusion, double time, double distance_square) {
  const double before = width * width, after = before + 2 * diffusion * time;
  return peak * before / after * std::exp(-distance_square / (2 * after));
}

}  // namespace spoor::test
