#pragma once

#include <string>
#include <vector>

#include "shared/world/pack.h"

namespace spoor {

/// The materials of Gilardi et al., figure 4, with their numbers, and snow.
enum class DriftMaterial { mud, pebbles, sand, snow };

/// An axle with two wheels that rolls across a field of 512 x 512 cells, soil moved by drift and diffusion.
/// @param materials  one for all of the field, or several in strips across the way, their borders winding
ScenePack driftTracksPack(const std::vector<DriftMaterial>& materials);

/// The same in mud, and after the axle has passed it snows until its tracks are filled.
inline constexpr std::int32_t kTracksTicks = 330;  // until the axle has passed
inline constexpr std::int32_t kSnowTicks = 900;    // until it has snowed
ScenePack snowedTracksPack();

/// A snowball that grows to four times its size as it rolls.
ScenePack growingBallPack();

/// A field of `side_cells` squared with one pushing body, all of it simulated in every tick by one sweep of drift: what
/// Gilardi et al. measure in table 1.
ScenePack driftMeasurePack(std::int32_t side_cells);

}  // namespace spoor
