// Stage relax by the slope rules: sweeps that read heights as they were before and write a second plane of them.
//
// The active cells are dealt out in blocks. A task takes its block row by row, with the cells around it: it reads each
// row once, keeps the few that the rule needs in the nearest cache, and finds every flow between two rows once. Only
// the scattering variant writes outside its block.
#include <algorithm>
#include <array>
#include <atomic>

#include "shared/sim/drift.h"
#include "shared/sim/native_stages.h"

namespace spoor {
namespace {

constexpr int kSize = rules::kTileSize;
constexpr int kHalo = SlopeRow::kHalo;
constexpr int kBlockColumns = SlopeRow::kMostCells;
constexpr int kBlockRows = 32;

struct Block {
  int band, run;
  int x0, width;  // columns, in the world
  int row;        // the first, of the band's
};

std::vector<Block> blocksOf(const WorkArea& area) {
  std::vector<Block> blocks;
  for (int band = 0; band < int(area.bands.size()); ++band)
    for (int i = 0; i < area.bands[band].run_count; ++i) {
      const int run = area.bands[band].first_run + i;
      for (int row = 0; row < kSize; row += kBlockRows)
        for (int x = area.runs[run].x0(); x < area.runs[run].x1(); x += kBlockColumns)
          blocks.push_back({band, run, x, std::min(kBlockColumns, area.runs[run].x1() - x), row});
    }
  return blocks;
}

/// Cells of a row of a block or next to one, `count` of them from x on.
struct Piece {
  const Run* run;
  int x, count;
  std::size_t offset;  // in the area's planes
};

/// The numbers of a material in a tick, as SlopeRow has them.
struct SlopeNumbers {
  std::int32_t threshold, diagonal_threshold, roughness, inverse;
};

/// What a sweep needs besides the cells.
struct SlopeSweep {
  std::array<SlopeNumbers, kMaterialsLimit> numbers;
  rules::DriftStep drift;
  rules::uint phase = 0;
};

SlopeSweep sweepOf(const NativeContext& context) {
  SlopeSweep sweep;
  const Parameters& parameters = context.parameters;
  const DriftSweep drift = driftSweep(context.pack, parameters);
  for (std::size_t i = 0; i < parameters.materials.size(); ++i) {
    const MaterialRules& own = parameters.materials[i];
    if (parameters.slopes == SlopeRule::drift)
      sweep.numbers[i] = {drift.materials[i].rest, 0, drift.materials[i].rate,
                          std::int32_t(drift.materials[i].inverse)};
    else
      sweep.numbers[i] = {own.slope_threshold_q, own.diagonal_threshold_q, own.roughness_q16, 0};
  }
  sweep.drift = drift.step;
  return sweep;
}

/// What a task works in.
class BlockSweep {
 public:
  BlockSweep(const NativeContext& context, const SlopeSweep& sweep, const Block& block)
      : context_(context), area_(context.area), sweep_(sweep), block_(block) {
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const auto plane = [&](int number) { return cells_[i].data() + kHalo + number * kRowCells; };
      rows_[i] = {plane(0), plane(1), plane(2), plane(3), plane(4), plane(5), plane(6), plane(7), plane(8)};
      const SlopeNumbers& first = sweep.numbers.front();
      std::fill_n(plane(3) - kHalo, kRowCells, first.inverse);
      std::fill_n(plane(4) - kHalo, kRowCells, first.threshold);
      std::fill_n(plane(5) - kHalo, kRowCells, first.diagonal_threshold);
      std::fill_n(plane(6) - kHalo, kRowCells, first.roughness);
      std::fill_n(plane(7) - kHalo, 2 * kRowCells, 0);
    }
    for (std::size_t i = 0; i < changes_.size(); ++i) changes_[i].fill(0);
  }

  void flux() {
    std::array<std::int32_t, kBlockColumns> carry{}, aside;
    load(block_.row - 1);
    for (int row = block_.row - 1; row < block_.row + kBlockRows; ++row) {
      load(row + 1);
      context_.kernels.fluxFlows(at(row), at(row + 1), block_.width, carry.data(), output(row, aside.data()));
    }
  }

  void drift() {
    std::array<std::int32_t, kBlockColumns> carry{}, aside;
    const int y = area_.bands[block_.band].tile_y * kSize;
    load(block_.row - 1);
    for (int row = block_.row - 1; row < block_.row + kBlockRows; ++row) {
      load(row + 1);
      context_.kernels.driftFlows(at(row), at(row + 1), block_.width, sweep_.drift, block_.x0, y + row, sweep_.phase,
                                  carry.data(), output(row, aside.data()));
    }
  }

  void average() {
    std::array<std::int32_t, kBlockColumns> carry{}, aside;
    for (int row = block_.row - 2; row <= block_.row; ++row) load(row);
    findAmounts(block_.row - 1, 1);
    for (int row = block_.row - 1; row < block_.row + kBlockRows; ++row) {
      load(row + 2);
      findAmounts(row + 1, 1);
      context_.kernels.averageFlows(at(row), at(row + 1), block_.width, carry.data(), output(row, aside.data()));
    }
  }

  void copy() {
    const Run& run = area_.runs[block_.run];
    for (int row = block_.row; row < block_.row + kBlockRows; ++row) {
      const std::size_t from = run.rowOffset(row) + std::size_t(block_.x0 - run.x0());
      std::copy_n(area_.height.data() + from, block_.width, area_.next_height.data() + from);
    }
  }

  /// The heights must have been copied, everywhere.
  void scatter() {
    load(block_.row - 1);
    load(block_.row);
    for (int row = block_.row; row < block_.row + kBlockRows; ++row) {
      load(row + 1);
      if (findAmounts(row, 0)) {
        std::int32_t* const change[3] = {changeOf(row - 1), changeOf(row), changeOf(row + 1)};
        context_.kernels.scatterFlows(at(row - 1), at(row), at(row + 1), block_.width, change);
      }
      addChange(row - 1);
    }
    addChange(block_.row + kBlockRows - 1);
    addChange(block_.row + kBlockRows);
  }

 private:
  static constexpr int kRowCells = kBlockColumns + 2 * kHalo;

  const SlopeRow& at(int row) const { return rows_[std::size_t(row & 3)]; }
  std::int32_t* changeOf(int row) { return changes_[std::size_t(row & 3)].data() + kHalo; }

  /// Where a row's new heights go; those of the row above the block are the block above's.
  std::int32_t* output(int row, std::int32_t* aside) {
    if (row < block_.row) return aside;
    const Run& run = area_.runs[block_.run];
    return area_.next_height.data() + run.rowOffset(row) + std::size_t(block_.x0 - run.x0());
  }

  /// Calls visit(piece) for the active cells of a row (-kHalo .. kSize + kHalo - 1 of the band's), `halo` more columns
  /// on either side included.
  template <typename Visit>
  void forEachPiece(int row, int halo, Visit visit) const {
    const int step = row < 0 ? -1 : row >= kSize ? 1 : 0;
    const int band_index = block_.band + step;
    if (band_index < 0 || band_index >= int(area_.bands.size())) return;
    const Band& band = area_.bands[band_index];
    if (band.tile_y != area_.bands[block_.band].tile_y + step) return;
    // Other runs of the block's own band are a tile away at least.
    const int first = step == 0 ? block_.run : band.first_run;
    const int end = step == 0 ? block_.run + 1 : band.first_run + band.run_count;
    for (int i = first; i < end; ++i) {
      const Run& run = area_.runs[i];
      const int from = std::max(block_.x0 - halo, run.x0());
      const int count = std::min(block_.x0 + block_.width + halo, run.x1()) - from;
      if (count > 0) visit(Piece{&run, from, count, run.rowOffset(row & (kSize - 1)) + std::size_t(from - run.x0())});
    }
  }

  /// Takes a row into its place among the last four. Cells that are not active have no soil and take none.
  void load(int row) {
    const SlopeRow& to = at(row);
    int known = 0;
    forEachPiece(row, kHalo, [&](const Piece& piece) { known += piece.count; });
    if (known < block_.width + 2 * kHalo) std::fill_n(to.height - kHalo, 3 * kRowCells, 0);
    forEachPiece(row, kHalo, [&](const Piece& piece) {
      const int i = piece.x - block_.x0;
      context_.kernels.slopeCells(area_.height.data() + piece.offset, area_.bedrock.data() + piece.offset,
                                  area_.underside.data() + piece.offset, piece.count,
                                  context_.parameters.obstacle_threshold_q, to.height + i, to.room + i, to.soil + i);
      if (!area_.material.empty())
        for (int cell = 0; cell < piece.count; ++cell)
          setNumbers(to, i + cell, area_.material[piece.offset + std::size_t(cell)]);
      if (area_.push_x.empty()) return;
      std::copy_n(area_.push_x.data() + piece.offset, piece.count, to.push_x + i);
      std::copy_n(area_.push_y.data() + piece.offset, piece.count, to.push_y + i);
    });
  }

  void setNumbers(const SlopeRow& row, int cell, int material) const {
    const SlopeNumbers& own = sweep_.numbers[std::size_t(material)];
    row.amount[cell] = own.inverse;
    row.threshold[cell] = own.threshold;
    row.diagonal_threshold[cell] = own.diagonal_threshold;
    row.roughness[cell] = own.roughness;
  }

  bool findAmounts(int row, int halo) {
    return context_.kernels.slopeAmounts(at(row - 1), at(row), at(row + 1), -halo, block_.width + halo);
  }

  /// Adds what scattering did to a row, now that the block does no more to it. Where other blocks add too: atomically.
  void addChange(int row) {
    std::int32_t* change = changeOf(row);
    const bool shared_row = row <= block_.row || row >= block_.row + kBlockRows - 1;
    forEachPiece(row, 1, [&](const Piece& piece) {
      std::int32_t* next = area_.next_height.data() + piece.offset;
      const std::int32_t* amounts = change + (piece.x - block_.x0);
      for (int i = 0; i < piece.count; ++i) {
        const int column = piece.x + i - block_.x0;
        if (shared_row || column <= 0 || column >= block_.width - 1) {
          if (amounts[i] != 0) std::atomic_ref(next[i]).fetch_add(amounts[i], std::memory_order_relaxed);
        } else {
          next[i] += amounts[i];
        }
      }
    });
    std::fill_n(change - kHalo, kRowCells, 0);
  }

  const NativeContext& context_;
  WorkArea& area_;
  const SlopeSweep& sweep_;
  const Block& block_;
  std::array<std::array<std::int32_t, SlopeRow::kPlanes * kRowCells>, 4> cells_;  // of the last four rows
  std::array<std::array<std::int32_t, kRowCells>, 4> changes_;                    // scatter: of the last rows
  std::array<SlopeRow, 4> rows_;
};

}  // namespace

void runSlopes(const NativeContext& context, int first_sweep, int sweep_count) {
  WorkArea& area = context.area;
  area.next_height.resize(area.height.size());
  const std::vector<Block> blocks = blocksOf(area);
  SlopeSweep numbers = sweepOf(context);
  const auto forEachBlock = [&](auto body) {
    context.pool.forEach(int(blocks.size()), [&](int i, int) { body(BlockSweep(context, numbers, blocks[i])); });
  };
  for (int sweep = 0; sweep < sweep_count; ++sweep) {
    numbers.phase = rules::driftPhase(context.tick, first_sweep + sweep);
    switch (context.parameters.slopes) {
      case SlopeRule::exchange:
        break;
      case SlopeRule::flux:
        forEachBlock([](BlockSweep&& block) { block.flux(); });
        break;
      case SlopeRule::interleaved:
        forEachBlock([](BlockSweep&& block) { block.average(); });
        break;
      case SlopeRule::scatter:
        forEachBlock([](BlockSweep&& block) { block.copy(); });
        forEachBlock([](BlockSweep&& block) { block.scatter(); });
        break;
      case SlopeRule::drift:
        forEachBlock([](BlockSweep&& block) { block.drift(); });
        break;
    }
    std::swap(area.height, area.next_height);
  }
}

}  // namespace spoor
