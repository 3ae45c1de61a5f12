#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "shared/base/result.h"

namespace spoor {

/// A picture, first row on top, four bytes a pixel: red, green, blue, and 255 where something was drawn (0: sky).
struct Image {
  int width_px = 0;
  int height_px = 0;
  std::vector<std::uint8_t> rgba;
};

/// Writes red, green and blue; the same picture gives the same bytes.
[[nodiscard]] Status writePng(const Image& image, const std::string& path);

}  // namespace spoor
