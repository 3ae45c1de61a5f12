#pragma once

#include <functional>
#include <string>
#include <vector>

#include "server/crater_feed.h"
#include "server/parameter_changes.h"
#include "server/snowfall_feed.h"
#include "shared/codec/session.h"
#include "shared/sim/simulation.h"

namespace spoor {

struct LoopOptions {
  std::int32_t ticks = 0;
  double rate_hz = 60;                         // ticks per second; 0: as fast as they go
  std::vector<ParameterChange> changes = {};   // of one tick: in this order; before those of the console
  ChangeQueue* console = nullptr;              // may be nullptr
  std::vector<TimedCrater> craters = {};       // besides the scene's
  CraterQueue* console_craters = nullptr;      // may be nullptr
  std::vector<TimedSnowfall> snowfalls = {};   // besides the scene's
  SnowfallQueue* console_snowfalls = nullptr;  // may be nullptr
};

/// Figures of a session: of its last kTicksKept ticks, so that a long session does not grow, in no particular order.
struct LoopFigures {
  static constexpr std::size_t kTicksKept = 1 << 16;

  std::vector<double> tick_ms;  // commands to delta
  std::array<std::vector<double>, kStageCount> stage_ms;
  std::vector<double> active_cells;
  std::int32_t late_ticks = 0;  // that began after their time
  std::int32_t too_fast_ticks = 0;
  std::int32_t waiting_ticks = 0;     // in which more tiles were awake than a tick may simulate
  std::int32_t unbalanced_ticks = 0;  // whose ledger error was not 0
  std::int64_t kept_back = 0;         // TickEffect::kept_back of all ticks
  std::int64_t craters = 0;           // that came
  std::int64_t craters_refused = 0;   // that did not, although scene, console or clients brought them here
  std::int64_t snowfalls = 0;         // that came, besides the scene's
  std::int64_t snowfalls_refused = 0;
  double wall_s = 0;
};

/// Runs a session's ticks: poses from the script, parameters where they change, craters, snowfalls, one step, then to
/// the network and the session file. Waits for nothing but the clock. `host` and `writer` may be nullptr. Progress,
/// about once a second, goes to `say`, and so does each change of parameters and each crater and each snowfall that is
/// not the scene's. What cannot be is said and changes nothing. Of one tick, craters come in this order: the scene's,
/// those of `options`, the console's, the clients' by (client, sequence).
LoopFigures runTicks(Simulation& simulation, const BaseTerrain& base, const LoopOptions& options, SessionHost* host,
                     SessionWriter* writer, const std::function<void(const std::string&)>& say);

}  // namespace spoor
