#include "client/png_file.h"

#include <fmt/format.h>
#include <png.h>

#include <cerrno>
#include <cstring>

#include "shared/base/assert.h"

namespace spoor {

Status writePng(const Image& image, const std::string& path) {
  const std::size_t pixels = std::size_t(image.width_px) * std::size_t(image.height_px);
  SPOOR_ASSERT(image.rgba.size() == pixels * 4);
  std::vector<std::uint8_t> rgb(pixels * 3);
  for (std::size_t i = 0; i < pixels; ++i) std::memcpy(&rgb[i * 3], &image.rgba[i * 4], 3);

  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = png_uint_32(image.width_px);
  png.height = png_uint_32(image.height_px);
  png.format = PNG_FORMAT_RGB;
  if (png_image_write_to_file(&png, path.c_str(), 0, rgb.data(), 0, nullptr) == 0)
    return Error{fmt::format("picture {}: {}{}", path, png.message,
                             errno != 0 ? fmt::format(" ({})", std::strerror(errno)) : "")};
  return {};
}

}  // namespace spoor
