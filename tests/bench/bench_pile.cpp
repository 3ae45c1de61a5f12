#include "tests/bench/bench_pile.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace spoor {
namespace {

class PileView {
 public:
  PileView(const WorldState& state, const ScenePack& pack)
      : side_(pack.width_cells), cell_(pack.cell_q), height_(std::size_t(side_) * std::size_t(side_)) {
    const BaseTerrain base(pack);
    const int ground = base.height(0, 0);
    for (const Tile* tile : state.tiles.sorted())
      for (int i = 0; i < rules::kTileCells; ++i) {
        const int x = tile->at.x * rules::kTileSize + i % rules::kTileSize;
        const int y = tile->at.y * rules::kTileSize + i / rules::kTileSize;
        if (x < side_ && y < side_) height_[std::size_t(y * side_ + x)] = tile->height()[std::size_t(i)] - ground;
      }
  }

  PileShape shape(const MaterialRules& rules) const {
    PileShape result;
    const double slope = rules.slope_threshold_q, middle = side_ / 2;
    double volume = 0, sum_x = 0, sum_y = 0;
    for (int y = 0; y < side_; ++y)
      for (int x = 0; x < side_; ++x) {
        volume += at(x, y);
        sum_x += at(x, y) * (x - middle);
        sum_y += at(x, y) * (y - middle);
        result.steepest_excess = std::max(result.steepest_excess, excess(x, y, 1, 0, rules.slope_threshold_q) / slope);
        result.steepest_excess = std::max(result.steepest_excess, excess(x, y, 0, 1, rules.slope_threshold_q) / slope);
        for (const int dx : {1, -1})
          result.steepest_excess = std::max(result.steepest_excess, excess(x, y, dx, 1, rules.diagonal_threshold_q) /
                                                                        double(rules.diagonal_threshold_q));
      }
    const double radius = std::cbrt(3 * volume / (std::numbers::pi * slope));
    double difference = 0;
    for (int y = 0; y < side_; ++y)
      for (int x = 0; x < side_; ++x) {
        const double cone = std::max(0.0, slope * (radius - std::hypot(x - middle, y - middle)));
        difference += std::abs(at(x, y) - cone);
      }
    result.shape_error = difference / (2 * volume);
    result.centroid_cells = std::hypot(sum_x, sum_y) / volume;
    result.azimuth_ratio = azimuthRatio(slope * radius / 2);
    addAngles(result);
    return result;
  }

 private:
  void addAngles(PileShape& result) const {
    constexpr double kDegrees = 180 / std::numbers::pi;
    const double top = *std::ranges::max_element(height_);
    double steepest = 0, sum = 0;
    int count = 0;
    for (int y = 1; y + 1 < side_; ++y)
      for (int x = 1; x + 1 < side_; ++x) {
        const double east = at(x + 1, y) - at(x, y), north = at(x, y + 1) - at(x, y);
        steepest = std::max({steepest, std::abs(east), std::abs(north)});
        if (at(x, y) < top / 4 || at(x, y) > top * 3 / 4) continue;
        const double slope = std::hypot(at(x + 1, y) - at(x - 1, y), at(x, y + 1) - at(x, y - 1)) / 2;
        sum += std::atan(slope / cell_);
        ++count;
      }
    result.edge_deg = std::atan(steepest / cell_) * kDegrees;
    result.flank_deg = count > 0 ? sum / count * kDegrees : 0;
  }

  double at(int x, int y) const { return height_[std::size_t(y * side_ + x)]; }

  double excess(int x, int y, int dx, int dy, int threshold) const {
    if (x + dx < 0 || x + dx >= side_ || y + dy >= side_) return 0;
    return std::abs(at(x, y) - at(x + dx, y + dy)) - threshold;
  }

  /// Largest over smallest radius at which rays from the middle fall below a height.
  double azimuthRatio(double level) const {
    double smallest = 1e9, largest = 0;
    for (int ray = 0; ray < 64; ++ray) {
      const double angle = ray * 2 * std::numbers::pi / 64;
      double radius = 0;
      while (radius < side_ / 2 - 2 &&
             between(side_ / 2 + radius * std::cos(angle), side_ / 2 + radius * std::sin(angle)) >= level)
        radius += 0.05;
      smallest = std::min(smallest, radius);
      largest = std::max(largest, radius);
    }
    return smallest > 0 ? largest / smallest : 0;
  }

  double between(double x, double y) const {
    const int x0 = int(x), y0 = int(y);
    const double u = x - x0, v = y - y0;
    return (at(x0, y0) * (1 - u) + at(x0 + 1, y0) * u) * (1 - v) +
           (at(x0, y0 + 1) * (1 - u) + at(x0 + 1, y0 + 1) * u) * v;
  }

  int side_;
  double cell_;  // 0.1 mm
  std::vector<double> height_;
};

}  // namespace

PileShape pileShape(const WorldState& state, const ScenePack& pack) {
  return PileView(state, pack).shape(state.parameters.materials.front());
}

}  // namespace spoor
