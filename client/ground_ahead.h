#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "client/camera.h"
#include "client/terrain_view.h"

namespace spoor {

/// Where the middle of a view meets the ground [m]: the first place along its ray, within a kilometre and on the map.
/// Walked in steps of a hundredth of the way so far, a cell at least; what is thinner may be passed.
std::optional<glm::dvec2> groundAhead(const TerrainView& view, const Camera& camera);

}  // namespace spoor
