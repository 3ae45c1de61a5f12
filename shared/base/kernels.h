#pragma once

#include <cstdint>
#include <span>

#include "shaders/rules/crater.h"
#include "shaders/rules/drift.h"
#include "shaders/rules/snowfall.h"

namespace spoor {

/// Cells that exchange soil with each other or with those of another row (rules/exchange.h).
struct ExchangeCells {
  std::int32_t* height;
  const std::int32_t* bedrock;
  const std::int32_t* underside;  // nullptr: nothing above limits what they take
  const std::int32_t* threshold;  // of each, >= 1; nullptr: ExchangeNumbers::threshold
};
struct ExchangeNumbers {
  int threshold;  // >= 1
  int obstacle_threshold;
};

/// A row of cells as the slope rules see them (rules/slope.h, rules/drift.h). Pointers are to its first cell; kHalo
/// more cells lie before it and behind its last.
struct SlopeRow {
  static constexpr int kHalo = 2;
  static constexpr int kMostCells = 256;
  static constexpr int kPlanes = 9;

  std::int32_t* height;
  std::int32_t* room;       // roomBeneath
  std::int32_t* soil;       // height - bedrock
  std::int32_t* amount;     // slopeAmount; drift: DriftNumbers::inverse
  std::int32_t* threshold;  // of its material; drift: DriftNumbers::rest
  std::int32_t* diagonal_threshold;
  std::int32_t* roughness;  // drift: DriftNumbers::rate
  std::int32_t* push_x;     // drift: pushedSoil along x and y
  std::int32_t* push_y;
};

/// The inner loops over rows of cells, compiled once per instruction set from kernels.inl; every set gives the same
/// bits. Pointers are to int32 cells; `n` counts cells and may be 0. Thread-safe.
struct Kernels {
  const char* name;  // "baseline", "avx2", "avx512"

  /// Sum of the cell hashes (rules/mix.h) of a tile whose first cell is (x, y).
  std::uint64_t (*hashTile)(const std::int32_t* cells, int x, int y, int plane);
  /// The same over the cells that are not 0.
  std::uint64_t (*hashSparseTile)(const std::int32_t* cells, int x, int y, int plane);
  std::int64_t (*sum)(const std::int32_t* cells, int n);
  /// Smallest and largest of n >= 1 cells.
  std::int32_t (*lowest)(const std::int32_t* cells, int n);
  std::int32_t (*highest)(const std::int32_t* cells, int n);
  /// What a crater (rules/crater.h, craterDisplacement) adds to a row of cells, `step` apart, the first at (dx, dy)
  /// from its centre.
  void (*craterRow)(const rules::CraterShape& shape, int dx, int step, int dy, int n, std::int32_t* displacement);
  /// Adds what fell on a row of cells, `step` apart, the first at (x, y) of the world (rules/snowfall.h, snowOn).
  void (*snowRow)(rules::uint seed, int x, int step, int y, int n, const rules::SnowDepth& fallen, std::int32_t* depth);
  /// Stage depth: lowers `underside` to a triangle's height along a row (rules/raster.h, triangleHeightAlong).
  void (*lowerAlong)(std::int32_t* underside, int n, int first, int step, int step_fraction, int lowest, int highest);
  /// The same stage: takes undersides away that lie too high above bedrock to be seen (rules/penetration.h).
  void (*hideAbove)(std::int32_t* underside, const std::int32_t* bedrock, int n, int frustum_height);
  /// Stage penetration: overlap of a row of cells; returns how many are penetrating.
  int (*overlap)(const std::int32_t* height, const std::int32_t* bedrock, const std::int32_t* underside,
                 const std::int32_t* underside_before, int n, int obstacle_threshold, std::int32_t* overlap);
  /// Stage nearest, column pass, one row on the way down: last_free[i] = y where overlap[i] is free, else unchanged;
  /// copied to `out`.
  void (*carryFree)(const std::int32_t* overlap, int n, int y, std::int32_t* last_free, std::int32_t* out);
  /// The same on the way up, merged: out[i] = the nearer of out[i] and last_free[i], the lower y where equally near.
  void (*mergeFree)(const std::int32_t* overlap, int n, int y, std::int32_t* last_free, std::int32_t* out);
  /// Stage relax: pairs (a[i], b[i]); true if any soil moved. The rows must not overlap, and be alike in which of
  /// their pointers are nullptr.
  bool (*exchangeRows)(const ExchangeCells& a, const ExchangeCells& b, int n, const ExchangeNumbers& numbers);
  /// Stage relax: pairs (cells[2i], cells[2i + 1]), i < pair_count <= 32. One more cell than the pairs is read, so that
  /// the loop runs over neighbours instead of gathering pairs.
  bool (*exchangeWithin)(const ExchangeCells& cells, int pair_count, const ExchangeNumbers& numbers);
  /// Stage relax, the slope rules: n cells as they see them, into a SlopeRow's planes.
  void (*slopeCells)(const std::int32_t* height, const std::int32_t* bedrock, const std::int32_t* underside, int n,
                     int obstacle_threshold, std::int32_t* height_there, std::int32_t* room, std::int32_t* soil);
  /// Amounts of the cells begin .. end - 1 of a row, out of it and the rows above and below; false: all are 0.
  bool (*slopeAmounts)(const SlopeRow& above, const SlopeRow& row, const SlopeRow& below, int begin, int end);
  /// Flows between a row and the one below. carry[i]: in, what came from the row above; out, what goes to the row
  /// below. out[i]: heights after all flows of n <= kMostCells cells. Of the average rule (amounts are known), and
  /// flux.
  void (*averageFlows)(const SlopeRow& row, const SlopeRow& below, int n, std::int32_t* carry, std::int32_t* out);
  void (*fluxFlows)(const SlopeRow& row, const SlopeRow& below, int n, std::int32_t* carry, std::int32_t* out);
  /// The same of drift; the row's first cell is (x, y), `phase` as driftDither has it.
  void (*driftFlows)(const SlopeRow& row, const SlopeRow& below, int n, const rules::DriftStep& step, int x, int y,
                     rules::uint phase, std::int32_t* carry, std::int32_t* out);
  /// The average rule as a scattering: what n cells of a row lose and others gain by it. change: of the rows above, of
  /// this one and below; cells -1 .. n of each.
  void (*scatterFlows)(const SlopeRow& above, const SlopeRow& row, const SlopeRow& below, int n,
                       std::int32_t* const change[3]);
};

/// The sets this processor runs, slowest first; "baseline" is always there.
std::span<const Kernels* const> availableKernels();

/// The fastest of them.
const Kernels& kernels();

}  // namespace spoor
