#include "client/column_renderer.h"

#include <algorithm>

#include "shaders/host/shader_loader.h"
#include "shaders/render/frame.h"
#include "shaders/rules/limits.h"
#include "shared/base/assert.h"

namespace spoor {

namespace {

constexpr GLsizei kColumnVertices = 5 * 6;  // no bottom

}  // namespace

ColumnCells columnCells(const TerrainView& view, glm::ivec2 focus_cell) {
  const ScenePack& pack = view.base->pack();
  const glm::ivec2 world(pack.width_cells, pack.height_cells);
  ColumnCells cells;
  cells.count = glm::min(world, glm::ivec2(kColumnSideLimit));
  cells.first = glm::clamp(focus_cell - cells.count / 2, glm::ivec2(0), world - cells.count);
  // fillSamples takes whole tiles.
  const glm::ivec2 tile_first = cells.first / rules::kTileSize;
  const glm::ivec2 tile_end = (cells.first + cells.count + rules::kTileSize - 1) / rules::kTileSize;
  const SampleBox box{tile_first * rules::kTileSize, (tile_end - tile_first) * rules::kTileSize};
  std::vector<std::int32_t> all_q(std::size_t(box.count.x) * std::size_t(box.count.y));
  fillSamples(view, 0, box, all_q);
  const glm::ivec2 from = cells.first - box.first;
  for (int y = 0; y < cells.count.y; ++y) {
    const auto row = all_q.begin() + (from.y + y) * box.count.x + from.x;
    cells.height_q.insert(cells.height_q.end(), row, row + cells.count.x);
  }
  return cells;
}

ColumnRenderer::ColumnRenderer(const ColumnSettings& settings) : settings_(settings) {
  const bool whole_area = settings.lowest_q == settings.highest_q;
  SPOOR_ASSERT(whole_area || (settings.lowest_q < settings.middle_q && settings.middle_q < settings.highest_q));
  area_block_ = makeBuffer();
  glNamedBufferStorage(area_block_.name(), sizeof(render::ColumnArea), nullptr, GL_DYNAMIC_STORAGE_BIT);
  heights_ = makeBuffer();
  layout_ = makeVertexArray();
  glEnableVertexArrayAttrib(layout_.name(), 0);
  glVertexArrayAttribIFormat(layout_.name(), 0, 1, GL_INT, 0);
  glVertexArrayAttribBinding(layout_.name(), 0, 0);
  glVertexArrayBindingDivisor(layout_.name(), 0, 1);
  glVertexArrayVertexBuffer(layout_.name(), 0, heights_.name(), 0, sizeof(std::int32_t));
  program_ = makeProgram({"render/column.vert", "render/column.frag"});
}

void ColumnRenderer::draw(const TerrainView& view, glm::ivec2 focus_cell, const CameraFrame& frame) {
  const ColumnCells cells = columnCells(view, focus_cell);
  const auto [lowest, highest] = std::ranges::minmax_element(cells.height_q);
  const bool fixed = settings_.lowest_q < settings_.highest_q;
  const std::int32_t first_q = fixed ? settings_.lowest_q : *lowest, last_q = fixed ? settings_.highest_q : *highest;
  const std::int32_t middle_q = fixed ? settings_.middle_q : first_q + (last_q - first_q) / 2;
  // The feet show how thick the ground is, and never that it ends.
  const std::int32_t cell_q = view.base->pack().cell_q;
  const std::int32_t foot_q = std::min(first_q, *lowest) - std::max(2 * cell_q, (last_q - first_q) / 8);
  render::ColumnArea area;
  area.area = {cells.first - frame.origin_cell, cells.count};
  area.heights = {first_q, middle_q, last_q, foot_q};
  glNamedBufferSubData(area_block_.name(), 0, sizeof area, &area);
  glBindBufferBase(GL_UNIFORM_BUFFER, render::kColumnAreaBinding, area_block_.name());
  glNamedBufferData(heights_.name(), GLsizeiptr(cells.height_q.size() * sizeof(std::int32_t)), cells.height_q.data(),
                    GL_STREAM_DRAW);

  glUseProgram(program_.name());
  glBindVertexArray(layout_.name());
  glEnable(GL_CULL_FACE);  // the sides of neighbours lie in one plane, back to back
  // A call for each row: llvmpipe loses triangles of calls that make more than 65 536 vertices.
  for (int y = 0; y < cells.count.y; ++y) {
    glUniform1i(0, y);
    glDrawArraysInstancedBaseInstance(GL_TRIANGLES, 0, kColumnVertices, cells.count.x, GLuint(y * cells.count.x));
  }
  glDisable(GL_CULL_FACE);
}

}  // namespace spoor
