#pragma once

#include <deque>
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

  /// Runs one tick that takes the bodies to `poses`: begin() and finish().
  Result<TickResult> step(std::span<const Pose> poses);

  /// The first half: plans the tick and runs its stages. Afterwards the state's hash, ledger and poses are the new
  /// tick's, its cells may not be yet. Two ticks may be begun and not finished (asserted), so that one is encoded and
  /// published while a device works on the next.
  /// Errors, which leave the state untouched: poses that validatePoses refuses, a tick that planTick finds too large, a
  /// device that is lost or has not the memory.
  [[nodiscard]] Status begin(std::span<const Pose> poses);

  /// The second half, of the oldest tick begun (asserted): its changed cells, encoded.
  /// Errors: the device is lost; the session cannot go on.
  Result<TickResult> finish();

  static constexpr std::size_t kTicksInFlight = 2;

  const WorldState& state() const { return state_; }
  const Backend& backend() const { return *backend_; }

 private:
  const BaseTerrain* base_;
  std::vector<std::int32_t> reach_q_;  // bodyReaches
  std::unique_ptr<Backend> backend_;
  WorldState state_;
  std::deque<TickResult> in_flight_;
};

}  // namespace spoor
