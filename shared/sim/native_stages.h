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
  const Parameters& parameters;
  const Kernels& kernels;
  ThreadPool& pool;
  WorkArea& area;
};

/// Planes of one domain, row-major [height * width] of its box, and where its rows lie in the work area.
struct DomainWork {
  CellBox box;
  std::vector<std::size_t> row_offset;  // [rows] offset of the row's first cell in the work area's planes
  std::vector<std::int32_t> overlap;    // see rules/penetration.h
  std::vector<int> penetrating_in_row;  // [rows]
  int penetrating_count = 0;
  std::vector<std::int32_t> nearest_row;  // y of the nearest free cell of the same column, relative to the box
  std::vector<std::int32_t> target;       // index of the nearest free cell in this domain, or kNoTarget
  std::vector<std::uint8_t> receives;     // [rows] does the row hold a target?
  std::vector<std::int64_t> requested;    // soil that wants to come to a cell; 0 everywhere between sub-steps
  std::vector<std::int32_t> room;         // what a cell with requests can take, kRoomForAll where they fit
  std::vector<std::int64_t> granted;      // what was let in where not all fits; 0 everywhere between sub-steps

  static constexpr std::int32_t kRoomForAll = INT32_MAX;

  int width() const { return box.x1 - box.x0; }
  int rows() const { return box.y1 - box.y0; }
  void reset(const CellBox& new_box, const WorkArea& area);
};

/// Rows (or columns) of `length` cells per task: few enough tasks that handing them out costs nothing beside them.
inline int rowsPerTask(int length) {
  constexpr int kCellsPerTask = 1 << 14;
  return std::max(1, kCellsPerTask / std::max(length, 1));
}

/// Stage depth: the lowest point of the sub-step's bodies over every cell of their domains, in the area's undersides,
/// with each segment's lowest.
void runDepth(const NativeContext& context, const SubStep& sub_step);

/// The same for where bodies stood before the tick (TickPlan::stood), whose domains may overlap.
void runStood(const NativeContext& context, const SubStep& stood);

/// Stage penetration: fills overlap and its counts.
void runPenetration(const NativeContext& context, DomainWork& domain);

/// Stage nearest: fills target for penetrating cells, and receives. Only where penetrating_count > 0.
void runNearest(const NativeContext& context, DomainWork& domain);

/// Stage displace: moves the soil; marks changed segments with `step`. Only after runNearest, which it may run again.
/// Returns what it left where bodies are (TickEffect::kept_back).
std::int64_t runDisplace(const NativeContext& context, DomainWork& domain, std::int32_t step);

/// Stage relax: `sweep_count` sweeps over all active tiles, the first of them being number `first_sweep` of this tick.
/// Returns the pairs of cells visited.
std::int64_t runRelax(const NativeContext& context, int first_sweep, int sweep_count, bool skip_settled);

/// Stage hash: brings changed cells back to their tiles. Returns what became of each active tile, for commitTick.
std::vector<TileOutcome> runHash(const NativeContext& context);

}  // namespace spoor
