#pragma once

#include <cstdint>

#include "server/plain_number.h"

namespace spoor {

/// Metres to 0.1 mm units, rounded to nearest. Range: |metres| < 210 000 (asserted).
std::int32_t toUnits(double metres);

}  // namespace spoor
