#pragma once

#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "server/named_parameters.h"

namespace spoor {

/// Parameters that change in a running session.
struct ParameterChange {
  std::int32_t tick = 0;  // from this one on; 0: from the next one that begins
  std::vector<NamedValue> values;
};

/// Reads "NAME=VALUE[,NAME=VALUE...]". Safe on untrusted text. Errors besides parseNamed's: names of what a running
/// session cannot change.
Result<std::vector<NamedValue>> parseAssignments(std::string_view text);

/// Reads "TICK:NAME=VALUE[,NAME=VALUE...]". Safe on untrusted text.
Result<ParameterChange> parseChange(std::string_view text);

/// Changes on their way from a thread that makes them to the tick loop, which never waits for it.
class ChangeQueue {
 public:
  static constexpr std::size_t kLimit = 1024;

  /// False: there are kLimit already.
  [[nodiscard]] bool push(ParameterChange change);
  /// Takes what has come, or nothing where push() is at work this very moment: then it comes with the next tick.
  std::vector<ParameterChange> tryTake();

 private:
  std::mutex mutex_;
  std::vector<ParameterChange> changes_;
};

}  // namespace spoor
