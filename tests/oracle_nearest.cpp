// Stage nearest: every cell looks at all others, nearest rings first; and jump flooding, pass by pass.
#include <algorithm>
#include <cstdlib>
#include <tuple>

#include "shaders/rules/flood.h"
#include "tests/oracle.h"

namespace spoor::test {
namespace {

std::int64_t distanceBy(Metric metric, std::int64_t dx, std::int64_t dy) {
  if (metric == Metric::euclidean) return dx * dx + dy * dy;
  return metric == Metric::manhattan ? std::abs(dx) + std::abs(dy) : std::max(std::abs(dx), std::abs(dy));
}

/// A search of one domain.
struct Search {
  const DenseWorld& world;
  const std::vector<std::int32_t>& overlap;
  Metric metric;
  OracleBox domain;

  bool isFree(int x, int y) const { return domain.holds(x, y) && overlap[world.at(x, y)] == rules::kFree; }
  bool anyFree() const {
    for (int y = domain.y0; y < domain.y1; ++y)
      for (int x = domain.x0; x < domain.x1; ++x)
        if (isFree(x, y)) return true;
    return false;
  }
};

/// The first free cell in the order of distance, Euclidean distance, y, x. There must be one.
std::int32_t firstFree(const Search& search, int x, int y) {
  using Place = std::tuple<std::int64_t, std::int64_t, int, int>;
  Place best{INT64_MAX, 0, 0, 0};
  const auto visit = [&](const OracleBox& box) {
    const OracleBox& domain = search.domain;
    if (box.x1 <= domain.x0 || box.x0 >= domain.x1) return;
    for (int at_y = std::max(box.y0, domain.y0); at_y < std::min(box.y1, domain.y1); ++at_y)
      for (int at_x = std::max(box.x0, domain.x0); at_x < std::min(box.x1, domain.x1); ++at_x) {
        const std::int64_t dx = at_x - x, dy = at_y - y;
        if (search.isFree(at_x, at_y))
          best = std::min(best, Place{distanceBy(search.metric, dx, dy), dx * dx + dy * dy, at_y, at_x});
      }
  };
  // Ring by ring of the square around the cell, until a whole ring lies farther away than what was found.
  for (int ring = 1; distanceBy(search.metric, ring, 0) <= std::get<0>(best); ++ring) {
    visit({x - ring, y - ring, x + ring + 1, y - ring + 1});
    visit({x - ring, y + ring, x + ring + 1, y + ring + 1});
    visit({x - ring, y - ring + 1, x - ring + 1, y + ring});
    visit({x + ring, y - ring + 1, x + ring + 1, y + ring});
  }
  return std::int32_t(search.world.at(std::get<3>(best), std::get<2>(best)));
}

/// What cells know of free cells after a pass, from what they knew before it.
std::vector<std::int32_t> floodPass(const Search& search, const std::vector<std::int32_t>& before, int step) {
  const DenseWorld& world = search.world;
  std::vector<std::int32_t> after = before;
  const auto distanceTo = [&](int x, int y, std::int32_t free) {
    return distanceBy(search.metric, free % world.columns - x, free / world.columns - y);
  };
  for (int y = search.domain.y0; y < search.domain.y1; ++y)
    for (int x = search.domain.x0; x < search.domain.x1; ++x) {
      std::int32_t& known = after[world.at(x, y)];
      for (int k = 0; k < 8; ++k) {
        const int direction = rules::floodNeighbour(rules::floodOrder(x, y), k);
        const int from_x = x + rules::neighbourX(direction) * step, from_y = y + rules::neighbourY(direction) * step;
        if (!search.domain.holds(from_x, from_y)) continue;
        const std::int32_t offered = before[world.at(from_x, from_y)];
        if (offered == rules::kNoTarget) continue;
        if (known == rules::kNoTarget || distanceTo(x, y, offered) < distanceTo(x, y, known)) known = offered;
      }
    }
  return after;
}

std::vector<std::int32_t> flood(const Search& search, const std::vector<int>& steps) {
  std::vector<std::int32_t> known(search.overlap.size(), rules::kNoTarget);
  for (int y = search.domain.y0; y < search.domain.y1; ++y)
    for (int x = search.domain.x0; x < search.domain.x1; ++x)
      if (search.isFree(x, y)) known[search.world.at(x, y)] = std::int32_t(search.world.at(x, y));
  for (const int step : steps) known = floodPass(search, known, step);
  return known;
}

}  // namespace

std::vector<int> oracleFloodSteps(NearestSearch search, int size) {
  int power = 1;
  while (power < size) power *= 2;
  std::vector<int> halving;
  for (int step = power / 2; step >= 1; step /= 2) halving.push_back(step);
  std::vector<int> steps = halving;
  if (search == NearestSearch::jump_flooding_plus_1) steps.push_back(1);
  if (search == NearestSearch::jump_flooding_plus_2) steps.insert(steps.end(), {2, 1});
  if (search == NearestSearch::one_plus_jump_flooding) steps.insert(steps.begin(), 1);
  if (search == NearestSearch::jump_flooding_squared) steps.insert(steps.end(), halving.begin(), halving.end());
  return steps;
}

std::vector<std::int32_t> oracleNearest(const DenseWorld& world, const std::vector<std::int32_t>& overlap,
                                        const Parameters& parameters, const OracleBox& domain) {
  const Search search{world, overlap, parameters.metric, domain};
  std::vector<std::int32_t> target(overlap.size(), rules::kNoTarget);
  const bool exact = parameters.nearest == NearestSearch::exact;
  if (exact && !search.anyFree()) return target;
  std::vector<std::int32_t> known;
  if (!exact)
    known = flood(search, oracleFloodSteps(parameters.nearest, std::max(domain.x1 - domain.x0, domain.y1 - domain.y0)));
  for (int y = domain.y0; y < domain.y1; ++y)
    for (int x = domain.x0; x < domain.x1; ++x) {
      const std::size_t i = world.at(x, y);
      const bool searches = parameters.displacement == Displacement::iterative ? overlap[i] >= 0 : overlap[i] > 0;
      if (searches) target[i] = exact ? firstFree(search, x, y) : known[i];
    }
  return target;
}

}  // namespace spoor::test
