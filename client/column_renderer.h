#pragma once

#include <cstdint>
#include <vector>

#include "client/camera.h"
#include "client/terrain_view.h"
#include "shaders/host/gl_objects.h"

namespace spoor {

/// How cells are shown as columns.
struct ColumnSettings {
  // Heights of the first, the pale middle and the last colour (heightColour in shaders/render/height_colour.h), 0.1 mm,
  // in rising order; all the same: the lowest and the highest that the area holds, and midway between them.
  std::int32_t lowest_q = 0;
  std::int32_t middle_q = 0;
  std::int32_t highest_q = 0;
};

inline constexpr int kColumnSideLimit = 256;

/// Cells that are shown as columns: a square of kColumnSideLimit round the focus, moved into the world and cut to it.
struct ColumnCells {
  glm::ivec2 first{0};
  glm::ivec2 count{0};
  std::vector<std::int32_t> height_q;  // row-major [count.x * count.y]
};
ColumnCells columnCells(const TerrainView& view, glm::ivec2 focus_cell);

/// Draws cells as vertical bars, coloured by height.
class ColumnRenderer {
 public:
  explicit ColumnRenderer(const ColumnSettings& settings);

  /// Draws into the bound framebuffer. The frame block must be bound.
  void draw(const TerrainView& view, glm::ivec2 focus_cell, const CameraFrame& frame);

 private:
  ColumnSettings settings_;
  GlBuffer area_block_, heights_;
  GlVertexArray layout_;
  GlProgram program_;
};

}  // namespace spoor
