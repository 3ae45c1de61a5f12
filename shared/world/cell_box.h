#pragma once

#include <cstdint>

namespace spoor {

/// Cells [x0, x1) x [y0, y1).
struct CellBox {
  std::int32_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  bool empty() const { return x0 >= x1 || y0 >= y1; }
  bool meets(const CellBox& other) const { return x0 < other.x1 && other.x0 < x1 && y0 < other.y1 && other.y0 < y1; }
  bool operator==(const CellBox&) const = default;
};

}  // namespace spoor
