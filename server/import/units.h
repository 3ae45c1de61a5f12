#pragma once

#include <cstdint>
#include <string>

namespace spoor {

/// Metres to 0.1 mm units, rounded to nearest. Range: |metres| < 210 000 (asserted).
std::int32_t toUnits(double metres);

/// A number for a message, no longer than it needs: "0.05", "12.345".
std::string plainNumber(double value);

}  // namespace spoor
