#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "shared/world/material.h"

namespace spoor {

/// A ready-made material, as [[material]]'s preset names it: what its keys would say, before they become integers.
struct MaterialPreset {
  std::string_view name;
  std::string_view colour;  // "#rrggbb"
  MaterialTexture texture;
  double grain_size_m, grain_height_m;
  double repose_deg;
  double compression, compaction_limit;
  double diffusion;         // D
  double friction_inverse;  // 1/zeta
};

/// Mud, pebbles and sand move as in Gilardi et al., figure 4; the others, and all looks, are ours.
std::span<const MaterialPreset> materialPresets();

/// Names of the textures, by number.
const std::vector<std::string>& textureNames();

}  // namespace spoor
