#pragma once

#include <compare>
#include <cstdint>

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

/// Cells [x0, x1) x [y0, y1).
struct CellBox {
  std::int32_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  bool empty() const { return x0 >= x1 || y0 >= y1; }
  bool meets(const CellBox& other) const { return x0 < other.x1 && other.x0 < x1 && y0 < other.y1 && other.y0 < y1; }
  bool operator==(const CellBox&) const = default;
};

}  // namespace spoor
