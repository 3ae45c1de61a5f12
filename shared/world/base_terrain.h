#pragma once

#include <cstdint>
#include <span>

#include "shaders/rules/limits.h"
#include "shared/world/pack.h"

namespace spoor {

/// Coordinates of a tile: cell coordinates / kTileSize. Ordered by row, then column.
struct TileCoordinate {
  std::int32_t x = 0;
  std::int32_t y = 0;
  friend bool operator==(const TileCoordinate&, const TileCoordinate&) = default;
  friend auto operator<=>(const TileCoordinate& a, const TileCoordinate& b) {
    if (a.y != b.y) return a.y <=> b.y;
    return a.x <=> b.x;
  }
};

/// The undisturbed ground of a pack, computed on demand, any part of any size of world. Thread-safe (const).
/// Cells outside the world have height 0.
class BaseTerrain {
 public:
  /// The pack must be valid and outlive this.
  explicit BaseTerrain(const ScenePack& pack) : pack_(&pack) {}

  /// Heights of a tile, row-major [kTileCells], 0.1 mm: bedrock + soil depth.
  void fillHeights(TileCoordinate tile, std::span<std::int32_t, rules::kTileCells> height) const;

  /// Every `stride`-th cell from (x, y) on, row-major [rows * columns]: for views from afar.
  void fillArea(std::int32_t x, std::int32_t y, std::int32_t stride, std::int32_t columns, std::int32_t rows,
                std::span<std::int32_t> height) const;

  std::int32_t height(std::int32_t x, std::int32_t y) const;

  /// Height at a point between cell centres (0.1 mm units from the south-west corner): bilinear, rounded down.
  /// Points outside the world take the nearest cell's.
  std::int32_t heightAt(std::int32_t x_q, std::int32_t y_q) const;

  const ScenePack& pack() const { return *pack_; }

 private:
  const ScenePack* pack_;
};

}  // namespace spoor
