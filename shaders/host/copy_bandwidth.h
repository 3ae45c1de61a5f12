#pragma once

#include <string>

#include "shared/base/result.h"

namespace spoor {

/// Speed at which a device copies a large buffer within its memory: 10^9 bytes read and written per second, the median
/// of several rounds. Takes about a second; leaves what is current on this thread as it is.
/// @param device  openHeadlessContext
/// Errors: no context; the device has not the memory, or is lost.
Result<double> measureCopyBandwidth(const std::string& device);

}  // namespace spoor
