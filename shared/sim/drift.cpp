// What rule `drift` needs before its sweeps: numbers, and how bodies push the soil that they touch.
#include "shared/sim/drift.h"

#include <algorithm>
#include <bit>

#include "shared/sim/native_stages.h"

namespace spoor {
namespace {

/// Cells of active tiles within a box, piece by piece: visit(x, y, count, offset in the area's planes).
template <typename Visit>
void forEachPiece(const WorkArea& area, const CellBox& box, Visit visit) {
  for (int y = box.y0; y < box.y1; ++y)
    for (int x = box.x0; x < box.x1;) {
      const Run& run = area.runAt(x, y);
      const int count = std::min(box.x1, run.x1()) - x;
      visit(x, y, count, run.rowOffset(y % rules::kTileSize) + std::size_t(x - run.x0()));
      x += count;
    }
}

/// Visits the offsets of cells in a box that a body presses on.
template <typename Visit>
void forEachContact(const NativeContext& context, const CellBox& box, Visit visit) {
  const WorkArea& area = context.area;
  forEachPiece(area, box, [&](int, int, int count, std::size_t offset) {
    for (std::size_t i = offset; i < offset + std::size_t(count); ++i)
      if (rules::isContact(area.height[i], area.underside[i], context.parameters.obstacle_threshold_q)) visit(i);
  });
}

}  // namespace

DriftSweep driftSweep(const ScenePack& pack, const Parameters& parameters) {
  DriftSweep sweep{};
  const int steps = driftSteps(parameters);
  const bool by_displacement = parameters.drift_weights == DriftWeights::displacement;
  rules::DriftStep& step = sweep.step;
  step.weights = int(parameters.drift_weights);
  step.step = std::max((parameters.drift_step_q16 + steps / 2) / steps, 1);
  const std::int32_t quarter_q = quarterArc(pack.cell_q);
  step.quarter = std::max(std::int32_t(std::int64_t(quarter_q) * step.step >> 8), 1);
  step.shift = std::countl_zero(std::uint32_t(step.quarter)) - 1;
  step.inverse_quarter = std::uint32_t((std::uint64_t(1) << 48) / (std::uint64_t(step.quarter) << step.shift));
  for (std::size_t i = 0; i < parameters.materials.size(); ++i) {
    const MaterialRules& own = parameters.materials[i];
    rules::DriftNumbers& numbers = sweep.materials[i];
    numbers.rate = std::min(std::int32_t((std::int64_t(own.diffusion_q16) * step.step + (1 << 15)) >> 16), 1 << 13);
    numbers.rest = rules::exchangeThreshold(step.weights == rules::kDriftBySlope ? own.slope_threshold_q : 1);
    if (!by_displacement) continue;
    numbers.rest = own.repose_q16;
    numbers.inverse = 0xffffffffu / std::uint32_t(std::max(0x10000 - numbers.rest, 1));
  }
  return sweep;
}

bool anyPush(const SubStep& sub_step, const Parameters& parameters) {
  return parameters.slopes == SlopeRule::drift && std::ranges::any_of(sub_step.bodies, [](const PlacedBody& body) {
           return body.force_cell > 0 && (body.direction_x_q30 != 0 || body.direction_y_q30 != 0);
         });
}

std::int32_t pushLimit(const SubStep& sub_step) {
  return (1 << 30) / std::max(std::int32_t(sub_step.bodies.size()), 1);
}

void runPush(const NativeContext& context, const SubStep& sub_step) {
  WorkArea& area = context.area;
  const bool pushes = anyPush(sub_step, context.parameters);
  area.push_x.assign(pushes ? area.height.size() : 0, 0);
  area.push_y.assign(pushes ? area.height.size() : 0, 0);
  for (const PlacedBody& body : sub_step.bodies) {
    if (!pushes || body.force_cell == 0) continue;
    int count = 0;
    forEachContact(context, body.box, [&](std::size_t) { ++count; });
    const std::int32_t strength = rules::pushStrength(body.force_cell, count, pushLimit(sub_step));
    const std::int32_t x = rules::pushAlong(strength, body.direction_x_q30);
    const std::int32_t y = rules::pushAlong(strength, body.direction_y_q30);
    forEachContact(context, body.box, [&](std::size_t i) {
      area.push_x[i] += x;
      area.push_y[i] += y;
    });
  }
  // From what bodies do to what it does to the soil there.
  if (pushes)
    for (std::size_t i = 0; i < area.push_x.size(); ++i) {
      if (area.push_x[i] == 0 && area.push_y[i] == 0) continue;
      const std::int32_t friction_inverse =
          context.parameters.materials[area.material.empty() ? 0 : std::size_t(area.material[i])].friction_inverse_q32;
      area.push_x[i] = rules::pushedSoil(area.push_x[i], friction_inverse);
      area.push_y[i] = rules::pushedSoil(area.push_y[i], friction_inverse);
    }
  if (context.parameters.displacement == Displacement::none) {
    area.clearUnderside(context.pack, context.pool);
    runDepth(context, {});  // of no body: the world's border stays closed
  }
}

}  // namespace spoor
