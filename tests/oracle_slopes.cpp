// Stage relax: every sweep edge by edge.
#include <algorithm>

#include "tests/oracle.h"

namespace spoor::test {
namespace {

/// What a cell can take.
std::int64_t roomOf(const DenseWorld& world, std::size_t cell, const Parameters& parameters) {
  const std::int64_t gap = std::int64_t(world.underside[cell]) - world.height[cell];
  return gap > parameters.obstacle_threshold_q ? gap : 0;
}

std::int64_t soilOf(const DenseWorld& world, std::size_t cell) {
  return std::int64_t(world.height[cell]) - world.bedrock[cell];
}

bool isActive(const DenseWorld& world, int x, int y) { return world.inside(x, y) && world.active[world.at(x, y)] != 0; }

/// One pair of a matching: half of what the slope is too steep by, rounded up, as far as there is soil and room.
void exchangePair(DenseWorld& world, std::size_t a, std::size_t b, std::int64_t threshold,
                  const Parameters& parameters) {
  const bool down = world.height[a] > world.height[b];
  const std::size_t giver = down ? a : b, taker = down ? b : a;
  const std::int64_t excess =
      std::int64_t(world.height[giver]) - world.height[taker] - std::max<std::int64_t>(threshold, 1);
  if (excess <= 0) return;
  const auto moved = std::int32_t(std::min({(excess + 1) / 2, soilOf(world, giver), roomOf(world, taker, parameters)}));
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
        if (!isActive(world, x, y) || !isActive(world, x + matching.dx, y + matching.dy)) continue;
        const bool diagonal = matching.dx != 0 && matching.dy != 0;
        exchangePair(
            world, world.at(x, y), world.at(x + matching.dx, y + matching.dy),
            diagonal ? parameters.materials[0].diagonal_threshold_q : parameters.materials[0].slope_threshold_q,
            parameters);
      }
}

/// Calls visit(neighbour, is_diagonal) for the up to eight active neighbours of a cell.
template <typename Visit>
void visitNeighbours(const DenseWorld& world, int x, int y, Visit visit) {
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx)
      if ((dx != 0 || dy != 0) && isActive(world, x + dx, y + dy)) visit(world.at(x + dx, y + dy), dx != 0 && dy != 0);
}

/// The thesis's average rule: a cell's mean drop to the neighbours it gives to, times roughness, in equal parts.
void averageFromCell(const DenseWorld& before, const Parameters& parameters, int x, int y, DenseWorld& world) {
  constexpr std::int64_t kDropMost = (1 << 28) - 1;
  const std::size_t cell = before.at(x, y);
  std::vector<std::size_t> takers;
  std::int64_t drops = 0;
  visitNeighbours(before, x, y, [&](std::size_t neighbour, bool) {
    const std::int64_t drop = std::int64_t(before.height[cell]) - before.height[neighbour];
    if (drop <= parameters.materials[0].slope_threshold_q || roomOf(before, neighbour, parameters) == 0) return;
    takers.push_back(neighbour);
    drops += std::min(drop, kDropMost);
  });
  if (takers.empty()) return;
  const auto count = std::int64_t(takers.size());
  const std::int64_t moves =
      std::min(drops / count * parameters.materials[0].roughness_q16 / kOneQ16, soilOf(before, cell));
  for (const std::size_t taker : takers) {
    const auto flow = std::int32_t(std::min(moves / count, roomOf(before, taker, parameters) / 8));
    world.height[cell] -= flow;
    world.height[taker] += flow;
  }
}

/// An eighth of what each slope down from a cell is too steep by, times roughness.
void fluxFromCell(const DenseWorld& before, const Parameters& parameters, int x, int y, DenseWorld& world) {
  const std::size_t cell = before.at(x, y);
  visitNeighbours(before, x, y, [&](std::size_t neighbour, bool diagonal) {
    const std::int64_t threshold =
        diagonal ? parameters.materials[0].diagonal_threshold_q : parameters.materials[0].slope_threshold_q;
    const std::int64_t excess = std::int64_t(before.height[cell]) - before.height[neighbour] - threshold;
    if (excess <= 0) return;
    const std::int64_t most = std::min(soilOf(before, cell), roomOf(before, neighbour, parameters));
    const auto flow = std::int32_t(std::min(excess * parameters.materials[0].roughness_q16 / kOneQ16, most) / 8);
    world.height[cell] -= flow;
    world.height[neighbour] += flow;
  });
}

}  // namespace

void oracleRelax(DenseWorld& world, const Parameters& parameters, int sweep_count) {
  for (int sweep = 0; sweep < sweep_count; ++sweep) {
    if (parameters.slopes == SlopeRule::exchange) {
      exchangeSweep(world, parameters);
      continue;
    }
    const auto fromCell = parameters.slopes == SlopeRule::flux ? fluxFromCell : averageFromCell;
    const DenseWorld before = world;
    for (int y = 0; y < world.inside_rows; ++y)
      for (int x = 0; x < world.inside_columns; ++x)
        if (isActive(before, x, y)) fromCell(before, parameters, x, y, world);
  }
}

}  // namespace spoor::test
