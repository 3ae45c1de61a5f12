#pragma once

#include <cstdint>

#include "shared/world/pack.h"

namespace spoor {

/// Height of noise ground at a cell, 0.1 mm, within [lowest_q, highest_q].
/// Gradient noise on a square lattice, quintic fade, `octaves` summed, all in integers.
/// Source: Perlin 2002 (fade, gradients), as the dunes of the seed post; the integer form is ours.
std::int32_t noiseHeight(const NoiseBase& noise, std::int32_t x, std::int32_t y);

}  // namespace spoor
