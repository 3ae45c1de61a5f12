// Stage displace, request by request: direct and spread in rounds, iterative step by step.
#include <algorithm>
#include <cstdlib>

#include "shaders/rules/limits.h"
#include "tests/oracle.h"

namespace spoor::test {
namespace {

using Wide = __int128;

/// Soil that wants to go from one cell to another.
struct Request {
  std::size_t from, to;
  std::int64_t amount;
};

std::int64_t roomOf(const DenseWorld& world, std::size_t cell, std::int64_t height, int obstacle_threshold) {
  const std::int64_t gap = world.underside[cell] - height;
  return gap > obstacle_threshold ? gap : 0;
}

/// What a request gets of a room that `total` is requested of.
std::int64_t granted(std::int64_t request, std::int64_t room, std::int64_t total) {
  return total <= room ? request : std::int64_t(Wide(request) * room / total);
}

/// d * k / longest, to the nearest whole number, halves away from 0.
int alongLine(int d, int longest, int k) {
  const int twice = 2 * std::abs(d) * k;
  const int rounded = twice / (2 * longest) + (twice % (2 * longest) >= longest ? 1 : 0);
  return d < 0 ? -rounded : rounded;
}

/// The free cells beyond the target, seen from the source, as many as its overlap wants, up to the first that is not
/// free; where there are none the target itself.
std::vector<std::size_t> spreadOver(const DenseWorld& world, const std::vector<std::int32_t>& overlap,
                                    const Parameters& parameters, const OracleBox& domain, std::size_t from,
                                    std::size_t target) {
  const int target_x = int(target) % world.columns, target_y = int(target) / world.columns;
  const int dx = target_x - int(from) % world.columns, dy = target_y - int(from) / world.columns;
  const int longest = std::max(std::abs(dx), std::abs(dy)), divider = parameters.penetration_divider_q;
  const std::int64_t wanted = (std::int64_t(overlap[from]) + divider - 1) / divider;
  std::vector<std::size_t> cells;
  for (int k = 1; k <= std::min<std::int64_t>(wanted, parameters.spread_cells); ++k) {
    const int x = target_x + alongLine(dx, longest, k), y = target_y + alongLine(dy, longest, k);
    if (!domain.holds(x, y) || overlap[world.at(x, y)] != rules::kFree) break;
    cells.push_back(world.at(x, y));
  }
  if (cells.empty()) cells.push_back(target);
  return cells;
}

bool anyPenetrates(const DenseWorld& world, const std::vector<std::int32_t>& overlap, const OracleBox& domain) {
  for (int y = domain.y0; y < domain.y1; ++y)
    for (int x = domain.x0; x < domain.x1; ++x)
      if (overlap[world.at(x, y)] > 0) return true;
  return false;
}

/// What every penetrating cell wants in a round.
std::vector<Request> requestsOf(const DenseWorld& world, const std::vector<std::int32_t>& overlap,
                                const Parameters& parameters, const OracleBox& domain) {
  const auto target = oracleNearest(world, overlap, parameters, domain);
  std::vector<Request> requests;
  for (std::size_t i = 0; i < overlap.size(); ++i) {
    if (overlap[i] <= 0 || target[i] == rules::kNoTarget) continue;
    std::vector<std::size_t> cells = {std::size_t(target[i])};
    if (parameters.displacement == Displacement::spread)
      cells = spreadOver(world, overlap, parameters, domain, i, cells[0]);
    // Handed out unit by unit in turn: the first ones get one more where it does not divide.
    const auto count = std::int64_t(cells.size());
    for (std::int64_t part = 0; part < count; ++part)
      requests.push_back({i, cells[std::size_t(part)], (overlap[i] + count - 1 - part) / count});
  }
  return requests;
}

/// One round; false where nothing was requested.
bool displaceRound(DenseWorld& world, std::vector<std::int32_t>& overlap, const Parameters& parameters,
                   const OracleBox& domain) {
  const std::vector<Request> requests = requestsOf(world, overlap, parameters, domain);
  std::vector<std::int64_t> total(overlap.size(), 0), room(overlap.size(), 0);
  for (std::size_t i = 0; i < overlap.size(); ++i)
    room[i] = roomOf(world, i, world.height[i], parameters.obstacle_threshold_q);
  for (const Request& request : requests) total[request.to] += request.amount;
  for (const Request& request : requests) {
    const auto moved = std::int32_t(granted(request.amount, room[request.to], total[request.to]));
    world.height[request.from] -= moved;
    overlap[request.from] -= moved;
    world.height[request.to] += moved;
  }
  for (std::size_t i = 0; i < overlap.size(); ++i)
    if (total[i] > room[i]) overlap[i] = rules::kObstacle;
  return !requests.empty();
}

OracleKept displaceInRounds(DenseWorld& world, std::vector<std::int32_t>& overlap, const Parameters& parameters,
                            const OracleBox& domain) {
  for (int round = 0; round < parameters.capacity_rounds && anyPenetrates(world, overlap, domain); ++round)
    if (!displaceRound(world, overlap, parameters, domain)) break;
  OracleKept kept;
  for (int y = domain.y0; y < domain.y1; ++y)
    for (int x = domain.x0; x < domain.x1; ++x)
      if (overlap[world.at(x, y)] > 0) {
        kept.sum += overlap[world.at(x, y)];
        kept.cells.push_back(world.at(x, y));
      }
  return kept;
}

/// Neighbours, within the domain, that every cell may give to: those nearer to the free cell they know of.
std::vector<std::vector<std::size_t>> nearerNeighbours(const DenseWorld& world,
                                                       const std::vector<std::int32_t>& overlap,
                                                       const Parameters& parameters, const OracleBox& domain) {
  const auto target = oracleNearest(world, overlap, parameters, domain);
  const auto distance = [&](int x, int y) -> std::int64_t {
    const std::size_t i = world.at(x, y);
    if (overlap[i] == rules::kFree) return 0;
    if (target[i] == rules::kNoTarget) return INT64_MAX;
    const std::int64_t dx = std::abs(target[i] % world.columns - x), dy = std::abs(target[i] / world.columns - y);
    if (parameters.metric == Metric::euclidean) return dx * dx + dy * dy;
    return parameters.metric == Metric::manhattan ? dx + dy : std::max(dx, dy);
  };
  std::vector<std::vector<std::size_t>> nearer(overlap.size());
  for (int y = domain.y0; y < domain.y1; ++y)
    for (int x = domain.x0; x < domain.x1; ++x) {
      // A cell without a target gives nothing, though others be nearer.
      if (overlap[world.at(x, y)] == rules::kFree || target[world.at(x, y)] == rules::kNoTarget) continue;
      for (int near_y = y - 1; near_y <= y + 1; ++near_y)
        for (int near_x = x - 1; near_x <= x + 1; ++near_x)
          if (domain.holds(near_x, near_y) && distance(near_x, near_y) < distance(x, y))
            nearer[world.at(x, y)].push_back(world.at(near_x, near_y));
    }
  return nearer;
}

OracleKept displaceInSteps(DenseWorld& world, const std::vector<std::int32_t>& overlap, const Parameters& parameters,
                           const OracleBox& domain) {
  const auto nearer = nearerNeighbours(world, overlap, parameters, domain);
  std::vector<std::int64_t> ground(overlap.size()), carried(overlap.size());
  for (std::size_t i = 0; i < overlap.size(); ++i) {
    carried[i] = domain.holds(int(i) % world.columns, int(i) / world.columns) ? std::max(overlap[i], 0) : 0;
    ground[i] = world.height[i] - carried[i];
  }
  const auto roomFor = [&](std::size_t i) -> std::int64_t {
    if (overlap[i] == rules::kFree) return roomOf(world, i, ground[i] + carried[i], parameters.obstacle_threshold_q);
    return rules::kHeightLimit - ground[i] - carried[i];
  };
  constexpr std::int64_t kOfferMost = (1 << 28) - 1;
  for (int iteration = 0; iteration < parameters.displace_iterations; ++iteration) {
    std::vector<Request> offers;
    std::vector<std::int64_t> total(overlap.size(), 0);
    for (std::size_t i = 0; i < overlap.size(); ++i)
      for (const std::size_t to : nearer[i]) {
        const std::int64_t amount = std::min(carried[i] / std::int64_t(nearer[i].size()), kOfferMost);
        if (amount > 0) offers.push_back({i, to, amount});
        total[to] += amount;
      }
    std::vector<std::int64_t> next = carried;
    for (const Request& offer : offers) {
      const std::int64_t moved = granted(offer.amount, roomFor(offer.to), total[offer.to]);
      next[offer.from] -= moved;
      next[offer.to] += moved;
    }
    carried = std::move(next);
  }
  OracleKept kept;
  for (std::size_t i = 0; i < overlap.size(); ++i) {
    world.height[i] = std::int32_t(ground[i] + carried[i]);
    if (overlap[i] == rules::kFree || carried[i] == 0) continue;
    kept.sum += carried[i];
    kept.cells.push_back(i);
  }
  return kept;
}

}  // namespace

OracleKept oracleDisplace(DenseWorld& world, std::vector<std::int32_t> overlap, const Parameters& parameters,
                          const OracleBox& domain) {
  if (!anyPenetrates(world, overlap, domain)) return {};
  if (parameters.displacement == Displacement::iterative) return displaceInSteps(world, overlap, parameters, domain);
  return displaceInRounds(world, overlap, parameters, domain);
}

}  // namespace spoor::test
