#include "shared/world/parameters.h"

#include <algorithm>
#include <string>

#include "shaders/rules/nearest.h"
#include "shared/base/fixed.h"
#include "shared/world/material.h"

namespace spoor {
namespace {

static_assert(int(Metric::euclidean) == rules::kEuclidean && int(Metric::manhattan) == rules::kManhattan &&
              int(Metric::chebyshev) == rules::kChebyshev);

constexpr std::int32_t kLengthLimit = 1 << 29;  // 0.1 mm; as high as the base may lie

/// The one list of fields behind the bytes and the checks: visit(value, name, lowest, highest).
template <typename ParametersType, typename Visit>
void visitFields(ParametersType& p, Visit visit) {
  visit(p.displacement, "displacement", 0, int(Displacement::none));
  visit(p.nearest, "nearest", 0, int(NearestSearch::jump_flooding_squared));
  visit(p.metric, "metric", 0, int(Metric::chebyshev));
  visit(p.slopes, "slopes", 0, int(SlopeRule::drift));
  visit(p.drift_weights, "drift_weights", 0, int(DriftWeights::slope));
  visit(p.active_areas, "active_areas", 0, 1);
  visit(p.displace_iterations, "displace_iterations", 0, kIterationsLimit);
  visit(p.sweeps_per_tick, "sweeps_per_tick", 0, kIterationsLimit);
  visit(p.drift_step_q16, "drift_step_q16", 1, kDriftStepLimit);
  visit(p.obstacle_threshold_q, "obstacle_threshold_q", 0, kLengthLimit);
  visit(p.penetration_divider_q, "penetration_divider_q", 1, kLengthLimit);
  visit(p.spread_cells, "spread_cells", 1, kSpreadCellsLimit);
  visit(p.capacity_rounds, "capacity_rounds", 1, kCapacityRoundsLimit);
  visit(p.active_margin_cells, "active_margin_cells", 0, kActiveMarginLimit);
  visit(p.frustum_height_q, "frustum_height_q", 0, kLengthLimit);
}

/// The same of one material.
template <typename RulesType, typename Visit>
void visitMaterial(RulesType& r, Visit visit) {
  visit(r.slope_threshold_q, "slope_threshold_q", 0, kLengthLimit);
  visit(r.diagonal_threshold_q, "diagonal_threshold_q", 0, kLengthLimit);
  visit(r.compression_q16, "compression_q16", 0, kOneQ16);
  visit(r.compaction_limit_q16, "compaction_limit_q16", 0, kOneQ16);
  visit(r.roughness_q16, "roughness_q16", 0, kOneQ16);
  visit(r.diffusion_q16, "diffusion_q16", 0, kDiffusionLimit);
  visit(r.friction_inverse_q32, "friction_inverse_q32", 0, INT32_MAX);
  visit(r.repose_q16, "repose_q16", 0, kReposeLimit);
}

/// How a field is stored: choices and flags in a byte, numbers in four.
template <typename T>
using Stored = std::conditional_t<sizeof(T) == 1, std::uint8_t, std::int32_t>;

}  // namespace

Status validateParameters(const Parameters& parameters) {
  Status status;
  std::string of_material;
  const MaterialRules* material = nullptr;
  const auto check = [&](const auto& field, const char* name, std::int32_t lowest, std::int32_t highest) {
    const std::int64_t value = std::int64_t(field);
    const bool is_threshold =
        material != nullptr && (&field == static_cast<const void*>(&material->slope_threshold_q) ||
                                &field == static_cast<const void*>(&material->diagonal_threshold_q));
    if (!status || (value >= lowest && value <= highest) || (is_threshold && value == kNeverSteep)) return;
    status = Error{"parameters: " + of_material + name + " is " + std::to_string(value) + ", not within " +
                   std::to_string(lowest) + " .. " + std::to_string(highest)};
  };
  visitFields(parameters, check);
  if (parameters.materials.empty() || parameters.materials.size() > kMaterialsLimit)
    return Error{"parameters: of " + std::to_string(parameters.materials.size()) + " materials, not within 1 .. " +
                 std::to_string(kMaterialsLimit)};
  for (const MaterialRules& rules : parameters.materials) {
    material = &rules;
    of_material = "material " + std::to_string(&rules - parameters.materials.data()) + ": ";
    visitMaterial(rules, check);
  }
  if (!status || parameters.slopes != SlopeRule::drift) return status;
  const int sweeps = sweepsOf(parameters);
  if (sweeps > kIterationsLimit)
    return Error{"parameters: sweeps_per_tick " + std::to_string(parameters.sweeps_per_tick) + " of " +
                 std::to_string(driftSteps(parameters)) + " drift steps each are " + std::to_string(sweeps) +
                 ", the limit is " + std::to_string(kIterationsLimit)};
  return status;
}

bool anyCompression(const Parameters& parameters) {
  return std::ranges::any_of(
      parameters.materials, [](std::int32_t share) { return share > 0; }, &MaterialRules::compression_q16);
}

int driftSteps(const Parameters& parameters) {
  std::int64_t fastest_q16 = 0;
  for (const MaterialRules& rules : parameters.materials) {
    std::int64_t rate_q16 = rules.diffusion_q16;
    if (parameters.drift_weights == DriftWeights::displacement)
      rate_q16 = -floorDiv(-rate_q16 * (2 * kOneQ16 - rules.repose_q16), kOneQ16 - rules.repose_q16);
    fastest_q16 = std::max(fastest_q16, rate_q16);
  }
  const std::int64_t by_diffusion = -floorDiv(-8 * fastest_q16 * parameters.drift_step_q16, std::int64_t(1) << 32);
  const std::int64_t by_time = -floorDiv(-std::int64_t(parameters.drift_step_q16), std::int64_t(kOneQ16));
  return int(std::max<std::int64_t>({by_diffusion, by_time, 1}));
}

int sweepsOf(const Parameters& parameters) {
  return parameters.sweeps_per_tick * (parameters.slopes == SlopeRule::drift ? driftSteps(parameters) : 1);
}

void putParameters(ByteWriter& writer, const Parameters& parameters) {
  const auto put = [&](const auto& field, auto&&...) {
    writer.put(Stored<std::remove_cvref_t<decltype(field)>>(field));
  };
  visitFields(parameters, put);
  writer.put(std::uint8_t(parameters.materials.size()));
  for (const MaterialRules& rules : parameters.materials) visitMaterial(rules, put);
}

Parameters getParameters(ByteReader& reader) {
  Parameters parameters;
  const auto get = [&](auto& field, auto&&...) {
    using Field = std::remove_reference_t<decltype(field)>;
    field = Field(reader.get<Stored<Field>>());
  };
  visitFields(parameters, get);
  const std::size_t count = reader.get<std::uint8_t>();
  if (count > kMaterialsLimit) (void)reader.getBytes(reader.left() + 1);
  parameters.materials.resize(reader.failed() ? 0 : count);
  for (MaterialRules& rules : parameters.materials) visitMaterial(rules, get);
  return parameters;
}

}  // namespace spoor
