#pragma once

#include <functional>
#include <string>
#include <vector>

#include "server/session_host.h"
#include "shared/codec/session.h"
#include "shared/sim/simulation.h"

namespace spoor {

struct LoopOptions {
  std::int32_t ticks = 0;
  double rate_hz = 60;  // 0: as fast as it goes
};

/// Figures of a session, tick by tick.
struct LoopFigures {
  std::vector<double> tick_ms;                                  // commands to delta, [ticks]
  std::array<std::vector<double>, kStageCount> stage_ms;        // [stages][ticks]
  std::vector<std::int64_t> active_cells;                       // [ticks]
  std::int32_t late_ticks = 0;                                  // that began after their time
  std::int32_t too_fast_ticks = 0;
  std::int32_t unbalanced_ticks = 0;                            // whose ledger error was not 0
  double wall_s = 0;
};

/// Runs a session's ticks: poses from the script, one step, then to the network and the session file. Waits for
/// nothing but the clock. `host` and `writer` may be nullptr. Progress, about once a second, goes to `say`.
LoopFigures runTicks(Simulation& simulation, const BaseTerrain& base, const LoopOptions& options, SessionHost* host,
                     SessionWriter* writer, const std::function<void(const std::string&)>& say);

}  // namespace spoor
