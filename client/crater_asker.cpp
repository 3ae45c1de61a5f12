#include "client/crater_asker.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

namespace spoor {

CraterAsker::CraterAsker(std::vector<TimedCrater> craters) : craters_(std::move(craters)) {
  std::ranges::stable_sort(craters_, {}, &TimedCrater::tick);
}

void CraterAsker::update(ClientSession& session) {
  if (!session.inSync()) return;
  for (; next_ < craters_.size() && craters_[next_].tick <= session.state().tick && !session.ended(); ++next_)
    session.requestCrater(craters_[next_].wish);
  for (const CraterOutcome& outcome : session.takeCraterOutcomes()) {
    if (outcome.tick > 0)
      fmt::print("request {}: crater {} with tick {}\n", outcome.sequence, outcome.id, outcome.tick);
    else
      fmt::print("request {}: refused: {}\n", outcome.sequence, outcome.reason);
    std::fflush(stdout);
  }
}

void CraterAsker::finish() const {
  for (std::size_t i = next_; i < craters_.size(); ++i)
    fmt::print("--crater at tick {}: the session has ended before\n", craters_[i].tick);
}

}  // namespace spoor
