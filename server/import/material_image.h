#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "shared/base/result.h"

namespace spoor {

/// What a sample of an image stands for: a colour, or a value of its first band.
struct LegendEntry {
  std::optional<std::array<std::uint8_t, 3>> colour;
  double value = 0;  // where there is no colour
  std::uint8_t material = 0;
};

struct MaterialImageRequest {
  std::string file;
  std::vector<LegendEntry> legend;
  std::optional<std::uint8_t> otherwise;  // of samples that the legend does not name
};

/// Numbers of materials, [row_count * column_count], first row in the south.
struct MaterialSamples {
  std::int32_t column_count = 0, row_count = 0;
  std::vector<std::uint8_t> material;
};

inline constexpr std::int64_t kMaterialSamplesLimit = 1 << 26;

/// Reads a raster through GDAL. Colours are those of its first three bands, of its palette or grey, 8 bits each. The
/// first row is the north, but where the file's georeference says otherwise.
/// Errors: a file that GDAL cannot open or read to its end, one that is too large, colours asked of a raster without, a
/// sample that neither legend nor `otherwise` names: which one, and what it holds.
Result<MaterialSamples> readMaterialImage(const MaterialImageRequest& request);

}  // namespace spoor
