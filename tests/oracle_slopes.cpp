// Stage relax: every sweep edge by edge.
#include <algorithm>

#include "tests/oracle.h"

namespace spoor::test {
namespace {

/// One pair of a matching: half of what the slope is too steep by, rounded up, as far as there is soil and room.
void exchangePair(DenseWorld& world, std::size_t a, std::size_t b, bool diagonal, const Parameters& parameters) {
  const bool down = world.height[a] > world.height[b];
  const std::size_t giver = down ? a : b, taker = down ? b : a;
  const MaterialRules& own = world.rulesOf(parameters, giver);
  const std::int64_t threshold = std::max(diagonal ? own.diagonal_threshold_q : own.slope_threshold_q, 1);
  const std::int64_t excess = std::int64_t(world.height[giver]) - world.height[taker] - threshold;
  if (excess <= 0) return;
  const auto moved =
      std::int32_t(std::min({(excess + 1) / 2, world.soil(giver), world.room(taker, parameters.obstacle_threshold_q)}));
  world.height[giver] -= moved;
  world.height[taker] += moved;
}

void exchangeSweep(DenseWorld& world, const Parameters& parameters) {
  struct Matching {
    int dx, dy;
    bool by_row;  // parity of the first cell's y, else of its x
    int parity;
  };
  constexpr Matching order[] = {{1, 0, false, 0}, {1, 0, false, 1}, {0, 1, true, 0},  {0, 1, true, 1},
                                {1, 1, true, 0},  {1, 1, true, 1},  {-1, 1, true, 0}, {-1, 1, true, 1}};
  for (const Matching& matching : order)
    for (int y = 0; y < world.inside_rows; ++y)
      for (int x = 0; x < world.inside_columns; ++x) {
        if (((matching.by_row ? y : x) & 1) != matching.parity) continue;
        if (!world.isActive(x, y) || !world.isActive(x + matching.dx, y + matching.dy)) continue;
        exchangePair(world, world.at(x, y), world.at(x + matching.dx, y + matching.dy),
                     matching.dx != 0 && matching.dy != 0, parameters);
      }
}

/// Calls visit(neighbour, is_diagonal) for the up to eight active neighbours of a cell.
template <typename Visit>
void visitNeighbours(const DenseWorld& world, int x, int y, Visit visit) {
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx)
      if ((dx != 0 || dy != 0) && world.isActive(x + dx, y + dy)) visit(world.at(x + dx, y + dy), dx != 0 && dy != 0);
}

/// The thesis's average rule: a cell's mean drop to the neighbours it gives to, times roughness, in equal parts.
void averageFromCell(const DenseWorld& before, const Parameters& parameters, int x, int y, DenseWorld& world) {
  constexpr std::int64_t kDropMost = (1 << 28) - 1;
  const std::size_t cell = before.at(x, y);
  const MaterialRules& own = before.rulesOf(parameters, cell);
  const int obstacle_threshold = parameters.obstacle_threshold_q;
  std::vector<std::size_t> takers;
  std::int64_t drops = 0;
  visitNeighbours(before, x, y, [&](std::size_t neighbour, bool) {
    const std::int64_t drop = std::int64_t(before.height[cell]) - before.height[neighbour];
    if (drop <= own.slope_threshold_q || before.room(neighbour, obstacle_threshold) == 0) return;
    takers.push_back(neighbour);
    drops += std::min(drop, kDropMost);
  });
  if (takers.empty()) return;
  const auto count = std::int64_t(takers.size());
  const std::int64_t moves = std::min(drops / count * own.roughness_q16 / kOneQ16, before.soil(cell));
  for (const std::size_t taker : takers) {
    const auto flow = std::int32_t(std::min(moves / count, before.room(taker, obstacle_threshold) / 8));
    world.height[cell] -= flow;
    world.height[taker] += flow;
  }
}

/// An eighth of what each slope down from a cell is too steep by, times roughness.
void fluxFromCell(const DenseWorld& before, const Parameters& parameters, int x, int y, DenseWorld& world) {
  const std::size_t cell = before.at(x, y);
  const MaterialRules& own = before.rulesOf(parameters, cell);
  visitNeighbours(before, x, y, [&](std::size_t neighbour, bool diagonal) {
    const std::int64_t threshold = diagonal ? own.diagonal_threshold_q : own.slope_threshold_q;
    const std::int64_t excess = std::int64_t(before.height[cell]) - before.height[neighbour] - threshold;
    if (excess <= 0) return;
    const std::int64_t most = std::min(before.soil(cell), before.room(neighbour, parameters.obstacle_threshold_q));
    const auto flow = std::int32_t(std::min(excess * own.roughness_q16 / kOneQ16, most) / 8);
    world.height[cell] -= flow;
    world.height[neighbour] += flow;
  });
}

}  // namespace

void oracleRelax(DenseWorld& world, const Parameters& parameters, int sweep_count, std::int32_t tick, int first_sweep) {
  for (int sweep = 0; sweep < sweep_count; ++sweep) {
    if (parameters.slopes == SlopeRule::drift) {
      oracleDrift(world, parameters, tick, first_sweep + sweep);
      continue;
    }
    if (parameters.slopes == SlopeRule::exchange) {
      exchangeSweep(world, parameters);
      continue;
    }
    const auto fromCell = parameters.slopes == SlopeRule::flux ? fluxFromCell : averageFromCell;
    const DenseWorld before = world;
    for (int y = 0; y < world.inside_rows; ++y)
      for (int x = 0; x < world.inside_columns; ++x)
        if (before.isActive(x, y)) fromCell(before, parameters, x, y, world);
  }
}

}  // namespace spoor::test
