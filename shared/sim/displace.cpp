// Stage displace, direct and spread: overlapped soil goes to the nearest free cell, or over several cells beyond it
// (Persson 2019, 4.1.4, methods 2 and 3), as far as it fits; what does not fit looks for another cell in the next
// round.
#include "shaders/rules/displace.h"

#include <algorithm>
#include <atomic>

#include "shaders/rules/exchange.h"
#include "shared/sim/native_stages.h"

namespace spoor {
namespace {

/// Adds amounts to their targets, one atomic add for each stretch of amounts that share a target.
class TargetSums {
 public:
  explicit TargetSums(std::vector<std::int64_t>& sums) : sums_(sums) {}
  ~TargetSums() { flush(); }
  TargetSums(const TargetSums&) = delete;

  void add(std::int32_t target, std::int64_t amount) {
    if (target != target_) {
      flush();
      target_ = target;
      amount_ = 0;
    }
    amount_ += amount;
  }

 private:
  void flush() {
    if (amount_ == 0) return;
    std::atomic_ref(sums_[std::size_t(target_)]).fetch_add(amount_, std::memory_order_relaxed);
  }

  std::vector<std::int64_t>& sums_;
  std::int32_t target_ = rules::kNoTarget;
  std::int64_t amount_ = 0;
};

/// Each source asks its nearest free cell for all.
struct DirectRequests {
  const DomainWork& domain;

  void prepareRow(const NativeContext&, int) const {}

  /// Calls visit(target, amount) for each request of cell i = (x, row).
  template <typename Visit>
  void of(std::size_t i, int, int, Visit visit) const {
    visit(domain.target[i], domain.overlap[i]);
  }
};

/// Each source asks the free cells on the line through its nearest one, beyond it.
struct SpreadRequests {
  DomainWork& domain;

  /// How far the lines reach; before anything moves, since the sources' overlap changes then.
  void prepareRow(const NativeContext& context, int row) const {
    const Parameters& parameters = context.parameters;
    const int width = domain.width();
    for (int x = 0; x < width; ++x) {
      const std::size_t i = std::size_t(row) * width + x;
      if (domain.overlap[i] <= 0 || domain.target[i] == rules::kNoTarget) continue;
      const Line line(domain, i, x, row);
      const int wanted =
          rules::spreadTargets(domain.overlap[i], parameters.penetration_divider_q, parameters.spread_cells);
      int count = 0;
      while (count < wanted && line.isFree(domain, count + 1)) {
        ++count;
        std::atomic_ref(domain.receives[std::size_t(line.yAt(count))]).store(1, std::memory_order_relaxed);
      }
      domain.parts[i] = std::uint8_t(count);
    }
  }

  template <typename Visit>
  void of(std::size_t i, int x, int row, Visit visit) const {
    const int count = domain.parts[i];
    if (count == 0) return visit(domain.target[i], domain.overlap[i]);
    const Line line(domain, i, x, row);
    const std::int32_t overlap = domain.overlap[i];
    for (int part = 0; part < count; ++part)
      visit(line.yAt(part + 1) * domain.width() + line.xAt(part + 1), rules::spreadPart(overlap, count, part));
  }

 private:
  struct Line {
    int target_x, target_y, dx, dy, longest;

    Line(const DomainWork& domain, std::size_t i, int x, int row)
        : target_x(domain.target[i] % domain.width()),
          target_y(domain.target[i] / domain.width()),
          dx(target_x - x),
          dy(target_y - row),
          longest(std::max(std::abs(dx), std::abs(dy))) {}

    int xAt(int k) const { return target_x + rules::spreadOffset(dx, longest, k); }
    int yAt(int k) const { return target_y + rules::spreadOffset(dy, longest, k); }
    bool isFree(const DomainWork& domain, int k) const {
      const int x = xAt(k), y = yAt(k);
      return x >= 0 && y >= 0 && x < domain.width() && y < domain.rows() &&
             domain.overlap[std::size_t(y) * domain.width() + x] == rules::kFree;
    }
  };
};

/// Calls visit(i, x) for the sources of a row that have a target.
template <typename Visit>
void forEachSource(const DomainWork& domain, int row, Visit visit) {
  const std::size_t first = std::size_t(row) * domain.width();
  for (int x = 0; x < domain.width(); ++x)
    if (domain.overlap[first + x] > 0 && domain.target[first + x] != rules::kNoTarget) visit(first + x, x);
}

template <typename Requests>
void sumRequests(const NativeContext& context, DomainWork& domain, const Requests& requests, int row) {
  requests.prepareRow(context, row);
  TargetSums sums(domain.requested);
  std::int64_t count = 0;
  forEachSource(domain, row, [&](std::size_t i, int x) {
    requests.of(i, x, row, [&](std::int32_t target, std::int32_t amount) {
      sums.add(target, amount);
      ++count;
    });
  });
  constexpr std::int64_t kRequestBytes = 48;  // target, sums and height, in and out
  std::atomic_ref(domain.bytes_moved).fetch_add(kRequestBytes * count, std::memory_order_relaxed);
}

/// What each cell with requests can take: the gap beneath a body, and never above the height limit.
void findRoom(const NativeContext& context, DomainWork& domain, int row) {
  const std::size_t first = std::size_t(row) * domain.width();
  for (int x = 0; x < domain.width(); ++x) {
    if (domain.requested[first + x] == 0) continue;
    const std::size_t at = domain.row_offset[row] + x;
    const std::int32_t room = rules::roomBeneath(context.area.height[at], context.area.underside[at],
                                                 context.parameters.obstacle_threshold_q);
    domain.room[first + x] = domain.requested[first + x] <= room ? DomainWork::kRoomForAll : room;
  }
}

/// Sources give what their targets grant. Where a target has room for all, its requests are its grants already.
template <typename Requests>
void takeFromSources(const NativeContext& context, DomainWork& domain, const Requests& requests, int row) {
  const std::size_t first = std::size_t(row) * domain.width();
  std::int32_t* height = context.area.height.data() + domain.row_offset[row];
  TargetSums sums(domain.granted);
  int done = 0;
  forEachSource(domain, row, [&](std::size_t i, int x) {
    std::int32_t given = 0;
    requests.of(i, x, row, [&](std::int32_t target, std::int32_t amount) {
      const std::int32_t room = domain.room[std::size_t(target)];
      if (room != DomainWork::kRoomForAll) {
        amount = rules::grantedShare(amount, room, domain.requested[std::size_t(target)]);
        sums.add(target, amount);
      }
      given += amount;
    });
    height[i - first] -= given;
    domain.overlap[i] -= given;
    done += domain.overlap[i] == 0 ? 1 : 0;
  });
  domain.penetrating_in_row[row] -= done;
}

/// Targets take what they granted, and close where they could not grant all.
void giveToTargets(const NativeContext& context, DomainWork& domain, int row, std::int32_t step) {
  const std::size_t first = std::size_t(row) * domain.width();
  for (int x = 0; x < domain.width(); ++x) {
    std::int64_t& requested = domain.requested[first + x];
    if (requested == 0) continue;
    std::int64_t& granted = domain.granted[first + x];
    const bool closes = domain.room[first + x] != DomainWork::kRoomForAll;
    context.area.height[domain.row_offset[row] + x] += std::int32_t(closes ? granted : requested);
    context.area.last_change[context.area.segmentAt(domain.box.x0 + x, domain.box.y0 + row)] = step;
    requested = 0;
    granted = 0;
    if (!closes) continue;
    domain.overlap[first + x] = rules::kObstacle;
    std::atomic_ref(domain.stale_columns[std::size_t(x / domain.columnsPerTask())]).store(1, std::memory_order_relaxed);
  }
}

/// A round, with targets known.
template <typename Requests>
void runRound(const NativeContext& context, DomainWork& domain, const Requests& requests, std::int32_t step) {
  domain.forEachRow(context.pool, [&](int row) {
    if (domain.penetrating_in_row[row] > 0) sumRequests(context, domain, requests, row);
  });
  domain.forEachRow(context.pool, [&](int row) {
    if (domain.receives[row] != 0) findRoom(context, domain, row);
  });
  domain.forEachRow(context.pool, [&](int row) {
    if (domain.penetrating_in_row[row] > 0) takeFromSources(context, domain, requests, row);
  });
  domain.forEachRow(context.pool, [&](int row) {
    if (domain.receives[row] != 0) giveToTargets(context, domain, row, step);
  });
}

template <typename Requests>
void runRounds(const NativeContext& context, DomainWork& domain, const Requests& requests, std::int32_t step) {
  for (int round = 0; round < context.parameters.capacity_rounds; ++round) {
    if (round > 0) runNearest(context, domain);
    runRound(context, domain, requests, step);
    // Without a newly closed target the next round would find the same.
    if (domain.penetratingLeft() == 0 ||
        std::ranges::count(domain.stale_columns, 0) == std::ssize(domain.stale_columns))
      return;
  }
}

std::int64_t overlapLeft(const DomainWork& domain) {
  std::int64_t left = 0;
  for (int row = 0; row < domain.rows(); ++row) {
    if (domain.penetrating_in_row[row] == 0) continue;
    const std::int32_t* overlap = domain.overlap.data() + std::size_t(row) * domain.width();
    for (int x = 0; x < domain.width(); ++x) left += std::max(overlap[x], 0);
  }
  return left;
}

}  // namespace

std::int64_t runDisplace(const NativeContext& context, DomainWork& domain, std::int32_t step) {
  if (context.parameters.displacement == Displacement::iterative) return displaceInSteps(context, domain, step);
  domain.requested.resize(std::max(domain.requested.size(), domain.overlap.size()));
  domain.granted.resize(domain.requested.size());
  domain.room.resize(domain.requested.size());
  if (context.parameters.displacement == Displacement::spread) {
    domain.parts.resize(domain.overlap.size());
    runRounds(context, domain, SpreadRequests{domain}, step);
  } else {
    runRounds(context, domain, DirectRequests{domain}, step);
  }
  return overlapLeft(domain);
}

}  // namespace spoor
