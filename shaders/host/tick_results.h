#pragma once

#include <cstdint>

#include "shaders/sim/tables.h"
#include "shared/sim/backend.h"

namespace spoor {

// What the shaders tell of a tick's tiles, as the state takes it.

/// @param tile      with its compacted soil as of the tick before
/// @param compacts  does the tick?
/// @return          of all planes
std::uint64_t hashOf(const rules::TileResult& result, const Tile& tile, bool compacts);

/// @param tile  as above
TileOutcome outcomeOf(const rules::TileResult& result, const Tile& tile, bool compacts);

/// What craters added to a tile, 0.1 mm * cells.
std::int64_t gainedOf(const rules::CraterTile& tile);

/// The box of a change's cells.
CellBox boxOf(const TileChange& change);

/// Adds differences of a box's cells, row-major, to a tile's.
void addBox(PlaneCells& cells, const CellBox& box, const std::int32_t* differences);

}  // namespace spoor
