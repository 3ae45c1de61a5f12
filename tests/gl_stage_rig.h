#pragma once

#include "tests/stage_rig.h"

namespace spoor::test {

/// The compute shaders, with a hand-made plan in place of planTick. See makeStageRig.
std::unique_ptr<StageRig> makeGlStageRig(const BackendCase& backend_case, const World& world,
                                         std::vector<TileCoordinate> active);

}  // namespace spoor::test
