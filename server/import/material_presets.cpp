#include "server/import/material_presets.h"

#include "shared/base/assert.h"

namespace spoor {

std::span<const MaterialPreset> materialPresets() {
  using enum MaterialTexture;
  // Name, colour, texture, grain size and height, repose, compression and its limit, D, 1/zeta. Angles are 2/5, 1/3 and
  // 1/4 pi in the paper.
  static constexpr MaterialPreset list[] = {
      {"mud", "#5b4331", mud, 0, 0, 72, 0, 0, 0.25, 6e-4},
      {"pebbles", "#8d8a83", pebbles, 0.03, 0.012, 60, 0, 0, 0.9, 3e-4},
      {"sand", "#d8bc8a", sand, 0, 0, 45, 0, 0, 1, 4e-4},
      {"snow", "#ecf0f5", snow, 0, 0, 50, 0.8, 0.6, 0.5, 5e-4},
      {"dust", "#b7a793", dust, 0, 0, 40, 0.5, 0.4, 1, 8e-4},
      {"gravel", "#8a8378", gravel, 0.015, 0.006, 38, 0.05, 0.1, 0.9, 3e-4},
  };
  return list;
}

const std::vector<std::string>& textureNames() {
  static const std::vector<std::string> names = {"plain",  "snow", "sand", "mud",  "pebbles",
                                                 "gravel", "dust", "dirt", "grass"};
  SPOOR_ASSERT(names.size() == std::size_t(kMaterialTextureCount));
  return names;
}

}  // namespace spoor
