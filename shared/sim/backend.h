#pragma once

#include <memory>
#include <string>
#include <vector>

#include "shared/base/kernels.h"
#include "shared/codec/tile_codec.h"
#include "shared/sim/plan.h"
#include "shared/sim/stage.h"

namespace spoor {

/// What stages 4 to 9 did.
struct TickEffect {
  std::vector<TileChange> changes;     // in (y, x) order: tiles whose cells or wake mask changed, or that became live
  std::int64_t active_cells = 0;       // cells of active tiles
  std::int64_t domain_cells = 0;       // cells of search domains, of all sub-steps
  std::int64_t penetrating_cells = 0;  // of all sub-steps
  std::int64_t pairs_visited = 0;      // by the relaxation; a whole sweep visits about four per active cell
  std::int64_t bytes_moved = 0;        // read and written by the stages, from the counts above; no cache is assumed
  StageTimes stage_ms{};
};

/// Runs stages 4 to 9 of a planned tick on a state: takes its tiles to the new tick and keeps its sums. Backends differ
/// in schedule only: the same state and plan give the same bits.
class Backend {
 public:
  virtual ~Backend() = default;
  virtual std::string name() const = 0;
  virtual TickEffect run(const TickPlan& plan, const BaseTerrain& base, WorldState& state) = 0;
};

struct NativeOptions {
  int thread_count = 0;              // 0: one for each processor
  const Kernels* kernels = nullptr;  // nullptr: the fastest that this processor runs
  bool skip_settled = true;          // false: every sweep visits every pair (for measuring; the same bits)
};
std::unique_ptr<Backend> makeNativeBackend(const NativeOptions& options = {});

/// The backend of a name: native, or auto for the best that this build and machine have. Errors: any other name.
Result<std::unique_ptr<Backend>> makeBackend(const std::string& name, const NativeOptions& options = {});

}  // namespace spoor
