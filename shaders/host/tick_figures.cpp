#include "shaders/host/tick_figures.h"

namespace spoor {
namespace {

// Bytes that a stage reads and writes, for the figure TickEffect::bytes_moved.
constexpr std::int64_t kGatherBytes = 16;       // per active cell: height and bedrock, in and out
constexpr std::int64_t kCoverBytes = 4;         // per domain cell: underside (of whole tiles; counted once)
constexpr std::int64_t kPenetrationBytes = 20;  // per domain cell: depth lowers the underside; three planes in, one out
constexpr std::int64_t kNearestBytes = 20;   // per penetrating cell: nearest row out and in, overlap in, target out, in
constexpr std::int64_t kDisplaceBytes = 48;  // per penetrating cell: target, sums and height, in and out
constexpr std::int64_t kSlabPairs = rules::kSlabRows * rules::kTileSize / 2;
constexpr std::int64_t kCompactionBytes = 16;  // per active cell: compacted soil in and out, and compared with the pool
constexpr std::int64_t kHashBytes = 8;         // per active cell: compare with the pool
constexpr std::int64_t kCrateredBytes = 16;    // per cell that craters may change: height in and out, bedrock, change

/// Bytes of the relaxation for each pair of cells visited.
std::int64_t pairBytes(SlopeRule rule, RelaxSchedule schedule) {
  switch (rule) {
    case SlopeRule::exchange:  // two heights in and out, two bedrocks in; fused, a cell once for its four pairs
      return schedule == RelaxSchedule::fused ? 24 / 4 : 24;
    case SlopeRule::flux:
    case SlopeRule::drift:
      return 16 / 4;  // per cell: height, bedrock, underside in, new height out
    case SlopeRule::interleaved:
      return 32 / 4;  // per cell: the same twice but bedrock, amounts out and in
    case SlopeRule::scatter:
      return 24 / 4;  // per cell: as flux, with the new height in too and another 0 out
  }
  return 0;
}

}  // namespace

void fillFigures(const TickPlan& plan, const rules::TickHead& head, std::int64_t tile_count, std::int64_t crater_cells,
                 RelaxSchedule schedule, TickEffect& effect) {
  effect.active_cells = tile_count * rules::kTileCells;
  effect.penetrating_cells = head.penetrating_cells;
  if (head.penetrating_cells == 0) effect.bytes_moved = 0;
  effect.kept_back = std::int64_t(std::uint64_t(head.kept_back_high) << 32 | head.kept_back_low);
  effect.pairs_visited = head.slabs_visited * kSlabPairs;
  if (plan.parameters.slopes != SlopeRule::exchange) {
    const int edges = plan.parameters.slopes == SlopeRule::drift ? 2 : 4;
    effect.pairs_visited = 0;
    for (const SubStep& sub_step : plan.sub_steps)
      effect.pairs_visited += sub_step.sweep_count * edges * effect.active_cells;
  }
  effect.relax_bytes = effect.pairs_visited * pairBytes(plan.parameters.slopes, schedule);
  effect.bytes_moved += effect.relax_bytes + effect.active_cells * (kGatherBytes + kHashBytes) +
                        effect.domain_cells * (kCoverBytes + kPenetrationBytes) +
                        effect.penetrating_cells * (kNearestBytes + kDisplaceBytes);
  if (anyCompression(plan.parameters)) effect.bytes_moved += effect.active_cells * kCompactionBytes;
  effect.bytes_moved += crater_cells * kCrateredBytes;
}

}  // namespace spoor
