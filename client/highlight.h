#pragma once

#include <span>
#include <vector>

#include "client/camera.h"
#include "shaders/host/gl_objects.h"
#include "shared/world/base_terrain.h"

namespace spoor {

/// Tiles that a picture marks, as a mask on the graphics card round the camera. Tiles 128 and more from the origin
/// cell's are not marked.
class Highlight {
 public:
  Highlight();

  /// From now on these tiles, and no others.
  void set(std::span<const TileCoordinate> tiles) { tiles_.assign(tiles.begin(), tiles.end()); }
  bool empty() const { return tiles_.empty(); }

  /// Fills the mask for a picture and binds it.
  void update(const CameraFrame& frame);

 private:
  std::vector<TileCoordinate> tiles_;
  GlTexture mask_;
};

}  // namespace spoor
