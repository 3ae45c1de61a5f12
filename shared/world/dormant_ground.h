#pragma once

#include "shared/world/base_terrain.h"
#include "shared/world/crater_set.h"
#include "shared/world/snowfall.h"

namespace spoor {

/// Ground that nobody reached yet: the base with the craters of a set in it, never below bedrock, and on it what fell
/// by a tick, evenly: only live tiles' hollows are filled. Computed on demand; whoever looks
/// changes nothing. Borrows all. Thread-safe while the set does not change.
struct DormantGround {
  const BaseTerrain* base = nullptr;
  const CraterSet* craters = nullptr;  // nullptr: none
  std::span<const Snowfall> snowfalls = {};
  std::int32_t tick = 0;

  /// As BaseTerrain::fillArea; cells outside the world have height 0.
  void fillArea(std::int32_t x, std::int32_t y, std::int32_t stride, std::int32_t columns, std::int32_t rows,
                std::span<std::int32_t> height) const;
  void fillHeights(TileCoordinate tile, std::span<std::int32_t, rules::kTileCells> height) const;
  std::int32_t height(std::int32_t x, std::int32_t y) const;
};

}  // namespace spoor
