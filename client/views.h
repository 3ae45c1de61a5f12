#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "client/camera.h"
#include "client/terrain_view.h"

namespace spoor {

/// Fixed cameras, framed by what there is: live tiles, bodies and their paths. The state must belong to the base's
/// pack.

/// Behind a body, along its heading, as far as the bodies that share its path are large. The pack must have bodies.
Camera followView(const TerrainView& view, int body_index);

/// A three-quarter view of the tracks where two paths cross (the crossing nearest to the middle of the live tiles), lit
/// from the side; where none do, of the live place on a path, or else the live tile, nearest to the middle.
Camera trailsView(const TerrainView& view, double sun_azimuth_deg);

/// Straight down on all live tiles, north up, orthographic.
Camera aboveView(const TerrainView& view, double aspect);

/// Down on what a picture of columns shows (columnCells about the middle of the live tiles), from the south and east.
Camera columnsView(const TerrainView& view);

/// The whole world from the air, from the south.
Camera overviewView(const TerrainView& view, double aspect);

/// How to look at a crater. at_once: down on it from beside, as large as it is; ground: by a man who stands before it;
/// inside: by one who stands in its cavity; above: straight down.
enum class CraterLook { at_once, ground, inside, above };

/// A crater of the state, lit from the side.
/// @param id  of the crater, below the state's count (asserted)
Camera craterView(const TerrainView& view, std::uint32_t id, CraterLook look, double sun_azimuth_deg, double aspect);

/// Bodies worth following: the first of each path.
std::vector<int> leadingBodies(const ScenePack& pack);

/// The ground's height at a place [m], bilinear between cell centres; the border's outside the world.
double groundHeight(const TerrainView& view, const glm::dvec2& place_m);

}  // namespace spoor
