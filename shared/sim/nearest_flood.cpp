// Stage nearest by jump flooding: every cell that is not free asks the cells eight ways, near ones last, what free cell
// they know. Free cells know themselves from the start and never ask.
#include <atomic>
#include <bit>
#include <numeric>
#include <span>

#include "shaders/rules/flood.h"
#include "shared/sim/native_stages.h"

namespace spoor {
namespace {

// A position is y << 16 | x, relative to the domain: it fits, and no division takes it apart.
static_assert(kDomainSideLimit <= 1 << 15);
int xOf(std::int32_t position) { return position & 0xffff; }
int yOf(std::int32_t position) { return position >> 16; }

/// The steps of the passes over a domain whose longer side is `size`.
std::vector<int> stepsOf(NearestSearch search, int size) {
  std::vector<int> halving, steps;
  for (int step = int(std::bit_ceil(unsigned(size))) / 2; step > 0; step /= 2) halving.push_back(step);
  if (search == NearestSearch::one_plus_jump_flooding) steps.push_back(1);
  steps.insert(steps.end(), halving.begin(), halving.end());
  if (search == NearestSearch::jump_flooding_plus_1) steps.push_back(1);
  if (search == NearestSearch::jump_flooding_plus_2) steps.insert(steps.end(), {2, 1});
  if (search == NearestSearch::jump_flooding_squared) steps.insert(steps.end(), halving.begin(), halving.end());
  return steps;
}

/// What cells know at first, in both planes, and the list of those that are not free.
void begin(const NativeContext& context, DomainWork& domain) {
  const int width = domain.width();
  for (auto& plane : domain.known) plane.resize(domain.overlap.size());
  std::vector<int> first_in_row(std::size_t(domain.rows()) + 1, 0);
  domain.forEachRow(context.pool, [&](int y) {
    int count = 0;
    for (int x = 0; x < width; ++x) {
      const std::size_t i = std::size_t(y) * width + x;
      const bool is_free = domain.overlap[i] == rules::kFree;
      domain.known[0][i] = domain.known[1][i] = is_free ? y << 16 | x : rules::kNoTarget;
      count += is_free ? 0 : 1;
    }
    first_in_row[std::size_t(y) + 1] = count;
  });
  std::partial_sum(first_in_row.begin(), first_in_row.end(), first_in_row.begin());
  domain.seekers.resize(std::size_t(first_in_row.back()));
  domain.seeker_order.resize(domain.seekers.size());
  domain.forEachRow(context.pool, [&](int y) {
    std::size_t next = std::size_t(first_in_row[y]);
    if (next == std::size_t(first_in_row[y + 1])) return;
    for (int x = 0; x < width; ++x) {
      if (domain.overlap[std::size_t(y) * width + x] == rules::kFree) continue;
      domain.seekers[next] = y << 16 | x;
      domain.seeker_order[next++] = std::uint8_t(rules::floodOrder(domain.box.x0 + x, domain.box.y0 + y));
    }
  });
}

/// Calls body(first, end) for parts of the list of seekers, in parallel.
template <typename Body>
void forEachPart(const NativeContext& context, const DomainWork& domain, Body body) {
  constexpr int kSeekersPerTask = 1024;
  const int count = int(domain.seekers.size());
  context.pool.forEach((count + kSeekersPerTask - 1) / kSeekersPerTask, [&](int task, int) {
    body(task * kSeekersPerTask, std::min((task + 1) * kSeekersPerTask, count));
  });
}

template <int kMetric>
void pass(const DomainWork& domain, const std::vector<std::int32_t>& before, std::vector<std::int32_t>& after, int step,
          int first, int end) {
  const int width = domain.width(), rows = domain.rows();
  for (int i = first; i < end; ++i) {
    const int x = xOf(domain.seekers[i]), y = yOf(domain.seekers[i]);
    const std::size_t at = std::size_t(y) * width + x;
    std::int32_t best = before[at];
    for (int k = 0; k < 8; ++k) {
      const int direction = rules::floodNeighbour(domain.seeker_order[i], k);
      const int neighbour_x = x + rules::neighbourX(direction) * step;
      const int neighbour_y = y + rules::neighbourY(direction) * step;
      if (unsigned(neighbour_x) >= unsigned(width) || unsigned(neighbour_y) >= unsigned(rows)) continue;
      const std::int32_t heard = before[std::size_t(neighbour_y) * width + neighbour_x];
      if (heard == rules::kNoTarget) continue;
      if (rules::floodTakes(best != rules::kNoTarget, xOf(best) - x, yOf(best) - y, xOf(heard) - x, yOf(heard) - y,
                            kMetric))
        best = heard;
    }
    after[at] = best;
  }
}

constexpr auto kPassOfMetric = std::array{pass<rules::kEuclidean>, pass<rules::kManhattan>, pass<rules::kChebyshev>};

}  // namespace

void runFlood(const NativeContext& context, DomainWork& domain) {
  begin(context, domain);
  constexpr std::int64_t kCellBytes = 12;    // overlap in, two planes out
  constexpr std::int64_t kSeekerBytes = 45;  // and pass: position, order, what nine cells know in; what one knows out
  const auto one_pass = kPassOfMetric[std::size_t(context.parameters.metric)];
  const std::vector<int> steps = stepsOf(context.parameters.nearest, std::max(domain.width(), domain.rows()));
  domain.bytes_moved +=
      kCellBytes * std::ssize(domain.overlap) + kSeekerBytes * std::ssize(domain.seekers) * std::ssize(steps);
  for (const int step : steps) {
    forEachPart(context, domain,
                [&](int first, int end) { one_pass(domain, domain.known[0], domain.known[1], step, first, end); });
    std::swap(domain.known[0], domain.known[1]);
  }
  const std::int32_t least = leastSearching(context.parameters);
  forEachPart(context, domain, [&](int first, int end) {
    for (int i = first; i < end; ++i) {
      const std::size_t at = std::size_t(yOf(domain.seekers[i])) * domain.width() + xOf(domain.seekers[i]);
      if (domain.overlap[at] < least) continue;
      const std::int32_t known = domain.known[0][at];
      domain.target[at] = known == rules::kNoTarget ? rules::kNoTarget : yOf(known) * domain.width() + xOf(known);
      if (known != rules::kNoTarget)
        std::atomic_ref(domain.receives[std::size_t(yOf(known))]).store(1, std::memory_order_relaxed);
    }
  });
}

}  // namespace spoor
