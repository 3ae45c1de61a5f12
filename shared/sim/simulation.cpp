#include "shared/sim/simulation.h"

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

Simulation::Simulation(const BaseTerrain& base, WorldState state, std::unique_ptr<Backend> backend)
    : base_(&base), reach_q_(bodyReaches(base.pack())), backend_(std::move(backend)), state_(std::move(state)) {
  backend_->forget();
}

Result<TickResult> Simulation::step(std::span<const Pose> poses, const std::optional<Parameters>& parameters,
                                    std::span<const Crater> craters) {
  if (Status status = begin(poses, parameters, craters); !status) return Error{status.error()};
  return finish();
}

Status Simulation::begin(std::span<const Pose> poses, const std::optional<Parameters>& parameters,
                         std::span<const Crater> craters) {
  SPOOR_ASSERT(inFlight() < kTicksInFlight);
  if (Status status = validatePoses(base_->pack(), poses); !status) return status;
  if (parameters)
    if (Status status = validateParameters(base_->pack(), *parameters); !status) return status;
  if (Status status = validateNewCraters(base_->pack(), craters, state_.craters.size(), state_.craters.hashCells());
      !status)
    return status;
  if (Status status = settle(); !status) return status;
  TickResult result;
  result.update.craters = numbered(craters, state_.tick + 1, state_.craters.size());
  Result<TickPlan> plan = [&] {
    StageTimer timer(result.effect.stage_ms, Stage::active);
    return planTick(base_->pack(), reach_q_, state_, poses, parameters.value_or(state_.parameters),
                    result.update.craters);
  }();
  if (!plan) return Error{plan.error()};
  result.update.tick = plan->tick;
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
    return failure_.emplace(Error{status.error()});
  }
  submitted_ = std::move(result);
  return {};
}

/// Takes the state to the submitted tick, if there is one.
Status Simulation::settle() {
  if (failure_) return *failure_;
  if (!submitted_) return {};
  auto effect = backend_->settle(state_);
  if (!effect) {
    state_.craters.truncate(state_.craters.size() - submitted_->update.craters.size());
    return failure_.emplace(Error{effect.error()});
  }
  TickResult result = *std::exchange(submitted_, std::nullopt);
  for (int stage = 0; stage < kStageCount; ++stage) effect->stage_ms[stage] += result.effect.stage_ms[stage];
  result.effect = std::move(*effect);
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
      if (submitted_) state_.craters.truncate(state_.craters.size() - submitted_->update.craters.size());
      return failure_.emplace(Error{status.error()});
    }
    result.update.tiles = encodeTiles(result.effect.changes);
  }
  return result;
}

}  // namespace spoor
