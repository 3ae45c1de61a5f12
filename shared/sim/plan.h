#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shaders/rules/place.h"
#include "shared/base/result.h"
#include "shared/codec/tile_codec.h"

namespace spoor {

/// A body's mesh in one pose, ready for the raster: points are subcells relative to cell (origin_x, origin_y) and
/// height units relative to z_q.
struct PlacedBody {
  std::int32_t body_index = 0;
  std::int32_t origin_x = 0, origin_y = 0;
  std::int32_t z_q = 0;
  rules::Placement placement;
  CellBox box;  // every cell that the mesh can cover, clipped to the world
  std::vector<rules::RasterPoint> points;
  // For drift: force times the side of a cell, newtons * 0.1 mm, and the horizontal direction, Q30, in which the body
  // came here from where it was a sub-step earlier; 0 where it did not move.
  std::int64_t force_cell = 0;
  std::int32_t direction_x_q30 = 0, direction_y_q30 = 0;
};

/// A rectangle in which displaced soil finds its targets: joined boxes of bodies, grown by one cell and by what spread
/// displacement reaches; without active areas the whole world.
struct Domain {
  CellBox box;
  std::vector<int> bodies;  // indices into SubStep::bodies
};

/// Stages 4 to 8 once: where the bodies are, and how many sweeps follow.
struct SubStep {
  std::vector<PlacedBody> bodies;
  std::vector<Domain> domains;  // disjoint, in (y0, x0) order
  int sweep_count = 0;
};

/// What a tick simulates. A function of state and input, never of batching (DESIGN.md, "Active").
struct TickPlan {
  std::int32_t tick = 0;
  Parameters parameters;
  std::vector<TileCoordinate> active;   // in (y, x) order
  std::vector<TileCoordinate> in_snow;  // that are awake and take snow in this tick (tilesInSnow), in (y, x) order
  std::size_t first_new_crater = 0;     // those of the state's set from here on come with this tick
  SubStep stood;                        // moving bodies where they were before the tick, a domain for each, which may
                                        // overlap; cells that they covered take no soil in the first sub-step
  std::vector<SubStep> sub_steps;       // none where nothing is active
  std::vector<TileCoordinate> waiting;  // awake, or neighbours of such, and too many for this tick; in (y, x) order
  bool too_fast = false;  // a body moves farther than one cell per sub-step, at the most sub-steps there are
};

inline constexpr int kSubStepLimit = 32;

/// A body of the pack in a pose (valid). Vertices are placed to the subcell below.
PlacedBody placeBody(const ScenePack& pack, int body_index, const Pose& pose);

/// For each body the largest distance of a vertex from its mesh's origin, 0.1 mm, rounded up.
std::vector<std::int32_t> bodyReaches(const ScenePack& pack);

// What a tick may ask for. Far beyond real time; a bound for what bytes from outside can make a machine do.
inline constexpr std::int64_t kDomainSideLimit = kWholeWorldSideLimit;    // cells; also what rules/nearest.h can search
inline constexpr std::int64_t kDomainCellsLimit = kWholeWorldCellsLimit;  // of one domain

/// Stage active: which tiles and bodies take part in the tick that leads from `state` to the given poses (valid).
/// @param reach_q     bodyReaches
/// @param parameters  of this tick (valid)
/// @param craters     that come with this tick (valid); live tiles that they meet are active
/// @param tile_limit  tiles at most. Where more are awake the rest waits; which, depends on the tick's number
/// Errors: touching bodies join to a domain over the limits, or bodies and craters alone meet too many tiles, or
/// would leave more than kSnapshotTilesLimit live.
Result<TickPlan> planTick(const ScenePack& pack, std::span<const std::int32_t> reach_q, const WorldState& state,
                          std::span<const Pose> poses, const Parameters& parameters,
                          std::span<const Crater> craters = {}, std::size_t tile_limit = kTickTilesLimit);

}  // namespace spoor
