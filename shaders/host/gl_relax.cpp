// Stage relax, by the rule that the tick's parameters choose.
#include "shaders/host/gl_stages.h"
#include "shaders/rules/exchange.h"

namespace spoor {

void GlStages::relax(const TickTables& tick, int i) {
  const SubStepTables& step = tick.sub_steps[std::size_t(i)];
  if (step.sweep_count == 0) return;
  const SlopeRule rule = tick.parameters.slopes;
  if (rule == SlopeRule::scatter) clearNextHeights(tick);
  for (int sweep = 0; sweep < step.sweep_count; ++sweep) {
    const int first_step = step.first_step + sweep * rules::kMatchingCount;
    if (rule != SlopeRule::exchange)
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
    setUniform(5, rules::exchangeThreshold(matching < rules::kMatchDiagonal
                                               ? tick.parameters.materials[0].slope_threshold_q
                                               : tick.parameters.materials[0].diagonal_threshold_q));
    setUniform(6, tick.parameters.obstacle_threshold_q);
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
    setUniform(3, tick.parameters.materials[0].slope_threshold_q);
    setUniform(4, tick.parameters.materials[0].diagonal_threshold_q);
    setUniform(5, tick.parameters.materials[0].roughness_q16);
    setUniform(6, tick.parameters.obstacle_threshold_q);
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

}  // namespace spoor
