#pragma once

#include <cstdint>
#include <vector>

#include "shared/base/bytes.h"
#include "shared/base/result.h"

namespace spoor {

/// How overlapped soil leaves a body (Persson 2019, 4.1.4).
enum class Displacement : std::uint8_t {
  direct,     // all of it to the nearest free cell (method 2)
  iterative,  // from cell to cell down the contour distance (method 1)
  spread,     // over several cells, outward from the nearest free one (method 3)
  none        // not at all: only the slope rule moves it, as `drift` does by the body's force (Gilardi et al.)
};

/// How the nearest free cell is found: exactly, or by jump flooding (Rong & Tan 2006) and its variants, which err.
enum class NearestSearch : std::uint8_t {
  exact,
  jump_flooding,           // JFA: steps n/2, n/4, .. 1
  jump_flooding_plus_1,    // JFA+1: and 1 once more
  jump_flooding_plus_2,    // JFA+2: and 2, 1
  one_plus_jump_flooding,  // 1+JFA: 1 first
  jump_flooding_squared    // JFA^2: all steps twice
};

/// What "nearest" means; values as in rules/nearest.h.
enum class Metric : std::uint8_t { euclidean, manhattan, chebyshev };

/// How steep slopes are evened out.
enum class SlopeRule : std::uint8_t {
  exchange,     // edge-coloured pairs, in place: comes to rest with no excess
  flux,         // antisymmetric flow over all eight edges at once
  interleaved,  // the thesis's average rule in two passes (4.1.5, method 1)
  scatter,      // the same in one scattering pass (method 2, without its race): the same bits
  drift         // drift and diffusion over the edges to four neighbours (Gilardi et al., equations 2 to 8)
};

/// What holds back the flow of rule `drift` (Gilardi et al., equation 4; rules/drift.h).
enum class DriftWeights : std::uint8_t {
  none,          // nothing: equation 2, all ground flattens in the end
  displacement,  // as printed: how far soil would move in a unit of time, against the angle of repose
  slope          // how steep the edge is, against the angle of repose
};

/// How the soil of one material moves. Soil that moves takes the rules of the cell that it comes to; where two
/// materials meet, the cell that gives decides.
struct MaterialRules {
  std::int32_t slope_threshold_q = 1;     // largest height difference of side neighbours that rests, >= 0, or
                                          // kNeverSteep [slopeThreshold]
  std::int32_t diagonal_threshold_q = 1;  // the same of diagonal neighbours, for exchange and flux
  std::int32_t compression_q16 = 0;       // share of overlapped soil that is pressed together in place, 0 .. 65536 = 1
  std::int32_t compaction_limit_q16 = 0;  // how much of a column's soil can be pressed together at all, 0 .. 65536 = 1;
                                          // 0: any amount, and no memory of it (the thesis)
  std::int32_t roughness_q16 = 65536;     // 0 .. 65536 = 1; scales what flux, interleaved and scatter move at once
  std::int32_t diffusion_q16 = 65536;     // drift: D, cells^2 per unit of time, 0 .. 4 * 65536
  std::int32_t friction_inverse_q32 = 0;  // drift: 1/zeta, cells per unit of time for each newton, * 2^32, 0 .. 2^31-1
  std::int32_t repose_q16 = 0;  // drift by displacement: the angle of repose as a share of a right angle, 0 ..
                                // kReposeLimit

  bool operator==(const MaterialRules&) const = default;
};

/// The numbers and choices that steer how soil moves: the part of the scene that a session may change while it runs.
/// Names in brackets are the thesis's (Table 4.4).
struct Parameters {
  Displacement displacement = Displacement::direct;
  NearestSearch nearest = NearestSearch::exact;
  Metric metric = Metric::euclidean;
  SlopeRule slopes = SlopeRule::exchange;
  DriftWeights drift_weights = DriftWeights::slope;
  std::uint8_t active_areas = 1;          // 0: every tile of the world is simulated in every tick
  std::int32_t displace_iterations = 10;  // of iterative displacement, each sub-step, 0 .. 1000
                                          // [numIterationsDisplaceMaterialToContour]
  std::int32_t sweeps_per_tick = 10;    // 0 .. 1000, shared out over the tick's sub-steps [numIterationsEvenOutSlopes]
  std::int32_t drift_step_q16 = 16384;  // of a sweep of drift, units of time, 1 .. 16 * 65536; a long one is split
                                        // (driftSteps)
  std::int32_t obstacle_threshold_q = 0;      // a body this near above the ground takes no soil beneath it, >= 0
  std::int32_t penetration_divider_q = 1000;  // spread: one target for each of this much overlap, >= 1
  std::int32_t spread_cells = 16;             // spread: targets at most, and how far the search domain grows, 1 .. 64
  std::int32_t capacity_rounds = 2;      // direct and spread: how often soil that found no room looks for the next free
                                         // cell, counting the first, 1 .. 16
  std::int32_t active_margin_cells = 0;  // by how much a body's active area exceeds its search domain, 0 .. 4096
                                         // [activeAreaMargin]
  std::int32_t frustum_height_q = 0;     // a body higher than this above bedrock is not seen; 0: any is [frustumHeight]
  std::vector<MaterialRules> materials = std::vector<MaterialRules>(1);  // of each of the pack's, by number

  bool operator==(const Parameters&) const = default;
};

/// A threshold that no slope exceeds.
inline constexpr std::int32_t kNeverSteep = INT32_MAX;

inline constexpr std::int32_t kOneQ16 = 1 << 16;
inline constexpr std::int32_t kIterationsLimit = 1000;
inline constexpr std::int32_t kSpreadCellsLimit = 64;
inline constexpr std::int32_t kCapacityRoundsLimit = 16;
inline constexpr std::int32_t kActiveMarginLimit = 4096;
inline constexpr std::int32_t kDiffusionLimit = 4 * kOneQ16;
inline constexpr std::int32_t kDriftStepLimit = 16 * kOneQ16;
inline constexpr std::int32_t kReposeLimit = 62259;  // 85.5 degrees

/// How many bytes putParameters writes for so many materials.
constexpr std::size_t parametersBytes(std::size_t material_count) { return 6 + 9 * 4 + 1 + material_count * 8 * 4; }

/// Is soil of any material pressed together?
bool anyCompression(const Parameters& parameters);

/// Into how many equal steps a sweep of drift is split, so that each is stable by itself: over no edge does the flow
/// grow by more than an eighth of what the difference of heights does, which keeps neighbours from swinging to and fro
/// (a quarter would only just be stable), and no step is longer than a unit of time.
/// By displacement the flow w(f) f grows up to (2 - a) / (1 - a) times as fast as f, a being the share of a right
/// angle at which w begins.
int driftSteps(const Parameters& parameters);

/// Passes of the slope rule over the ground in a tick: sweeps_per_tick, or that many times driftSteps.
int sweepsOf(const Parameters& parameters);

/// The arc of a right angle over a cell's side, 0.1 mm, rounded down.
constexpr std::int32_t quarterArc(std::int32_t cell_q) {
  return std::int32_t(std::int64_t(cell_q) * 6746518852 >> 32);  // pi / 2 * 2^32
}

/// Checks every value's range. The error names the field.
[[nodiscard]] Status validateParameters(const Parameters& parameters);

/// Canonical bytes, parametersBytes() of them.
void putParameters(ByteWriter& writer, const Parameters& parameters);

/// Reads what putParameters wrote; values are not checked (validateParameters), but no more materials than there can
/// be are read: then the reader fails.
Parameters getParameters(ByteReader& reader);

}  // namespace spoor
