#include "shared/sim/simulation.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "shared/base/assert.h"

namespace spoor {
namespace {

std::vector<Crater> numbered(std::span<const Crater> craters, std::int32_t tick, std::size_t first_id) {
  std::vector<Crater> result(craters.begin(), craters.end());
  for (Crater& crater : result) {
    crater.tick = tick;
    crater.id = std::uint32_t(first_id++);
  }
  return result;
}

}  // namespace

Simulation::Simulation(const BaseTerrain& base, const PackId& id, std::unique_ptr<Backend> backend)
    : Simulation(base, initialState(id, base), std::move(backend)) {}

Simulation::Simulation(const BaseTerrain& base, WorldState state, std::unique_ptr<Backend> backend,
                       std::size_t tile_limit)
    : base_(&base),
      reach_q_(bodyReaches(base.pack())),
      tile_limit_(tile_limit),
      backend_(std::move(backend)),
      state_(std::move(state)) {
  backend_->forget();
}

Result<TickResult> Simulation::step(std::span<const Pose> poses, const std::optional<Parameters>& parameters,
                                    std::span<const Crater> craters, std::span<const Snowfall> snowfalls) {
  if (Status status = begin(poses, parameters, craters, snowfalls); !status) return Error{status.error()};
  return finish();
}

Status Simulation::begin(std::span<const Pose> poses, const std::optional<Parameters>& parameters,
                         std::span<const Crater> craters, std::span<const Snowfall> snowfalls) {
  SPOOR_ASSERT(inFlight() < kTicksInFlight);
  const ScenePack& pack = base_->pack();
  if (Status status = validatePoses(pack, poses); !status) return status;
  if (parameters)
    if (Status status = validateParameters(pack, *parameters); !status) return status;
  if (Status status = validateNewCraters(pack, craters, state_.craters.size(), state_.craters.hashCells()); !status)
    return status;
  if (Status status = settle(); !status) return status;
  const std::int32_t tick = state_.tick + 1;
  if (Status status = validateNewSnowfalls(pack, snowfalls, tick, state_.snowfalls.size()); !status) return status;
  TickResult result;
  result.update.tick = tick;
  result.update.craters = numbered(craters, tick, state_.craters.size());
  result.update.snowfalls.assign(snowfalls.begin(), snowfalls.end());
  state_.snowfalls.insert(state_.snowfalls.end(), snowfalls.begin(), snowfalls.end());
  std::vector<TileCoordinate> in_snow;
  {
    StageTimer timer(result.effect.stage_ms, Stage::craters);
    for (const Tile* tile : tilesInSnow(state_, tick, SnowTiles::awake)) in_snow.push_back(tile->at);
    snow_.emplace(state_, pack, tick, SnowTiles::asleep);
  }
  Result<TickPlan> plan = [&] {
    StageTimer timer(result.effect.stage_ms, Stage::active);
    return planTick(pack, reach_q_, state_, poses, parameters.value_or(state_.parameters), result.update.craters,
                    tile_limit_);
  }();
  if (!plan) {
    takeBack(result);
    return Error{plan.error()};
  }
  backend_->tilesChanged(snow_->tiles());
  waiting_snow_.clear();
  std::ranges::set_difference(in_snow, plan->active, std::back_inserter(waiting_snow_));
  plan->in_snow = std::move(in_snow);
  result.update.poses.assign(poses.begin(), poses.end());
  result.update.parameters = parameters;
  result.waiting_tiles = plan->waiting.size();
  result.too_fast = plan->too_fast;
  {
    StageTimer timer(result.effect.stage_ms, Stage::craters);
    state_.craters.add(result.update.craters);
  }
  if (Status status = backend_->submit(std::move(*plan), *base_, state_); !status) {
    state_.craters.truncate(state_.craters.size() - craters.size());
    takeBack(result);
    return failure_.emplace(Error{status.error()});
  }
  submitted_ = std::move(result);
  return {};
}

/// Undoes what the state knows of a tick that does not come about, but for its craters.
void Simulation::takeBack(const TickResult& tick) {
  snow_->takeBack(state_);
  snow_.reset();
  state_.snowfalls.resize(state_.snowfalls.size() - tick.update.snowfalls.size());
}

/// Takes the state to the submitted tick, if there is one.
Status Simulation::settle() {
  if (failure_) return *failure_;
  if (!submitted_) return {};
  auto effect = backend_->settle(state_);
  if (!effect) {
    state_.craters.truncate(state_.craters.size() - submitted_->update.craters.size());
    takeBack(*submitted_);
    return failure_.emplace(Error{effect.error()});
  }
  TickResult result = *std::exchange(submitted_, std::nullopt);
  for (int stage = 0; stage < kStageCount; ++stage) effect->stage_ms[stage] += result.effect.stage_ms[stage];
  result.effect = std::move(*effect);
  std::vector<Tile*> waiting;
  for (const TileCoordinate at : waiting_snow_) {
    waiting.push_back(state_.tiles.find(at));
    snowOnTile(*waiting.back(), base_->pack(), result.update.tick, state_);
  }
  backend_->tilesChanged(waiting);
  state_.tick = result.update.tick;
  if (result.update.parameters) state_.parameters = *result.update.parameters;
  state_.previous_poses = std::exchange(state_.poses, result.update.poses);
  result.ledger = state_.ledger;
  {
    StageTimer timer(result.effect.stage_ms, Stage::hash);
    result.update.state_hash = stateHash(state_);
  }
  in_flight_.push_back(std::move(result));
  return {};
}

Result<TickResult> Simulation::finish() {
  SPOOR_ASSERT(inFlight() > 0);
  if (in_flight_.empty())
    if (Status status = settle(); !status) return Error{status.error()};
  TickResult result = std::move(in_flight_.front());
  in_flight_.pop_front();
  {
    StageTimer timer(result.effect.stage_ms, Stage::delta);
    if (Status status = backend_->collect(state_, result.effect.changes); !status) {
      if (submitted_) {
        state_.craters.truncate(state_.craters.size() - submitted_->update.craters.size());
        takeBack(*submitted_);
      }
      return failure_.emplace(Error{status.error()});
    }
    result.update.tiles = encodeTiles(result.effect.changes);
  }
  return result;
}

}  // namespace spoor
