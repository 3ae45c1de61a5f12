#pragma once

#include "shaders/host/gl_programs.h"
#include "shaders/sim/tables.h"
#include "shared/sim/backend.h"

namespace spoor {

/// Fills in what a tick did, as far as the shaders tell it: cells, pairs, soil kept back, bytes moved.
/// @param head          as the stages left it
/// @param crater_cells  of boxes that new craters may change
/// @param effect        in: domain_cells, and as bytes_moved what whole domains were read and written for
void fillFigures(const TickPlan& plan, const rules::TickHead& head, std::int64_t tile_count, std::int64_t crater_cells,
                 RelaxSchedule schedule, TickEffect& effect);

}  // namespace spoor
