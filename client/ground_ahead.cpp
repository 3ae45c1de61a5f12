#include "client/ground_ahead.h"

#include <algorithm>

#include "client/views.h"
#include "shaders/rules/limits.h"

namespace spoor {
namespace {

constexpr double kReach_m = 1000;
constexpr int kHalvings = 24;

}  // namespace

std::optional<glm::dvec2> groundAhead(const TerrainView& view, const Camera& camera) {
  const ScenePack& pack = view.base->pack();
  const double cell_m = double(pack.cell_q) / rules::kUnitsPerMetre;
  const auto at = [&](double way_m) { return camera.eye_m + camera.forward * way_m; };
  const auto isBelow = [&](double way_m) { return at(way_m).z <= groundHeight(view, glm::dvec2(at(way_m))); };
  double above_m = 0, below_m = 0;
  while (!isBelow(below_m)) {
    if (below_m > kReach_m) return {};
    above_m = below_m;
    below_m += std::max(cell_m, below_m / 100);
  }
  for (int i = 0; i < kHalvings; ++i) {
    const double middle_m = (above_m + below_m) / 2;
    (isBelow(middle_m) ? below_m : above_m) = middle_m;
  }
  const glm::dvec2 place_m(at(below_m));
  const glm::dvec2 size_m = glm::dvec2(pack.width_cells, pack.height_cells) * cell_m;
  const bool inside = place_m.x >= 0 && place_m.y >= 0 && place_m.x < size_m.x && place_m.y < size_m.y;
  return inside ? std::optional(place_m) : std::nullopt;
}

}  // namespace spoor
