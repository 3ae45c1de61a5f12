#pragma once

#include <cstdint>
#include <vector>

#include "shared/base/thread_pool.h"
#include "shared/sim/backend.h"

namespace spoor {

/// Neighbouring active tiles of one row of tiles, their cells laid out row by row so that rows are long.
struct Run {
  static constexpr int kRowPad = 16;

  TileCoordinate first;
  int tile_count = 0;
  std::size_t cell_offset = 0;     // of its first cell in WorkArea's planes
  std::size_t segment_offset = 0;  // of its first segment in WorkArea's segment arrays

  int width() const { return tile_count * rules::kTileSize; }
  /// Cells from one row to the next. The pad keeps rows of a power of two apart in the caches, and may be read.
  int stride() const { return width() + kRowPad; }
  int x0() const { return first.x * rules::kTileSize; }
  int x1() const { return x0() + width(); }
  std::size_t rowOffset(int local_row) const { return cell_offset + std::size_t(local_row) * std::size_t(stride()); }
};

/// A row of tiles that has active ones.
struct Band {
  std::int32_t tile_y = 0;
  int first_run = 0;
  int run_count = 0;
};

/// The active tiles of a tick, gathered for the native backend. A segment is 64 cells of one row: one tile's share.
struct WorkArea {
  std::vector<Tile*> tiles;                              // active, in (y, x) order
  std::vector<Run> runs;                                 // in the same order
  std::vector<Band> bands;                               // in y order
  std::vector<int> run_of_tile;                          // [tiles]
  std::vector<std::int32_t> height, bedrock, underside;  // [cells]
  std::vector<std::int32_t> underside_before;            // [cells] a sub-step earlier
  std::vector<std::int32_t> compacted;                   // [cells] where the tick compacts, else empty
  std::vector<std::int32_t> material;                    // [cells] where there are several, else empty
  std::vector<std::int32_t> threshold;                   // [cells] exchangeThreshold of side neighbours, by material,
  std::vector<std::int32_t> diagonal_threshold;          //   and of diagonal ones; empty where all are of one
  std::vector<std::int32_t> push_x, push_y;    // [cells] pushedSoil (rules/drift.h); empty where nothing pushes
  std::vector<std::int32_t> next_height;       // [cells] of the sweep to come; none with pair exchange
  std::vector<std::int32_t> lowest_underside;  // [segments] smallest underside over the segment's cells
  std::vector<std::int32_t> last_change;       // [segments] step of the relaxation at which it last changed

  /// Lays out the cells of active tiles, which come in (y, x) order.
  void gather(const std::vector<Tile*>& active, const Parameters& parameters, ThreadPool& pool);

  /// The run that holds a cell. It must be active (asserted).
  const Run& runAt(std::int32_t x, std::int32_t y) const;
  /// Offset of a cell that lies in an active tile; cells to its right up to the run's end follow it.
  std::size_t offsetAt(std::int32_t x, std::int32_t y) const {
    const Run& run = runAt(x, y);
    return run.rowOffset(y % rules::kTileSize) + std::size_t(x - run.x0());
  }
  std::size_t segmentAt(std::int32_t x, std::int32_t y) const {
    const Run& run = runAt(x, y);
    return run.segment_offset + std::size_t(y % rules::kTileSize) * std::size_t(run.tile_count) +
           std::size_t(x / rules::kTileSize - run.first.x);
  }

  std::vector<BufferBytes> buffers() const;

  /// Takes all undersides away, but for the world's border, which stays closed.
  void clearUnderside(const ScenePack& pack, ThreadPool& pool);
};

}  // namespace spoor
