#pragma once

#include <memory>
#include <span>

#include "shared/sim/backend.h"

namespace spoor {

/// What one tick did: for the network, the session file and the table of figures.
struct TickResult {
  TickUpdate update;      // as published
  TickEffect effect;      // its `changes` are those encoded in `update`
  bool too_fast = false;  // a body moved farther per sub-step than one cell; its trail may have gaps
};

/// A session's state and the rule that carries it from tick to tick. One thread; the backend has its own.
class Simulation {
 public:
  /// Starts at the pack's initial state. The base, and its pack, must outlive this.
  Simulation(const BaseTerrain& base, const PackId& id, std::unique_ptr<Backend> backend);
  /// Goes on from a state of the same pack, as from a snapshot.
  Simulation(const BaseTerrain& base, WorldState state, std::unique_ptr<Backend> backend);

  /// Runs one tick that takes the bodies to `poses`. Errors, which leave the state untouched: poses that validatePoses
  /// refuses, a tick that planTick finds too large.
  Result<TickResult> step(std::span<const Pose> poses);

  const WorldState& state() const { return state_; }
  const Backend& backend() const { return *backend_; }

 private:
  const BaseTerrain* base_;
  std::vector<std::int32_t> reach_q_;  // bodyReaches
  std::unique_ptr<Backend> backend_;
  WorldState state_;
};

}  // namespace spoor
