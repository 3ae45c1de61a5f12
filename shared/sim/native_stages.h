#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "shared/base/kernels.h"
#include "shared/sim/backend.h"
#include "shared/sim/work_area.h"

namespace spoor {

/// What the native stages of one backend work with.
struct NativeContext {
  const ScenePack& pack;
  std::int32_t tick;
  const Parameters& parameters;
  const Kernels& kernels;
  ThreadPool& pool;
  WorkArea& area;
};

/// Rows (or columns) of `length` cells per task: few enough tasks that handing them out costs nothing beside them.
inline int rowsPerTask(int length) {
  constexpr int kCellsPerTask = 1 << 14;
  return std::max(1, kCellsPerTask / std::max(length, 1));
}

/// A cell that takes part in iterative displacement, and those around it that do.
struct FlowCell {
  std::int32_t x, y;     // in the world
  std::size_t offset;    // in the work area's planes
  std::int32_t overlap;  // see rules/penetration.h
  std::int32_t ground;   // height without what it carries
  std::int32_t underside;
  std::int32_t downward_count, upward_count;
  std::int32_t downward[8];  // indices of nearer neighbours
  std::int32_t upward[8];    // indices of those that this one is nearer than
};

/// Planes of one domain, row-major [height * width] of its box, and where its rows lie in the work area.
struct DomainWork {
  CellBox box;
  std::vector<std::size_t> row_offset;    // [rows] offset of the row's first cell in the work area's planes
  std::vector<std::int32_t> overlap;      // see rules/penetration.h
  std::vector<int> penetrating_in_row;    // [rows] cells with overlap > 0
  int penetrating_count = 0;              // their number
  std::vector<std::int32_t> nearest_row;  // y of the nearest free cell of the same column, relative to the box
  std::vector<std::uint8_t>
      stale_columns;                   // [column / columnsPerTask()] did classes change since nearest_row was found?
  std::vector<std::int32_t> target;    // index of the nearest free cell in this domain, or kNoTarget
  std::vector<std::uint8_t> receives;  // [rows] does the row hold a target?
  std::vector<std::int32_t> known[2];  // jump flooding: position of the free cell that a cell knows, before and after
  std::vector<std::int32_t> seekers;   // jump flooding: positions of all cells that are not free, in (y, x) order
  std::vector<std::uint8_t> seeker_order;  // [seekers] rules/flood.h, floodOrder
  std::vector<std::int32_t> flow_index;    // iterative: of a cell in flow_cells; only where it is one of them
  std::vector<FlowCell> flow_cells;        // iterative: cells that are not free and their neighbours, in (y, x) order
  std::vector<std::int32_t> carried, flow_room, flow_total;  // [flow_cells] see rules/flow.h
  std::vector<std::int32_t> offer[2];                        // [flow_cells] to each nearer neighbour, before and after
  std::vector<std::uint8_t> parts;      // spread: over how many targets a source's overlap goes, 0: to `target`
  std::vector<std::int64_t> requested;  // soil that wants to come to a cell; 0 everywhere between sub-steps
  std::vector<std::int32_t> room;       // what a cell with requests can take, kRoomForAll where they fit
  std::vector<std::int64_t> granted;    // what was let in where not all fits; 0 everywhere between sub-steps

  std::int64_t bytes_moved = 0;  // by stages nearest and displace (TickEffect::bytes_moved)

  static constexpr std::int32_t kRoomForAll = INT32_MAX;

  int width() const { return box.x1 - box.x0; }
  int rows() const { return box.y1 - box.y0; }
  /// Columns that are searched together.
  int columnsPerTask() const { return std::max(rules::kTileSize, rowsPerTask(rows())); }
  void reset(const CellBox& new_box, const WorkArea& area);
  /// Cells with overlap > 0 now.
  int penetratingLeft() const;
  /// Adds what its planes hold to a list, by purpose.
  void addBuffers(std::vector<BufferBytes>& buffers) const;

  /// Calls body(row) for all rows, in parallel.
  template <typename Body>
  void forEachRow(ThreadPool& pool, Body body) const {
    const int task_rows = rowsPerTask(width());
    pool.forEach((rows() + task_rows - 1) / task_rows, [&](int task, int) {
      for (int row = task * task_rows; row < std::min((task + 1) * task_rows, rows()); ++row) body(row);
    });
  }
};

/// Stage depth: the lowest point of the sub-step's bodies over every cell of their domains, in the area's undersides,
/// with each segment's lowest.
void runDepth(const NativeContext& context, const SubStep& sub_step);

/// The same for where bodies stood before the tick (TickPlan::stood), whose domains may overlap.
void runStood(const NativeContext& context, const SubStep& stood);

/// Stage penetration: fills overlap and its counts, and presses soil together where the tick compacts.
void runPenetration(const NativeContext& context, DomainWork& domain);

/// Stage nearest: fills target for penetrating cells (iterative displacement: for all that are not free), and receives.
/// Only where a cell penetrates.
void runNearest(const NativeContext& context, DomainWork& domain);

/// The same by jump flooding, as runNearest calls it.
void runFlood(const NativeContext& context, DomainWork& domain);

/// Smallest overlap of the cells that search for a free one.
inline std::int32_t leastSearching(const Parameters& parameters) {
  return parameters.displacement == Displacement::iterative ? rules::kObstacle : rules::kObstacle + 1;
}

/// Stage displace: moves the soil; marks changed segments with `step`. Only after runNearest, which it may run again.
/// Returns what it left where bodies are (TickEffect::kept_back).
std::int64_t runDisplace(const NativeContext& context, DomainWork& domain, std::int32_t step);

/// The same with iterative displacement, as runDisplace calls it.
std::int64_t displaceInSteps(const NativeContext& context, DomainWork& domain, std::int32_t step);

/// Stage relax: `sweep_count` sweeps over all active tiles, the first of them being number `first_sweep` of this tick.
/// Returns the pairs of cells visited.
std::int64_t runRelax(const NativeContext& context, int first_sweep, int sweep_count, bool skip_settled);

/// The same by rules/slope.h and rules/drift.h, as runRelax calls it.
void runSlopes(const NativeContext& context, int first_sweep, int sweep_count);

/// Before the sweeps of rule `drift`: how bodies that move push the soil beneath them, in the area's pushes. Where
/// bodies displace nothing by themselves (Displacement::none) their undersides go away after that.
void runPush(const NativeContext& context, const SubStep& sub_step);

/// Stage hash: brings changed cells back to their tiles. Returns what became of each active tile, for commitTick.
std::vector<TileOutcome> runHash(const NativeContext& context);

}  // namespace spoor
