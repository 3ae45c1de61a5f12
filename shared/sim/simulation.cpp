#include "shared/sim/simulation.h"

#include "shared/base/assert.h"

namespace spoor {

Simulation::Simulation(const BaseTerrain& base, const PackId& id, std::unique_ptr<Backend> backend)
    : Simulation(base, initialState(id, base), std::move(backend)) {}

Simulation::Simulation(const BaseTerrain& base, WorldState state, std::unique_ptr<Backend> backend)
    : base_(&base), reach_q_(bodyReaches(base.pack())), backend_(std::move(backend)), state_(std::move(state)) {
  backend_->forget();
}

Result<TickResult> Simulation::step(std::span<const Pose> poses) {
  if (Status status = begin(poses); !status) return Error{status.error()};
  return finish();
}

Status Simulation::begin(std::span<const Pose> poses) {
  SPOOR_ASSERT(in_flight_.size() < kTicksInFlight);
  if (Status status = validatePoses(base_->pack(), poses); !status) return status;
  StageTimes planning{};
  Result<TickPlan> planned = [&] {
    StageTimer timer(planning, Stage::active);
    return planTick(base_->pack(), reach_q_, state_, poses);
  }();
  if (!planned) return Error{planned.error()};
  const TickPlan& plan = *planned;
  auto effect = backend_->run(plan, *base_, state_);
  if (!effect) return Error{effect.error()};
  state_.tick = plan.tick;
  state_.previous_poses = std::move(state_.poses);
  state_.poses.assign(poses.begin(), poses.end());

  TickResult& result = in_flight_.emplace_back();
  result.effect = std::move(*effect);
  result.effect.stage_ms[int(Stage::active)] += planning[int(Stage::active)];
  result.too_fast = plan.too_fast;
  result.update.tick = state_.tick;
  result.update.poses = state_.poses;
  StageTimer timer(result.effect.stage_ms, Stage::hash);
  result.update.state_hash = stateHash(state_);
  return {};
}

Result<TickResult> Simulation::finish() {
  SPOOR_ASSERT(!in_flight_.empty());
  TickResult result = std::move(in_flight_.front());
  in_flight_.pop_front();
  {
    StageTimer timer(result.effect.stage_ms, Stage::delta);
    if (Status status = backend_->collect(state_, result.effect.changes); !status) return Error{status.error()};
    result.update.tiles = encodeTiles(result.effect.changes);
  }
  return result;
}

}  // namespace spoor
