#include "client/highlight.h"

#include <cstdint>
#include <cstdlib>

#include "shaders/render/frame.h"
#include "shaders/rules/limits.h"

namespace spoor {

using render::kHighlightTiles;

// What highlight.glsl shifts by.
static_assert(rules::kTileSize == 1 << 6);

Highlight::Highlight() {
  mask_ = makeTexture(GL_TEXTURE_2D);
  glTextureStorage2D(mask_.name(), 1, GL_R8, kHighlightTiles, kHighlightTiles);
  glTextureParameteri(mask_.name(), GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTextureParameteri(mask_.name(), GL_TEXTURE_MAG_FILTER, GL_NEAREST);
}

void Highlight::update(const CameraFrame& frame) {
  glBindTextureUnit(render::kHighlightUnit, mask_.name());
  if (tiles_.empty()) return;
  std::vector<std::uint8_t> mask(std::size_t(kHighlightTiles) * kHighlightTiles, 0);
  const glm::ivec2 middle = frame.origin_cell >> 6;
  for (const TileCoordinate tile : tiles_) {
    if (std::abs(tile.x - middle.x) >= kHighlightTiles / 2 || std::abs(tile.y - middle.y) >= kHighlightTiles / 2)
      continue;
    mask[std::size_t(tile.y & (kHighlightTiles - 1)) * kHighlightTiles + (tile.x & (kHighlightTiles - 1))] = 255;
  }
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTextureSubImage2D(mask_.name(), 0, 0, 0, kHighlightTiles, kHighlightTiles, GL_RED, GL_UNSIGNED_BYTE, mask.data());
}

}  // namespace spoor
