#pragma once

#include <algorithm>
#include <vector>

namespace spoor {

/// The value below which `share` (0..1) of the values lie; 0 where there are none.
inline double percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const std::size_t at = std::min(values.size() - 1, std::size_t(share * double(values.size())));
  std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(at), values.end());
  return values[at];
}

}  // namespace spoor
