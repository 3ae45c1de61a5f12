#include "shared/sim/simulation.h"

namespace spoor {

Simulation::Simulation(const BaseTerrain& base, const PackId& id, std::unique_ptr<Backend> backend)
    : Simulation(base, initialState(id, base), std::move(backend)) {}

Simulation::Simulation(const BaseTerrain& base, WorldState state, std::unique_ptr<Backend> backend)
    : base_(&base), backend_(std::move(backend)), state_(std::move(state)) {}

Result<TickResult> Simulation::step(std::span<const Pose> poses) {
  if (Status status = validatePoses(base_->pack(), poses); !status) return Error{status.error()};
  StageTimes planning{};
  TickPlan plan;
  {
    StageTimer timer(planning, Stage::active);
    plan = planTick(base_->pack(), state_, poses);
  }
  TickResult result;
  result.effect = backend_->run(plan, *base_, state_);
  result.effect.stage_ms[int(Stage::active)] += planning[int(Stage::active)];
  result.too_fast = plan.too_fast;
  state_.tick = plan.tick;
  state_.previous_poses = std::move(state_.poses);
  state_.poses.assign(poses.begin(), poses.end());

  result.update.tick = state_.tick;
  result.update.poses = state_.poses;
  {
    StageTimer timer(result.effect.stage_ms, Stage::hash);
    result.update.state_hash = stateHash(state_);
  }
  {
    StageTimer timer(result.effect.stage_ms, Stage::delta);
    result.update.tiles = encodeTiles(result.effect.changes);
  }
  return result;
}

}  // namespace spoor
