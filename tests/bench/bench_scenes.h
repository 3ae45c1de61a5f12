#pragma once

#include <string>
#include <vector>

#include "shared/world/pack.h"

namespace spoor {

/// Names for makeBenchScene.
std::vector<std::string> benchSceneNames();

/// Scenes made in code, for measuring without files:
///   car491   one body whose search domain is 491 x 491 cells: a plate on four wheels' footprints
///   slab491  the same domain with the whole underside in the soil: the worst case for `nearest`
///   pile     no body; the caller relaxes a column
///   car      a car of five bodies in 2048 x 2048 cells; car_wide: the same car in 65 536 x 65 536
ScenePack makeBenchScene(const std::string& name);

}  // namespace spoor
