#pragma once

#include <map>

#include "server/crater_feed.h"
#include "server/snowfall_feed.h"
#include "server/tick_loop.h"

namespace spoor {

/// What goes into a session's ticks besides poses: parameters where they change, craters and snowfalls.
class TickInputs {
 public:
  using Say = CraterFeed::Say;

  /// All arguments outlive this.
  TickInputs(const ScenePack& pack, const Script& script, const Parameters& start, const LoopOptions& options,
             SessionHost* host, const Say& say);

  /// Begins a tick with all that is there for it. Where it cannot begin so, with less: without the craters that were
  /// asked for, without the new parameters, without the scene's craters, in this order; what is left out is said.
  /// Errors: it cannot begin with none of them.
  [[nodiscard]] Status begin(Simulation& simulation, std::int32_t tick, const std::vector<Pose>& poses);

  const CraterFeed& craters() const { return craters_; }
  const SnowfallFeed& snowfalls() const { return snowfalls_; }
  /// A tick has been published.
  void published(std::int32_t tick) { craters_.published(tick); }

 private:
  void apply(const ParameterChange& change, std::int32_t tick);

  const ScenePack& pack_;
  Parameters parameters_;
  ChangeQueue* console_;
  std::map<std::int32_t, std::vector<ParameterChange>> changes_;
  CraterFeed craters_;
  SnowfallFeed snowfalls_;
  const Say& say_;
};

}  // namespace spoor
