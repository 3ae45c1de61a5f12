// Stages nearest and displace, by the methods that the tick's parameters choose.
#include <algorithm>
#include <cstddef>

#include "shaders/host/gl_stages.h"
#include "shaders/rules/nearest.h"

namespace spoor {
namespace {

/// Steps of the passes of a flooding (rules/flood.h) over a domain with sides of at most `longest` cells.
std::vector<int> floodSteps(NearestSearch search, int longest) {
  int size = 1;
  while (size < longest) size *= 2;
  std::vector<int> steps;
  if (search == NearestSearch::one_plus_jump_flooding) steps.push_back(1);
  for (int round = 0; round < (search == NearestSearch::jump_flooding_squared ? 2 : 1); ++round)
    for (int step = size / 2; step > 0; step /= 2) steps.push_back(step);
  if (search == NearestSearch::jump_flooding_plus_2) steps.push_back(2);
  if (search == NearestSearch::jump_flooding_plus_1 || search == NearestSearch::jump_flooding_plus_2)
    steps.push_back(1);
  return steps;
}

int leastToPlace(const Parameters& parameters) {
  return parameters.displacement == Displacement::iterative ? rules::kObstacle : 1;
}

}  // namespace

void GlStages::penetration(const TickTables& tick, int i) {
  const SubStepTables& step = tick.sub_steps[std::size_t(i)];
  if (step.domain_blocks.count == 0) return;
  bindCells(tick);
  bindTable(rules::kBindDomains, step.domains);
  bindTable(rules::kBindDomainTiles, step.domain_tiles);
  underside_before_.bind(rules::kBindUndersideBefore);
  overlap_.bind(rules::kBindOverlap);
  free_mask_.bind(rules::kBindFreeMask);
  row_chunks_.bind(rules::kBindRowChunks);
  bindTable(rules::kBindRowFlags, tick.row_flags);
  if (anyCompression(tick.parameters)) {
    compacted_.bind(rules::kBindCompacted);
    bindMaterials(tick, rules::kBindDomainMaterial);
  }
  use(*chosen_.penetration, step.first_list);
  setUniform(2, leastToPlace(tick.parameters));
  dispatch(step.domain_blocks);
}

void GlStages::nearest(const TickTables& tick, int i) {
  const SubStepTables& step = tick.sub_steps[std::size_t(i)];
  if (step.domain_blocks.count == 0 || tick.parameters.displacement == Displacement::none) return;
  if (tick.parameters.nearest == NearestSearch::exact)
    search(tick, i);
  else
    flood(tick, i, 0);
}

void GlStages::search(const TickTables& tick, int i) {
  const int list = tick.sub_steps[std::size_t(i)].first_list;
  const std::int64_t rows = listOffset(tick, list, offsetof(rules::RoundLists, rows));
  target_.bind(rules::kBindTarget);
  nearest_row_.bind(rules::kBindNearestRow);
  use(*chosen_.nearest_columns, list);
  dispatchListed(rows);
  use(*chosen_.nearest_search, list);
  setUniform(4, leastToPlace(tick.parameters));
  int found_stride = 0;
  for (const int stride : {64, 8, 1}) {
    setUniform(2, stride);
    setUniform(3, found_stride);
    dispatchListed(rows);
    found_stride = stride;
  }
}

/// Runs a program over whole domains, where a round has soil to displace.
void GlStages::dispatchWholes(const TickTables& tick, int i, int round) {
  const SubStepTables& step = tick.sub_steps[std::size_t(i)];
  setUniform(0, step.domain_blocks.count);
  bindTable(rules::kBindBlocks, step.domain_blocks.blocks);
  dispatchListed(listOffset(tick, step.first_list + round, offsetof(rules::RoundLists, wholes)));
}

void GlStages::flood(const TickTables& tick, int i, int round) {
  const SubStepTables& step = tick.sub_steps[std::size_t(i)];
  const std::vector<int> steps = floodSteps(tick.parameters.nearest, step.longest_side);
  constexpr std::int64_t kPassBytes = 8;  // per domain cell: what it knows, in and out
  if (round == 0) domain_bytes_ += std::int64_t(steps.size()) * step.domain_cells * kPassBytes;
  // So that the last pass writes targets.
  const GrowingBuffer* known = steps.size() % 2 == 0 ? &target_ : &flood_;
  const GrowingBuffer* next = known == &flood_ ? &target_ : &flood_;
  known->bind(rules::kBindNextKnown);
  use(*chosen_.flood_begin);
  dispatchWholes(tick, i, round);
  use(*chosen_.flood_pass);
  for (std::size_t pass = 0; pass < steps.size(); ++pass) {
    known->bind(rules::kBindKnown);
    next->bind(rules::kBindNextKnown);
    setUniform(2, steps[pass]);
    setUniform(3, pass + 1 == steps.size() ? 1 : 0);
    dispatchWholes(tick, i, round);
    std::swap(known, next);
  }
}

void GlStages::displace(const TickTables& tick, int i) {
  if (tick.sub_steps[std::size_t(i)].domain_blocks.count == 0) return;
  if (tick.parameters.displacement == Displacement::none) return;
  if (tick.parameters.displacement == Displacement::iterative) return flow(tick, i);
  for (int round = 0; round < tick.parameters.capacity_rounds; ++round) displaceRound(tick, i, round);
}

/// Rounds but the first are empty dispatches where no soil is left to them.
void GlStages::displaceRound(const TickTables& tick, int i, int round) {
  const SubStepTables& step = tick.sub_steps[std::size_t(i)];
  const int list = step.first_list + round;
  const bool flooded = tick.parameters.nearest != NearestSearch::exact;
  if (round > 0 && flooded) flood(tick, i, round);
  const std::int64_t rows = listOffset(tick, list, offsetof(rules::RoundLists, rows));
  target_.bind(rules::kBindTarget);
  nearest_row_.bind(rules::kBindNearestRow);
  requested_low_.bind(rules::kBindRequestedLow);
  requested_high_.bind(rules::kBindRequestedHigh);
  row_chunks_.bind(rules::kBindRowChunks);
  receivers_.bind(rules::kBindReceivers);
  use(round > 0 && !flooded ? *chosen_.displace_request_again : *chosen_.displace_request, list);
  setUniform(2, round);
  dispatchListed(rows);
  granted_.bind(rules::kBindGranted);
  use(*chosen_.displace_take, list);
  setUniform(2, round + 1 == tick.parameters.capacity_rounds ? 1 : 0);
  dispatchListed(rows);
  receivers_.bind(rules::kBindRowChunks);
  use(*chosen_.displace_give, list);
  setUniform(2, step.first_step);
  dispatchListed(listOffset(tick, list, offsetof(rules::RoundLists, receivers)));
}

void GlStages::flow(const TickTables& tick, int i) {
  const SubStepTables& step = tick.sub_steps[std::size_t(i)];
  target_.bind(rules::kBindTarget);
  nearest_row_.bind(rules::kBindNearer);  // which nobody reads any more
  offered_.bind(rules::kBindOffered);
  room_.bind(rules::kBindRoom);
  constexpr std::int64_t kStepBytes = 48;  // per domain cell: seven planes in one pass, five in the other
  domain_bytes_ += tick.parameters.displace_iterations * step.domain_cells * kStepBytes;
  int from = 0;
  carried_[from].bind(rules::kBindCarried);
  use(*chosen_.flow_begin);
  dispatchWholes(tick, i, 0);
  for (int iteration = 0; iteration < tick.parameters.displace_iterations; ++iteration) {
    carried_[from].bind(rules::kBindCarried);
    carried_[1 - from].bind(rules::kBindNextCarried);
    use(*chosen_.flow_offer);
    dispatchWholes(tick, i, 0);
    use(*chosen_.flow_move);
    dispatchWholes(tick, i, 0);
    from = 1 - from;
  }
  carried_[from].bind(rules::kBindCarried);
  use(*chosen_.flow_end);
  setUniform(2, step.first_step);
  dispatchWholes(tick, i, 0);
}

}  // namespace spoor
