#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "server/named_parameters.h"
#include "server/waiting_queue.h"

namespace spoor {

/// Parameters that change in a running session.
struct ParameterChange {
  std::int32_t tick = 0;  // from this one on; 0: from the next one that begins
  std::vector<NamedValue> values;
};

/// Reads "[MATERIAL.]NAME=VALUE[,...]". Safe on untrusted text. Errors besides parseNamed's: names of what a running
/// session cannot change.
Result<std::vector<NamedValue>> parseAssignments(std::string_view text);

/// Reads "TICK:[MATERIAL.]NAME=VALUE[,...]". Safe on untrusted text.
Result<ParameterChange> parseChange(std::string_view text);

/// Changes on their way from a thread that makes them to the tick loop.
using ChangeQueue = WaitingQueue<ParameterChange>;

}  // namespace spoor
