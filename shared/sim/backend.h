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
  std::int64_t kept_back = 0;  // soil that bodies overlap and that found no room, or had not got out yet, at the end of
                               // each sub-step; 0.1 mm * cells, of all sub-steps
  std::int64_t pairs_visited = 0;    // by the relaxation; a whole sweep visits about four per active cell
  std::int64_t bytes_moved = 0;      // read and written by the stages, from the counts above; no cache is assumed
  std::int64_t relax_bytes = 0;      // of these, by the relaxation
  std::int64_t dispatches = 0;       // of compute shaders
  std::int64_t bytes_to_device = 0;  // over the bus, where the backend has one
  std::int64_t bytes_from_device = 0;
  StageTimes stage_ms{};
};

/// One buffer, or several of one purpose.
struct BufferBytes {
  std::string name;
  std::int64_t bytes = 0;
};

/// Bytes that a backend holds besides the state.
struct BackendMemory {
  std::int64_t host_bytes = 0;
  std::int64_t device_bytes = 0;
  std::vector<BufferBytes> buffers;  // what most of them are for, on the device where there is one
};

/// Runs stages 2 (with the snow of tiles that are awake) and 4 to 9 of planned ticks, on one state until forget(). A
/// tick goes through three calls, in their order, and may overlap with the next: submit(1), settle(1), submit(2),
/// collect(1), settle(2), ... Backends differ in schedule only: the same state and plan give the same bits. One thread
/// at a time, any thread.
class Backend {
 public:
  virtual ~Backend() = default;
  virtual std::string name() const = 0;
  /// What computes besides the processor, as its driver names it; "none (native)" where nothing does.
  virtual std::string renderer() const = 0;

  /// Begins a tick. The tick before must be settled (asserted), all earlier ones collected. The base must live on. The
  /// state's craters are those of this tick already; nothing else of it is.
  /// Errors: a device that is lost or has not the memory. The state goes on elsewhere once what is settled is
  /// collected.
  [[nodiscard]] virtual Status submit(TickPlan plan, const BaseTerrain& base, const WorldState& state) = 0;

  /// Ends the submitted tick: takes the state's tiles to its versions, hashes, sums and wake masks, and the state's
  /// sums. The cells themselves, and the effect's differences, may follow with collect(). Errors, which leave the state
  /// untouched: the device is lost, or has not the memory.
  virtual Result<TickEffect> settle(WorldState& state) = 0;

  /// Brings the cells that the settled tick changed to the state's tiles, and fills in the differences of its changes.
  /// Errors: the device is lost; the state is then of no further use.
  [[nodiscard]] virtual Status collect(WorldState& state, std::vector<TileChange>& changes) = 0;

  /// Says that the state's tiles have other cells than the ticks gave them: copies of them are out of date. Only of
  /// tiles that no unfinished tick changes.
  virtual void tilesChanged(std::span<Tile* const> tiles) = 0;

  /// Drops everything kept of a state, unfinished ticks too: the next tick may be of another one.
  virtual void forget() = 0;

  virtual BackendMemory memory() const = 0;
};

struct NativeOptions {
  int thread_count = 0;              // 0: one for each processor
  const Kernels* kernels = nullptr;  // nullptr: the fastest that this processor runs
  bool skip_settled = true;          // false: every sweep visits every pair (for measuring; the same bits)
};
std::unique_ptr<Backend> makeNativeBackend(const NativeOptions& options = {});

/// The active tiles of a tick.
struct ActiveTiles {
  std::vector<Tile*> tiles;                  // in the plan's order
  std::vector<std::unique_ptr<Tile>> fresh;  // those among them that are not in the state's store yet, in that order
  std::vector<CellBox> cratered;     // [tiles] of the others, what new craters meet (cratersWithin); empty: nothing
  std::vector<std::uint8_t> snowed;  // [tiles] 1: of the plan's in_snow
};

/// Finds a plan's tiles in the state and makes those that are dormant: with all craters, those of this tick too.
ActiveTiles takeTiles(const TickPlan& plan, const BaseTerrain& base, const WorldState& state, ThreadPool& pool);

/// What a tick did to one active tile. Where no cell changed the box is empty and the sums do not matter.
struct TileOutcome {
  TileChange change;       // box, and differences where they are known already
  std::uint64_t hash = 0;  // of all planes
  std::int64_t ground = 0;
  std::int64_t compacted = 0;
};

/// Stage craters, of one live tile: takes its sums and the state's over what new craters did to its cells.
/// @param gained  soil, 0.1 mm * cells
/// @param hash    of the tile with it
void commitCraters(Tile& tile, std::int64_t gained, std::uint64_t hash, WorldState& state);

/// Ends a tick: makes fresh tiles live, takes all to their new versions, hashes, sums and wake masks, and keeps the
/// state's sums. What a tile keeps active and had to wait in this tick it goes on keeping.
/// @param outcomes  of each active tile
/// @return          what changed: the outcomes' changes with all but their difference filled in
std::vector<TileChange> commitTick(const TickPlan& plan, ActiveTiles active, std::vector<TileOutcome> outcomes,
                                   WorldState& state);

}  // namespace spoor
