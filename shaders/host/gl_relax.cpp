// Stage relax, by the rule that the tick's parameters choose.
#include "shaders/host/gl_stages.h"
#include "shaders/rules/drift.h"

namespace spoor {

void GlStages::relax(const TickTables& tick, int i) {
  const SubStepTables& step = tick.sub_steps[std::size_t(i)];
  const bool pushes = step.push_blocks.count > 0;
  if (pushes) push(tick, step);
  if (tick.parameters.displacement == Displacement::none) {
    beginUndersides(tick, step);
    findCeilings(tick, step);
  }
  if (step.sweep_count == 0) return;
  bindMaterials(tick);
  const SlopeRule rule = tick.parameters.slopes;
  if (rule == SlopeRule::scatter) clearNextHeights(tick);
  for (int sweep = 0; sweep < step.sweep_count; ++sweep) {
    const int first_step = step.first_step + sweep * rules::kMatchingCount;
    if (rule == SlopeRule::drift)
      sweepDrift(tick, step.first_step / rules::kMatchingCount + sweep, pushes);
    else if (rule != SlopeRule::exchange)
      sweepSlopes(tick);
    else if (schedule_ == RelaxSchedule::fused)
      sweepFused(tick, first_step);
    else
      sweepPlain(tick, first_step);
  }
}

void GlStages::sweepPlain(const TickTables& tick, int first_step) {
  bindCells(tick);
  for (int matching = 0; matching < rules::kMatchingCount; ++matching) {
    use(*chosen_.exchange[std::size_t(matching)][tick.beneath ? 1 : 0]);
    setUniform(2, first_step + matching);
    setUniform(3, skip_settled_ ? 1 : 0);
    setUniform(4, int(tick.tile_index.size()));
    setUniform(5, tick.parameters.obstacle_threshold_q);
    dispatch(tick.exchange);
  }
}

void GlStages::sweepFused(const TickTables& tick, int first_step) {
  bindCells(tick);
  height_[1 - current_].bind(rules::kBindNextHeight);
  use(*chosen_.sweep);
  setUniform(2, first_step);
  setUniform(3, skip_settled_ ? 1 : 0);
  dispatch(tick.sweep);
  current_ = 1 - current_;
}

/// Planes of heights take turns: of three with scatter, whose third is 0 when its turn as the next comes.
int GlStages::nextHeights(const TickTables& tick, int turns) const {
  return (current_ + turns) % (tick.parameters.slopes == SlopeRule::scatter ? 3 : 2);
}

void GlStages::clearNextHeights(const TickTables& tick) {
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);  // shaders wrote there, in an earlier sub-step
  const std::int64_t bytes = std::int64_t(tick.tile_index.size() * sizeof(PlaneCells));
  glClearNamedBufferSubData(height_[nextHeights(tick, 1)].name(), GL_R32I, 0, bytes, GL_RED_INTEGER, GL_INT, nullptr);
}

void GlStages::sweepSlopes(const TickTables& tick) {
  const auto beneath = std::size_t(tick.beneath ? 1 : 0);
  bindCells(tick);
  const auto run = [&](const GlProgram& program) {
    use(program);
    setUniform(2, int(tick.tile_index.size()));
    setUniform(3, tick.parameters.obstacle_threshold_q);
    dispatch(tick.slope);
  };
  if (tick.parameters.slopes == SlopeRule::interleaved) {
    amounts_.bind(rules::kBindAmounts);
    run(*chosen_.slope_amounts[beneath]);
  }
  height_[nextHeights(tick, 1)].bind(rules::kBindNextHeight);
  if (tick.parameters.slopes == SlopeRule::scatter) height_[nextHeights(tick, 2)].bind(rules::kBindSpareHeight);
  run(*chosen_.slope_sweep[beneath]);
  current_ = nextHeights(tick, 1);
}

/// What bodies do to the soil that they press on, in the push planes.
void GlStages::push(const TickTables& tick, const SubStepTables& step) {
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);  // shaders wrote there, in an earlier sub-step
  const std::int64_t bytes = std::int64_t(tick.tile_index.size() * sizeof(PlaneCells));
  for (const GrowingBuffer* plane : {&push_x_, &push_y_})
    glClearNamedBufferSubData(plane->name(), GL_R32I, 0, bytes, GL_RED_INTEGER, GL_INT, nullptr);
  bindCells(tick);
  bindTable(rules::kBindDomains, step.domains);
  bindTable(rules::kBindDomainTiles, step.domain_tiles);
  bindTable(rules::kBindBodies, step.bodies);
  bindTable(rules::kBindPushes, step.pushes);
  push_x_.bind(rules::kBindPushX);
  push_y_.bind(rules::kBindPushY);
  use(*chosen_.push_count);
  dispatch(step.push_blocks);
  use(*chosen_.push_force);
  setUniform(2, step.push_limit);
  dispatch(step.push_blocks);
  bindMaterials(tick);
  use(*chosen_.push_soil);
  dispatch(step.cover);
}

void GlStages::sweepDrift(const TickTables& tick, int sweep, bool pushes) {
  bindCells(tick);
  push_x_.bind(rules::kBindPushX);
  push_y_.bind(rules::kBindPushY);
  height_[nextHeights(tick, 1)].bind(rules::kBindNextHeight);
  use(*chosen_.drift[tick.beneath ? 1 : 0][pushes ? 1 : 0]);
  setUniform(2, int(tick.tile_index.size()));
  setUniform(3, tick.parameters.obstacle_threshold_q);
  setUniform(4, tick.drift.step);
  setUniform(5, tick.drift.quarter);
  setUniform(6, tick.drift.shift);
  setUniform(7, int(tick.drift.inverse_quarter));
  setUniform(8, int(rules::driftPhase(tick.tick, sweep)));
  dispatch(tick.slope);
  current_ = nextHeights(tick, 1);
}

}  // namespace spoor
