#pragma once

#include <array>

#include "shaders/rules/drift.h"
#include "shared/sim/plan.h"

namespace spoor {

/// The numbers of rules/drift.h that all sweeps of a tick have in common.
struct DriftSweep {
  rules::DriftStep step;
  std::array<rules::DriftNumbers, kMaterialsLimit> materials;  // of as many as there are
};

/// @param parameters  valid for the pack
DriftSweep driftSweep(const ScenePack& pack, const Parameters& parameters);

/// Does any body of a sub-step push? Only under rule `drift`.
bool anyPush(const SubStep& sub_step, const Parameters& parameters);

/// Bound of one body's push, so that those of all bodies of a sub-step together fit an int.
std::int32_t pushLimit(const SubStep& sub_step);

}  // namespace spoor
