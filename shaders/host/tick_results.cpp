#include "shaders/host/tick_results.h"

namespace spoor {
namespace {

std::uint64_t joined(const rules::uint (&halves)[2]) { return halves[0] + (std::uint64_t(halves[1]) << 16); }

}  // namespace

std::uint64_t hashOf(const rules::TileResult& result, const Tile& tile, bool compacts) {
  std::uint64_t hash = joined(result.hash_low) + (joined(result.hash_high) << 32);
  hash += planeHash(tile.at, Plane::material, tile.material());  // which no tick changes
  // What was compacted in earlier ticks is on the device only where this one compacts.
  return compacts ? hash : hash + planeHash(tile.at, Plane::compacted, tile.compacted());
}

TileOutcome outcomeOf(const rules::TileResult& result, const Tile& tile, bool compacts) {
  TileOutcome outcome;
  if (result.x1 == 0) return outcome;
  outcome.change.x = std::uint8_t(result.x0);
  outcome.change.y = std::uint8_t(result.y0);
  outcome.change.width = std::uint8_t(result.x1 - result.x0);
  outcome.change.height = std::uint8_t(result.y1 - result.y0);
  outcome.hash = hashOf(result, tile, compacts);
  outcome.compacted = compacts ? std::int64_t(joined(result.compacted)) : tile.compacted_sum;
  outcome.ground = std::int64_t(joined(result.height)) - (std::int64_t(rules::kTileCells) << 30);
  return outcome;
}

std::int64_t gainedOf(const rules::CraterTile& tile) {
  const std::int64_t cells = std::int64_t(tile.x1 - tile.x0) * (tile.y1 - tile.y0);
  return std::int64_t(joined(tile.gained)) - (cells << 31);
}

CellBox boxOf(const TileChange& change) {
  return {change.x, change.y, change.x + change.width, change.y + change.height};
}

void addBox(PlaneCells& cells, const CellBox& box, const std::int32_t* differences) {
  for (int y = box.y0; y < box.y1; ++y)
    for (int x = box.x0; x < box.x1; ++x) cells[std::size_t(y * rules::kTileSize + x)] += *differences++;
}

}  // namespace spoor
