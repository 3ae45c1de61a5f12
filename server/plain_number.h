#pragma once

#include <string>

namespace spoor {

/// A number for a message, no longer than it needs: "0.05", "12.345", "536870912".
std::string plainNumber(double value);

}  // namespace spoor
