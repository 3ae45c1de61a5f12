#include "server/import/units.h"

#include <cmath>

#include "shaders/rules/limits.h"
#include "shared/base/assert.h"

namespace spoor {

std::int32_t toUnits(double metres) {
  SPOOR_ASSERT(std::abs(metres) < 2.1e5);
  return std::int32_t(std::llround(metres * rules::kUnitsPerMetre));
}

}  // namespace spoor
