#pragma once

#include <memory>
#include <string>
#include <vector>

#include "shared/base/kernels.h"
#include "shared/base/thread_pool.h"
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
  std::int64_t dispatches = 0;         // of compute shaders
  std::int64_t bytes_to_device = 0;    // over the bus, where the backend has one
  std::int64_t bytes_from_device = 0;
  StageTimes stage_ms{};
};

/// Bytes that a backend holds besides the state.
struct BackendMemory {
  std::int64_t host_bytes = 0;
  std::int64_t device_bytes = 0;
};

/// Runs stages 4 to 9 of planned ticks, on one state until forget(). Backends differ in schedule only: the same state and plan give the
/// same bits. One thread at a time, any thread.
class Backend {
 public:
  virtual ~Backend() = default;
  virtual std::string name() const = 0;
  /// What computes besides the processor, as its driver names it; "none (native)" where nothing does.
  virtual std::string renderer() const = 0;

  /// Takes the state's tiles to the new tick: their versions, hashes, sums and wake masks, and the state's sums. The
  /// cells themselves, and the effect's differences, may follow with collect().
  /// Errors, which leave the state untouched: a device that is lost or has not the memory.
  virtual Result<TickEffect> run(const TickPlan& plan, const BaseTerrain& base, WorldState& state) = 0;

  /// Brings the cells that the oldest uncollected run changed to the state's tiles, and fills in the differences of
  /// its changes. One run may be uncollected when the next one begins (asserted).
  /// Errors: the device is lost; the state is then of no further use.
  [[nodiscard]] virtual Status collect(WorldState& state, std::vector<TileChange>& changes) = 0;

  /// Drops everything kept of a state, runs not collected too: the next run may be on another one.
  virtual void forget() = 0;

  virtual BackendMemory memory() const = 0;
};

struct NativeOptions {
  int thread_count = 0;              // 0: one for each processor
  const Kernels* kernels = nullptr;  // nullptr: the fastest that this processor runs
  bool skip_settled = true;          // false: every sweep visits every pair (for measuring; the same bits)
};
std::unique_ptr<Backend> makeNativeBackend(const NativeOptions& options = {});

/// The active tiles of a plan in its order, dormant ones made live; `made_live` lists those.
std::vector<Tile*> takeTiles(const TickPlan& plan, const BaseTerrain& base, WorldState& state, ThreadPool& pool,
                             std::vector<Tile*>& made_live);

/// What a tick did to one active tile. Where no cell changed the box is empty and the sums do not matter.
struct TileOutcome {
  TileChange change;  // box, and difference where it is known already
  std::uint64_t hash = 0;
  std::int64_t ground = 0;
};

/// Ends a tick: takes active tiles to its versions, hashes, sums and wake masks, and keeps the state's sums.
/// @param tiles  takeTiles, with as many outcomes
/// @return       what changed: the outcomes' changes with all but their difference filled in
std::vector<TileChange> commitTick(const TickPlan& plan, int sweeps_per_tick, const std::vector<Tile*>& tiles,
                                   const std::vector<Tile*>& made_live, std::vector<TileOutcome> outcomes,
                                   WorldState& state);

}  // namespace spoor
