// Stage displace: all overlapped soil goes to the nearest free cell (Persson 2019, 4.1.4, method 2), as far as it fits.
#include "shaders/rules/displace.h"

#include <algorithm>
#include <atomic>

#include "shaders/rules/exchange.h"
#include "shared/sim/native_stages.h"

namespace spoor {
namespace {

/// Adds a row's requests to their targets, one atomic add for each stretch of cells that share a target.
template <typename AmountOf>
void addToTargets(const DomainWork& domain, int row, std::vector<std::int64_t>& sums, AmountOf amount_of) {
  const int width = domain.width();
  std::int32_t target = rules::kNoTarget;
  std::int64_t amount = 0;
  const auto flush = [&] {
    if (amount == 0) return;
    std::atomic_ref(sums[std::size_t(target)]).fetch_add(amount, std::memory_order_relaxed);
  };
  for (std::size_t i = std::size_t(row) * width; i < std::size_t(row + 1) * width; ++i) {
    if (domain.overlap[i] <= 0 || domain.target[i] == rules::kNoTarget) continue;
    if (domain.target[i] != target) {
      flush();
      target = domain.target[i];
      amount = 0;
    }
    amount += amount_of(i);
  }
  flush();
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

/// Sources give what their target grants. Where a target has room for all, its requests are its grants already.
void takeFromSources(const NativeContext& context, DomainWork& domain, int row) {
  const std::size_t first = std::size_t(row) * domain.width();
  std::int32_t* height = context.area.height.data() + domain.row_offset[row];
  addToTargets(domain, row, domain.granted, [&](std::size_t i) -> std::int64_t {
    const std::int32_t room = domain.room[std::size_t(domain.target[i])];
    if (room == DomainWork::kRoomForAll) {
      height[i - first] -= domain.overlap[i];
      return 0;
    }
    const std::int32_t share =
        rules::grantedShare(domain.overlap[i], room, domain.requested[std::size_t(domain.target[i])]);
    height[i - first] -= share;
    return share;
  });
}

void giveToTargets(const NativeContext& context, DomainWork& domain, int row, std::int32_t step) {
  const std::size_t first = std::size_t(row) * domain.width();
  for (int x = 0; x < domain.width(); ++x) {
    std::int64_t& requested = domain.requested[first + x];
    if (requested == 0) continue;
    std::int64_t& granted = domain.granted[first + x];
    context.area.height[domain.row_offset[row] + x] +=
        std::int32_t(domain.room[first + x] == DomainWork::kRoomForAll ? requested : granted);
    context.area.last_change[context.area.segmentAt(domain.box.x0 + x, domain.box.y0 + row)] = step;
    requested = 0;
    granted = 0;
  }
}

}  // namespace

std::int64_t runDisplace(const NativeContext& context, DomainWork& domain, std::int32_t step) {
  const int task_rows = rowsPerTask(domain.width());
  domain.requested.resize(std::max(domain.requested.size(), domain.overlap.size()));
  domain.granted.resize(domain.requested.size());
  domain.room.resize(domain.requested.size());
  const auto forEachRow = [&](auto body) {
    context.pool.forEach((domain.rows() + task_rows - 1) / task_rows, [&](int task, int) {
      for (int row = task * task_rows; row < std::min((task + 1) * task_rows, domain.rows()); ++row) body(row);
    });
  };
  forEachRow([&](int row) {
    if (domain.penetrating_in_row[row] > 0)
      addToTargets(domain, row, domain.requested, [&](std::size_t i) { return std::int64_t(domain.overlap[i]); });
  });
  forEachRow([&](int row) {
    if (domain.receives[row] != 0) findRoom(context, domain, row);
  });
  forEachRow([&](int row) {
    if (domain.penetrating_in_row[row] > 0) takeFromSources(context, domain, row);
  });
  forEachRow([&](int row) {
    if (domain.receives[row] != 0) giveToTargets(context, domain, row, step);
  });
  return 0;
}

}  // namespace spoor
