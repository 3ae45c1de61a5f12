#include "server/plain_number.h"

#include <cmath>
#include <cstdio>

namespace spoor {

std::string plainNumber(double value) {
  char text[64];
  const bool is_whole = std::abs(value) < 1e10 && value == std::floor(value);
  std::snprintf(text, sizeof text, is_whole ? "%.0f" : "%.7g", value);
  return text;
}

}  // namespace spoor
