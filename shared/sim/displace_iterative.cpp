// Stage displace, iterative: overlapped soil steps from cell to cell down the distance to the nearest free cell
// (Persson 2019, 4.1.4, method 1). Only cells that are not free, and their neighbours, take part: those are listed,
// with the neighbours each gives to and takes from.
#include <array>
#include <atomic>
#include <numeric>

#include "shaders/rules/flow.h"
#include "shaders/rules/nearest.h"
#include "shared/sim/native_stages.h"

namespace spoor {
namespace {

constexpr std::int32_t kInfinite = INT32_MAX;  // distance of a cell that knows no free one

class Flow {
 public:
  Flow(const NativeContext& context, DomainWork& domain)
      : context_(context), area_(context.area), domain_(domain), width_(domain.width()) {
    list();
    forEachPart([&](std::int32_t i) { connect(i); });
    const std::size_t count = domain_.flow_cells.size();
    domain_.carried.resize(count);
    domain_.flow_room.resize(count);
    domain_.flow_total.resize(count);
    for (auto& plane : domain_.offer) plane.resize(count);
    forEachPart([&](std::int32_t i) {
      const FlowCell& cell = domain_.flow_cells[i];
      domain_.carried[i] = std::max(cell.overlap, 0);
      domain_.offer[0][i] = rules::flowOffer(domain_.carried[i], cell.downward_count);
    });
  }

  void run(int iterations) {
    constexpr std::int64_t kMovingBytes = 64;  // what it and its neighbours offer and take, besides the list
    const std::int64_t bytes = std::int64_t(2 * sizeof(FlowCell) + kMovingBytes) * std::ssize(domain_.flow_cells);
    for (int done = 0; done < iterations; ++done) {
      domain_.bytes_moved += bytes;
      moved_ = false;
      forEachPart([&](std::int32_t i) { findRoom(i); });
      forEachPart([&](std::int32_t i) { move(i); });
      std::swap(domain_.offer[0], domain_.offer[1]);
      if (!moved_) return;
    }
  }

  /// What cells carry becomes ground. Returns what those carry that are not free.
  std::int64_t settle(std::int32_t step) {
    std::atomic<std::int64_t> kept_back = 0;
    forEachPart([&](std::int32_t i) {
      const FlowCell& cell = domain_.flow_cells[i];
      if (cell.overlap != rules::kFree && domain_.carried[i] > 0)
        kept_back.fetch_add(domain_.carried[i], std::memory_order_relaxed);
      const std::int32_t height = cell.ground + domain_.carried[i];
      if (height == area_.height[cell.offset]) return;
      area_.height[cell.offset] = height;
      std::atomic_ref(area_.last_change[area_.segmentAt(cell.x, cell.y)]).store(step, std::memory_order_relaxed);
    });
    return kept_back;
  }

 private:
  template <typename Body>
  void forEachPart(Body body) {
    constexpr int kCellsPerTask = 1024;
    const int count = int(domain_.flow_cells.size());
    context_.pool.forEach((count + kCellsPerTask - 1) / kCellsPerTask, [&](int task, int) {
      for (int i = task * kCellsPerTask; i < std::min((task + 1) * kCellsPerTask, count); ++i) body(i);
    });
  }

  bool inside(int x, int y) const { return x >= 0 && y >= 0 && x < width_ && y < domain_.rows(); }
  std::int32_t overlapAt(int x, int y) const { return domain_.overlap[std::size_t(y) * width_ + x]; }

  bool takesPart(int x, int y) const {
    bool result = overlapAt(x, y) != rules::kFree;
    for (int d = 0; d < 8 && !result; ++d) {
      const int to_x = x + rules::neighbourX(d), to_y = y + rules::neighbourY(d);
      result = inside(to_x, to_y) && overlapAt(to_x, to_y) != rules::kFree;
    }
    return result;
  }

  /// Fills flow_cells, but for their neighbours, and flow_index.
  void list() {
    const int rows = domain_.rows();
    std::vector<std::uint8_t> has_bodies(std::size_t(rows) + 2, 0);  // [row + 1]
    domain_.forEachRow(context_.pool, [&](int y) {
      const std::int32_t* overlap = domain_.overlap.data() + std::size_t(y) * width_;
      has_bodies[std::size_t(y) + 1] = context_.kernels.highest(overlap, width_) > rules::kFree ? 1 : 0;
    });
    domain_.flow_index.resize(domain_.overlap.size());
    std::vector<std::int32_t> first_in_row(std::size_t(rows) + 1, 0);
    const auto forEachOfRow = [&](int y, auto visit) {
      if ((has_bodies[y] | has_bodies[y + 1] | has_bodies[y + 2]) == 0) return;
      for (int x = 0; x < width_; ++x)
        if (takesPart(x, y)) visit(x);
    };
    domain_.forEachRow(context_.pool, [&](int y) { forEachOfRow(y, [&](int) { ++first_in_row[y + 1]; }); });
    std::partial_sum(first_in_row.begin(), first_in_row.end(), first_in_row.begin());
    domain_.flow_cells.resize(std::size_t(first_in_row.back()));
    domain_.forEachRow(context_.pool, [&](int y) {
      std::int32_t next = first_in_row[y];
      forEachOfRow(y, [&](int x) {
        FlowCell& cell = domain_.flow_cells[next];
        cell.x = domain_.box.x0 + x;
        cell.y = domain_.box.y0 + y;
        cell.offset = domain_.row_offset[y] + std::size_t(x);
        cell.overlap = overlapAt(x, y);
        cell.ground = area_.height[cell.offset] - std::max(cell.overlap, 0);
        cell.underside = area_.underside[cell.offset];
        domain_.flow_index[std::size_t(y) * width_ + x] = next++;
      });
    });
  }

  std::int32_t distanceAt(int x, int y) const {
    const std::size_t at = std::size_t(y) * width_ + x;
    if (domain_.overlap[at] == rules::kFree) return 0;
    const std::int32_t target = domain_.target[at];
    if (target == rules::kNoTarget) return kInfinite;
    return rules::metricDistance(x - target % width_, y - target / width_, int(context_.parameters.metric));
  }

  /// Finds the neighbours that a cell gives to and takes from: free cells only take, and so do those without a target.
  void connect(std::int32_t i) {
    FlowCell& cell = domain_.flow_cells[i];
    const int x = cell.x - domain_.box.x0, y = cell.y - domain_.box.y0;
    const std::int32_t distance = distanceAt(x, y);
    cell.downward_count = cell.upward_count = 0;
    for (int d = 0; d < 8; ++d) {
      const int to_x = x + rules::neighbourX(d), to_y = y + rules::neighbourY(d);
      if (!inside(to_x, to_y)) continue;
      const std::int32_t to_distance = distanceAt(to_x, to_y);
      const std::int32_t neighbour = domain_.flow_index[std::size_t(to_y) * width_ + to_x];
      if (distance != kInfinite && to_distance < distance) cell.downward[cell.downward_count++] = neighbour;
      if (to_distance != kInfinite && distance < to_distance) cell.upward[cell.upward_count++] = neighbour;
    }
  }

  /// Sums what a cell is offered, and finds what it can take.
  void findRoom(std::int32_t i) {
    const FlowCell& cell = domain_.flow_cells[i];
    std::int32_t total = 0;
    for (int k = 0; k < cell.upward_count; ++k) total += domain_.offer[0][cell.upward[k]];
    domain_.flow_total[i] = total;
    if (total == 0) return;
    domain_.flow_room[i] = rules::flowRoom(cell.overlap, cell.ground, domain_.carried[i], cell.underside,
                                           context_.parameters.obstacle_threshold_q);
  }

  std::int32_t granted(std::int32_t offer, std::int32_t taker) const {
    if (offer == 0) return 0;
    return rules::grantedShare(offer, domain_.flow_room[taker], rules::wideFrom(domain_.flow_total[taker]));
  }

  void move(std::int32_t i) {
    const FlowCell& cell = domain_.flow_cells[i];
    const std::vector<std::int32_t>& offer = domain_.offer[0];
    std::int32_t change = 0;
    if (offer[i] > 0)
      for (int k = 0; k < cell.downward_count; ++k) change -= granted(offer[i], cell.downward[k]);
    if (domain_.flow_total[i] > 0)
      for (int k = 0; k < cell.upward_count; ++k) change += granted(offer[cell.upward[k]], i);
    domain_.carried[i] += change;
    domain_.offer[1][i] = rules::flowOffer(domain_.carried[i], cell.downward_count);
    if (change != 0) moved_.store(true, std::memory_order_relaxed);
  }

  const NativeContext& context_;
  WorkArea& area_;
  DomainWork& domain_;
  const int width_;
  std::atomic<bool> moved_ = false;
};

}  // namespace

std::int64_t displaceInSteps(const NativeContext& context, DomainWork& domain, std::int32_t step) {
  Flow flow(context, domain);
  flow.run(context.parameters.displace_iterations);
  return flow.settle(step);
}

}  // namespace spoor
