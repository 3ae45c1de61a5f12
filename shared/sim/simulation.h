#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <span>

#include "shared/sim/backend.h"
#include "shared/world/tile_snow.h"

namespace spoor {

/// What one tick did: for the network, the session file and the table of figures.
struct TickResult {
  TickUpdate update;              // as published
  TickEffect effect;              // its `changes` are those encoded in `update`
  Ledger ledger;                  // after this tick
  std::size_t waiting_tiles = 0;  // TickPlan::waiting
  bool too_fast = false;          // a body moved farther per sub-step than one cell; its trail may have gaps
};

/// A session's state and the rule that carries it from tick to tick. One thread; the backend has its own.
class Simulation {
 public:
  /// Starts at the pack's initial state. The base, and its pack, must outlive this.
  Simulation(const BaseTerrain& base, const PackId& id, std::unique_ptr<Backend> backend);
  /// Goes on from a state of the same pack, as from a snapshot.
  /// @param tile_limit  of planTick; the same for all who run a session
  Simulation(const BaseTerrain& base, WorldState state, std::unique_ptr<Backend> backend,
             std::size_t tile_limit = kTickTilesLimit);

  /// Runs one tick that takes the bodies to `poses`: begin() and finish().
  Result<TickResult> step(std::span<const Pose> poses, const std::optional<Parameters>& parameters = {},
                          std::span<const Crater> craters = {}, std::span<const Snowfall> snowfalls = {});

  /// The first half: plans the tick and hands it to the backend. Where that computes on a device, this may return long
  /// before the device is done: time to finish the tick before. Two ticks may be begun and not finished (asserted).
  /// @param parameters  from this tick on, where they change. They wake nothing: soil at rest stays until it is
  /// reached.
  /// @param craters  that come with this tick; their tick and id are set here. Live tiles take them at once.
  /// @param snowfalls  that come with this tick, and begin with it or later
  /// Errors, which leave the state untouched: poses, parameters, craters or snowfalls that validatePoses,
  /// validateParameters, validateCrater and validateNewSnowfalls refuse, more craters than a tick or a session may
  /// have, a tick that planTick finds too large. Errors after which the session cannot go on: a device that is lost or
  /// has not the memory.
  [[nodiscard]] Status begin(std::span<const Pose> poses, const std::optional<Parameters>& parameters = {},
                             std::span<const Crater> craters = {}, std::span<const Snowfall> snowfalls = {});

  /// The second half, of the oldest tick begun (asserted): waits for it, and encodes what it changed.
  /// Errors: the device is lost; the session cannot go on, and every later call says so again.
  Result<TickResult> finish();

  static constexpr std::size_t kTicksInFlight = 2;
  /// Ticks begun and not finished.
  std::size_t inFlight() const { return in_flight_.size() + (submitted_ ? 1 : 0); }

  /// After the last tick finished, but where another has been begun since: then craters are of that one, tick, poses,
  /// hashes and sums may be, and cells of either.
  const WorldState& state() const { return state_; }
  const Backend& backend() const { return *backend_; }

 private:
  Status settle();
  void takeBack(const TickResult& tick);

  const BaseTerrain* base_;
  std::vector<std::int32_t> reach_q_;  // bodyReaches
  std::size_t tile_limit_;
  std::unique_ptr<Backend> backend_;
  WorldState state_;
  std::optional<TickResult> submitted_;  // with the backend; without its effect, and the state knows nothing of it but
                                         // its craters, snowfalls and the snow on tiles that are asleep
  std::optional<SnowOfTick> snow_;       // of the submitted tick, on those
  std::vector<TileCoordinate> waiting_snow_;  // tiles that are awake, wait in that tick, and take its snow after it
  std::optional<Error> failure_;              // of the backend; nothing goes on after it
  std::deque<TickResult> in_flight_;          // settled, their cells not collected
};

}  // namespace spoor
