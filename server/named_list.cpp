#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "server/named_parameters.h"
#include "server/plain_number.h"
#include "shaders/rules/limits.h"
#include "shared/base/fixed.h"

namespace spoor {
namespace {

constexpr std::int32_t kLengthMost = 1 << 29;  // 0.1 mm, as validateParameters has it

/// A share 0 .. 1 in 2^-16. What is above 0 stays so: 0 often means something else than very little.
std::int32_t toQ16(double share) {
  const auto rounded = std::int32_t(std::llround(share * kOneQ16));
  return share > 0 ? std::max(rounded, 1) : 0;
}

double fromQ16(std::int32_t share) { return double(share) / kOneQ16; }

double metresOf(std::int32_t units) { return double(units) / rules::kUnitsPerMetre; }

/// Table 5.1 of the thesis, and what its program does where Spoor has a choice.
Status applyPreset(double value, std::int32_t, NamedSettings& settings) {
  constexpr Displacement displacements[] = {Displacement::iterative, Displacement::direct, Displacement::spread};
  constexpr SlopeRule slopes[] = {SlopeRule::interleaved, SlopeRule::scatter, SlopeRule::scatter};
  Parameters& p = settings.parameters;
  p.displacement = displacements[int(value)];
  p.slopes = slopes[int(value)];
  p.nearest = NearestSearch::jump_flooding;
  p.metric = Metric::euclidean;
  for (MaterialRules& rules : p.materials) rules.compaction_limit_q16 = 0;
  p.capacity_rounds = 1;
  p.obstacle_threshold_q = 1000;
  return {};
}

Status applyNearest(double value, std::int32_t, NamedSettings& settings) {
  NearestSearch& nearest = settings.parameters.nearest;
  if (value == 0)
    nearest = NearestSearch::exact;
  else if (nearest == NearestSearch::exact)  // a variant that is chosen already stays
    nearest = NearestSearch::jump_flooding;
  return {};
}

std::optional<double> readNearest(const NamedSettings& settings, std::int32_t) {
  return settings.parameters.nearest == NearestSearch::exact ? 0 : 1;
}

Status applyVariant(double value, std::int32_t, NamedSettings& settings) {
  NearestSearch& nearest = settings.parameters.nearest;
  if (nearest == NearestSearch::exact) return Error{"goes with nearest = jump_flooding, and nearest is exact"};
  nearest = NearestSearch(int(NearestSearch::jump_flooding) + int(value));
  return {};
}

std::optional<double> readVariant(const NamedSettings& settings, std::int32_t) {
  const NearestSearch nearest = settings.parameters.nearest;
  if (nearest == NearestSearch::exact) return {};
  return double(int(nearest) - int(NearestSearch::jump_flooding));
}

/// An angle in radians as a share of a right angle.
std::int32_t reposeShare(double angle) {
  const double share = angle * 2 / std::numbers::pi * kOneQ16;
  return std::int32_t(std::clamp<long long>(std::llround(share), 0, kReposeLimit));
}

void applySlope(double value, std::int32_t cell_q, MaterialRules& rules) {
  rules.slope_threshold_q = slopeThreshold(value, cell_q);
  rules.diagonal_threshold_q = diagonalThreshold(rules.slope_threshold_q);
  const bool never = rules.slope_threshold_q == kNeverSteep;
  rules.repose_q16 = reposeShare(never ? std::numbers::pi / 2 : std::atan2(rules.slope_threshold_q, cell_q));
}

/// In the middle of the angles that give the threshold.
double readSlope(const MaterialRules& rules, std::int32_t cell_q) {
  const std::int32_t threshold = rules.slope_threshold_q;
  if (threshold == kNeverSteep) return std::numbers::pi / 2 / metresOf(cell_q) * (1 + 1e-12);
  if (threshold == 0) return 0;
  return std::atan((double(threshold) + 0.5) / rules::kUnitsPerMetre) / metresOf(cell_q);
}

void applyRepose(double value, std::int32_t cell_q, MaterialRules& rules) { setRepose(value, cell_q, rules); }

void applyFriction(double value, std::int32_t, MaterialRules& rules) {
  rules.friction_inverse_q32 = std::int32_t(std::llround(std::ldexp(value, 32)));
}

double readFriction(const MaterialRules& rules, std::int32_t) { return std::ldexp(rules.friction_inverse_q32, -32); }

Status applyDriftStep(double value, std::int32_t, NamedSettings& settings) {
  settings.parameters.drift_step_q16 = toQ16(value);
  return {};
}

std::optional<double> readDriftStep(const NamedSettings& settings, std::int32_t) {
  return fromQ16(settings.parameters.drift_step_q16);
}

Status applyMargin(double value, std::int32_t cell_q, NamedSettings& settings) {
  // A hair is taken off so that 0.3 m, just over 3 in floats, are three cells of 0.1 m.
  const double cells = std::ceil(value * rules::kUnitsPerMetre / cell_q - 1e-9);
  if (cells > kActiveMarginLimit)
    return Error{plainNumber(value) + " m are " + plainNumber(cells) + " cells, the limit is " +
                 std::to_string(kActiveMarginLimit)};
  settings.parameters.active_margin_cells = std::int32_t(cells);
  return {};
}

std::optional<double> readMargin(const NamedSettings& settings, std::int32_t cell_q) {
  return settings.parameters.active_margin_cells * metresOf(cell_q);
}

Status applyFrustum(double value, std::int32_t, NamedSettings& settings) {
  const auto rounded = std::int32_t(std::llround(value * rules::kUnitsPerMetre));
  settings.parameters.frustum_height_q = value > 0 ? std::max(rounded, 1) : 0;
  return {};
}

std::optional<double> readFrustum(const NamedSettings& settings, std::int32_t) {
  return metresOf(settings.parameters.frustum_height_q);
}

constexpr std::string_view kWorldIsFixed = "it shapes the world, which is the same for all of a session";
constexpr std::string_view kDrawingIsFixed =
    "it is of the terrain as clients draw it, which they read once, from the pack";

// A parameter that is one field of Parameters or NamedSettings.
#define SPOOR_FIELD(field)                                                     \
  [](double value, std::int32_t, NamedSettings& settings) {                    \
    settings.field = std::remove_reference_t<decltype(settings.field)>(value); \
    return Status();                                                           \
  },                                                                           \
      [](const NamedSettings& settings, std::int32_t) { return std::optional<double>(double(settings.field)); }
// A material's parameter that is one share of MaterialRules.
#define SPOOR_SHARE(field)                                                                                \
  nullptr, nullptr, [](double value, std::int32_t, MaterialRules& rules) { rules.field = toQ16(value); }, \
      [](const MaterialRules& rules, std::int32_t) { return fromQ16(rules.field); }

// clang-format off
/// Columns: name, kind, lowest, highest, unit, choices, fixed because, apply, read, apply to and read of a material.
std::vector<NamedParameter> makeList() {
  using enum NamedKind;
  constexpr double most = kLengthMost;
  return {
      // Short names first: what comes after overrides them.
      {"preset", choice, 0, 2, "", {"thesis-iterative", "thesis-ssbo", "thesis-ssbo-multiple"}, "", applyPreset, nullptr},
      {"angleOfRepose", number, 0, kReposeLimitDeg, "degrees", {}, "", nullptr, nullptr, applyRepose, nullptr},
      {"terrainSize", number, 0.0001, 208000, "m", {}, kWorldIsFixed, SPOOR_FIELD(terrain_size_m)},
      {"heightmapSize", integer, 1, kWorldCellsLimit, "cells", {}, kWorldIsFixed, SPOOR_FIELD(heightmap_size)},
      {"numVerticesPerRow", integer, 0, 4096, "patches", {}, kDrawingIsFixed, SPOOR_FIELD(patches_per_row)},
      {"numIterationsBlurNormals", integer, 0, 16, "", {}, kDrawingIsFixed, SPOOR_FIELD(normal_blur_passes)},
      {"compression", number, 0, 1, "", {}, "", SPOOR_SHARE(compression_q16)},
      {"roughness", number, 0, 1, "", {}, "", SPOOR_SHARE(roughness_q16)},
      {"slopeThreshold", number, 0, 20000, "radians per metre", {}, "", nullptr, nullptr, applySlope, readSlope},
      {"numIterationsDisplaceMaterialToContour", integer, 0, kIterationsLimit, "", {}, "",
       SPOOR_FIELD(parameters.displace_iterations)},
      {"numIterationsEvenOutSlopes", integer, 0, kIterationsLimit, "", {}, "", SPOOR_FIELD(parameters.sweeps_per_tick)},
      {"penetrationDivider", integer, 1, most, "units of 0.1 mm", {}, "", SPOOR_FIELD(parameters.penetration_divider_q)},
      {"obstacleThreshold", integer, 0, most, "units of 0.1 mm", {}, "", SPOOR_FIELD(parameters.obstacle_threshold_q)},
      {"frustumHeight", number, 0, 53000, "m", {}, "", applyFrustum, readFrustum},
      {"activeAreas", flag, 0, 1, "", {}, "", SPOOR_FIELD(parameters.active_areas)},
      {"activeAreaMargin", number, 0, 400000, "m", {}, "", applyMargin, readMargin},
      {"displacement", choice, 0, 3, "", {"direct", "iterative", "spread", "none"}, "", SPOOR_FIELD(parameters.displacement)},
      {"nearest", choice, 0, 1, "", {"exact", "jump_flooding"}, "", applyNearest, readNearest},
      {"jumpFloodingVariant", choice, 0, 4, "", {"JFA", "JFA+1", "JFA+2", "1+JFA", "JFA^2"}, "", applyVariant, readVariant},
      {"metric", choice, 0, 2, "", {"euclidean", "manhattan", "chebyshev"}, "", SPOOR_FIELD(parameters.metric)},
      {"slopes", choice, 0, 4, "", {"exchange", "flux", "interleaved", "scatter", "drift"}, "", SPOOR_FIELD(parameters.slopes)},
      {"driftWeights", choice, 0, 2, "", {"none", "displacement", "slope"}, "", SPOOR_FIELD(parameters.drift_weights)},
      {"driftStep", number, 0.0001, kDriftStepLimit / kOneQ16, "units of time", {}, "", applyDriftStep, readDriftStep},
      {"diffusion", number, 0, kDiffusionLimit / kOneQ16, "cells^2 per unit of time", {}, "", SPOOR_SHARE(diffusion_q16)},
      {"frictionInverse", number, 0, 0.4999, "cells per unit of time and newton", {}, "", nullptr, nullptr, applyFriction, readFriction},
      {"compactionLimit", number, 0, 1, "", {}, "", SPOOR_SHARE(compaction_limit_q16)},
      {"spreadCells", integer, 1, kSpreadCellsLimit, "cells", {}, "", SPOOR_FIELD(parameters.spread_cells)},
      {"capacityRounds", integer, 1, kCapacityRoundsLimit, "", {}, "", SPOOR_FIELD(parameters.capacity_rounds)},
  };
}
// clang-format on

#undef SPOOR_FIELD
#undef SPOOR_SHARE

}  // namespace

std::span<const NamedParameter> namedParameters() {
  static const std::vector<NamedParameter> list = makeList();
  return list;
}

std::int32_t slopeThreshold(double per_metre, std::int32_t cell_q) {
  using Extended = long double;
  constexpr Extended units = rules::kUnitsPerMetre;
  const Extended angle = Extended(per_metre) * cell_q / units;
  if (angle >= std::numbers::pi_v<Extended> / 2) return kNeverSteep;
  const Extended candidate = std::floor(std::tan(angle) * units);
  if (!(candidate < Extended(kLengthMost))) return kNeverSteep;
  const Extended steepest = angle * (1 + 4 * Extended(std::numeric_limits<double>::epsilon()));
  const auto rests = [&](std::int32_t difference_q) { return std::atan(difference_q / units) <= steepest; };
  auto threshold = std::int32_t(candidate);
  while (threshold > 0 && !rests(threshold)) --threshold;
  while (threshold < kLengthMost && rests(threshold + 1)) ++threshold;
  return threshold;
}

bool setRepose(double repose_deg, std::int32_t cell_q, MaterialRules& rules) {
  const double angle = repose_deg * std::numbers::pi / 180;
  const double rise_q = std::tan(angle) * cell_q;
  // A hair is added so that the tangent of 45 degrees, just under 1 in floats, keeps its last unit.
  const auto threshold = [](double units) { return std::int32_t(std::floor(units + 1e-6)); };
  rules.slope_threshold_q = std::max(1, threshold(rise_q));
  rules.diagonal_threshold_q = std::max(1, threshold(rise_q * std::numbers::sqrt2));
  rules.repose_q16 = reposeShare(angle);
  return threshold(rise_q) < 1;
}

std::int32_t diagonalThreshold(std::int32_t slope_threshold_q) {
  if (slope_threshold_q == kNeverSteep) return kNeverSteep;
  const std::uint32_t diagonal = isqrt(2 * std::uint64_t(slope_threshold_q) * std::uint64_t(slope_threshold_q));
  return diagonal > std::uint32_t(kLengthMost) ? kNeverSteep : std::int32_t(diagonal);
}

}  // namespace spoor
