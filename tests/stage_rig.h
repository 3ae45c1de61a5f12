#pragma once

#include <algorithm>
#include <vector>

#include "shared/sim/native_stages.h"
#include "tests/scenes.h"

namespace spoor::test {

/// Native stages on a whole small world at once: every tile active, one domain over all cells, no body yet.
struct StageRig {
  explicit StageRig(const World& made_world, int thread_count = 1) : world(made_world), pool(thread_count) {
    const TileCoordinate extent = tileExtent(world.pack);
    for (int y = 0; y < extent.y; ++y)
      for (int x = 0; x < extent.x; ++x) plan.active.push_back({x, y});
    plan.tick = 1;
    area.gather(plan, world.base, state, pool);
    area.clearUnderside(world.pack, pool);
    runDepth(context, {});
    domain.reset({0, 0, world.pack.width_cells, world.pack.height_cells}, area);
  }
  StageRig(const StageRig&) = delete;

  /// Draws bodies into the undersides, over all cells.
  void press(const std::vector<PlacedBody>& bodies) {
    SubStep sub_step{bodies, {{domain.box, {}}}, 0};
    for (std::size_t i = 0; i < bodies.size(); ++i) sub_step.domains[0].bodies.push_back(int(i));
    runDepth(context, sub_step);
  }

  /// One plane of the area, the world's cells row by row.
  std::vector<std::int32_t> cells(const std::vector<std::int32_t>& plane) const {
    std::vector<std::int32_t> result;
    for (int y = 0; y < domain.rows(); ++y)
      for (int x = 0; x < domain.width(); ++x) result.push_back(plane[area.offsetAt(x, y)]);
    return result;
  }
  void set(std::vector<std::int32_t>& plane, const std::vector<std::int32_t>& values) {
    for (std::size_t i = 0; i < values.size(); ++i)
      plane[area.offsetAt(int(i) % domain.width(), int(i) / domain.width())] = values[i];
  }
  /// Sets the undersides of all cells, as bodies would.
  void setUnderside(const std::vector<std::int32_t>& values) {
    set(area.underside, values);
    std::ranges::fill(area.lowest_underside, -rules::kHeightLimit);  // anything may limit: the careful path everywhere
  }

  /// Penetration, nearest, displace.
  void displace() {
    runPenetration(context, domain);
    if (domain.penetrating_count == 0) return;
    runNearest(context, domain);
    runDisplace(context, domain, 0);
  }

  const World& world;
  WorldState state;
  ThreadPool pool;
  WorkArea area;
  NativeContext context{world.pack, kernels(), pool, area};
  TickPlan plan;
  DomainWork domain;
};

/// A dense world with the heights and undersides that a rig holds, all cells active.
inline DenseWorld denseCopy(const StageRig& rig) {
  DenseWorld dense(rig.world.base);
  for (int y = 0; y < dense.inside_rows; ++y)
    for (int x = 0; x < dense.inside_columns; ++x) {
      dense.height[dense.at(x, y)] = rig.area.height[rig.area.offsetAt(x, y)];
      dense.underside[dense.at(x, y)] = rig.area.underside[rig.area.offsetAt(x, y)];
    }
  std::ranges::fill(dense.active, std::uint8_t(1));
  return dense;
}

/// The world's cells of one of its planes.
inline std::vector<std::int32_t> insideCells(const DenseWorld& dense, const std::vector<std::int32_t>& plane) {
  std::vector<std::int32_t> result;
  for (int y = 0; y < dense.inside_rows; ++y)
    for (int x = 0; x < dense.inside_columns; ++x) result.push_back(plane[dense.at(x, y)]);
  return result;
}

}  // namespace spoor::test
