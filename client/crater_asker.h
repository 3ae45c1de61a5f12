#pragma once

#include <vector>

#include "client/session.h"

namespace spoor {

/// Asks for craters at their ticks, and prints what became of them and of all others that the session asks for.
class CraterAsker {
 public:
  explicit CraterAsker(std::vector<TimedCrater> craters);

  /// To be called after each update of the session. Asks for what is due as soon as the session holds its tick.
  void update(ClientSession& session);
  /// Prints which were never asked for, once the session has ended.
  void finish() const;

 private:
  std::vector<TimedCrater> craters_;  // by tick
  std::size_t next_ = 0;
};

}  // namespace spoor
