#pragma once

#include <string>
#include <vector>

#include "server/import/dem.h"
#include "shared/base/result.h"
#include "shared/world/pack.h"

namespace spoor {

inline constexpr double kDefaultReposeDeg = 35;

/// Fills the slope thresholds of a pack from its cell size and the angle of repose. Adds a note where a cell is so
/// small that a threshold had to be rounded up to 1.
/// @param repose_deg  0 .. 89
/// Departs from the thesis's atan(dh) / d > s: see DESIGN.md, invariant 1.
void setReposeAngle(ScenePack& pack, double repose_deg, std::vector<std::string>& notes);

/// Sets the number of cells of the world from its size. Errors: less than a cell, or more than a pack allows.
[[nodiscard]] Status setWorldSize(ScenePack& pack, double width_m, double height_m);

/// Makes a DEM the ground of a pack, whose cell size, thresholds and number of cells are set. Notes where the world
/// reaches beyond the DEM and where slopes between samples are too steep to rest.
[[nodiscard]] Status setGround(ScenePack& pack, Dem dem, const std::string& file, std::vector<std::string>& notes);

/// The last word on a pack: validatePack, and whether its bytes stay below kPackBytesLimit.
[[nodiscard]] Status checkPack(const ScenePack& pack);

}  // namespace spoor
