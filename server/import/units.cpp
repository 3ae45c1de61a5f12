#include "server/import/units.h"

#include <fmt/format.h>

#include <cmath>

#include "shaders/rules/limits.h"
#include "shared/base/assert.h"

namespace spoor {

std::int32_t toUnits(double metres) {
  SPOOR_ASSERT(std::abs(metres) < 2.1e5);
  return std::int32_t(std::llround(metres * rules::kUnitsPerMetre));
}

std::string plainNumber(double value) {
  const bool is_whole = std::abs(value) < 1e9 && value == std::floor(value);
  return is_whole ? fmt::format("{:.0f}", value) : fmt::format("{:.7g}", value);
}

}  // namespace spoor
