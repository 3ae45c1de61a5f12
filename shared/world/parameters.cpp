#include "shared/world/parameters.h"

#include <string>

#include "shaders/rules/nearest.h"

namespace spoor {
namespace {

static_assert(int(Metric::euclidean) == rules::kEuclidean && int(Metric::manhattan) == rules::kManhattan &&
              int(Metric::chebyshev) == rules::kChebyshev);

constexpr std::int32_t kLengthLimit = 1 << 29;  // 0.1 mm; as high as the base may lie

/// The one list of fields behind the bytes and the checks: visit(value, name, lowest, highest).
template <typename ParametersType, typename Visit>
void visitFields(ParametersType& p, Visit visit) {
  visit(p.displacement, "displacement", 0, int(Displacement::spread));
  visit(p.nearest, "nearest", 0, int(NearestSearch::jump_flooding_squared));
  visit(p.metric, "metric", 0, int(Metric::chebyshev));
  visit(p.slopes, "slopes", 0, int(SlopeRule::scatter));
  visit(p.active_areas, "active_areas", 0, 1);
  visit(p.displace_iterations, "displace_iterations", 0, kIterationsLimit);
  visit(p.sweeps_per_tick, "sweeps_per_tick", 0, kIterationsLimit);
  visit(p.compression_q16, "compression_q16", 0, kOneQ16);
  visit(p.compaction_limit_q16, "compaction_limit_q16", 0, kOneQ16);
  visit(p.roughness_q16, "roughness_q16", 0, kOneQ16);
  visit(p.slope_threshold_q, "slope_threshold_q", 0, kLengthLimit);
  visit(p.diagonal_threshold_q, "diagonal_threshold_q", 0, kLengthLimit);
  visit(p.obstacle_threshold_q, "obstacle_threshold_q", 0, kLengthLimit);
  visit(p.penetration_divider_q, "penetration_divider_q", 1, kLengthLimit);
  visit(p.spread_cells, "spread_cells", 1, kSpreadCellsLimit);
  visit(p.capacity_rounds, "capacity_rounds", 1, kCapacityRoundsLimit);
  visit(p.active_margin_cells, "active_margin_cells", 0, kActiveMarginLimit);
  visit(p.frustum_height_q, "frustum_height_q", 0, kLengthLimit);
}

/// How a field is stored: choices and flags in a byte, numbers in four.
template <typename T>
using Stored = std::conditional_t<sizeof(T) == 1, std::uint8_t, std::int32_t>;

}  // namespace

Status validateParameters(const Parameters& parameters) {
  Status status;
  visitFields(parameters, [&](const auto& field, const char* name, std::int32_t lowest, std::int32_t highest) {
    const std::int64_t value = std::int64_t(field);
    const bool is_threshold = &field == static_cast<const void*>(&parameters.slope_threshold_q) ||
                              &field == static_cast<const void*>(&parameters.diagonal_threshold_q);
    if (!status || (value >= lowest && value <= highest) || (is_threshold && value == kNeverSteep)) return;
    status = Error{std::string("parameters: ") + name + " is " + std::to_string(value) + ", not within " +
                   std::to_string(lowest) + " .. " + std::to_string(highest)};
  });
  return status;
}

void putParameters(ByteWriter& writer, const Parameters& parameters) {
  visitFields(parameters,
              [&](const auto& field, auto&&...) { writer.put(Stored<std::remove_cvref_t<decltype(field)>>(field)); });
}

Parameters getParameters(ByteReader& reader) {
  Parameters parameters;
  visitFields(parameters, [&](auto& field, auto&&...) {
    using Field = std::remove_reference_t<decltype(field)>;
    field = Field(reader.get<Stored<Field>>());
  });
  return parameters;
}

}  // namespace spoor
