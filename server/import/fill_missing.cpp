#include "server/import/fill_missing.h"

#include <cstddef>

#include "shared/base/assert.h"

namespace spoor {
namespace {

constexpr std::uint8_t kValid = 0;
constexpr std::uint8_t kMissing = 1;
constexpr std::uint8_t kQueued = 2;

/// Calls `visit` with the index of each side neighbour of a sample.
template <typename Visit>
void forNeighbours(std::size_t at, std::size_t columns, std::size_t count, Visit visit) {
  if (at % columns > 0) visit(at - 1);
  if (at % columns + 1 < columns) visit(at + 1);
  if (at >= columns) visit(at - columns);
  if (at + columns < count) visit(at + columns);
}

}  // namespace

void fillMissing(std::vector<std::int32_t>& height_q, std::vector<std::uint8_t>& missing, std::int32_t columns) {
  const std::size_t count = height_q.size();
  const std::size_t width = std::size_t(columns);
  SPOOR_ASSERT(missing.size() == count && columns > 0);
  std::vector<std::size_t> wave;
  const auto queueAround = [&](std::size_t at) {
    forNeighbours(at, width, count, [&](std::size_t next) {
      if (missing[next] != kMissing) return;
      missing[next] = kQueued;
      wave.push_back(next);
    });
  };
  for (std::size_t at = 0; at < count; ++at) {
    if (missing[at] == kValid) queueAround(at);
  }
  while (!wave.empty()) {
    for (const std::size_t at : wave) {
      std::int64_t sum = 0;
      std::int64_t neighbours = 0;
      forNeighbours(at, width, count, [&](std::size_t next) {
        if (missing[next] != kValid) return;
        sum += height_q[next];
        ++neighbours;
      });
      height_q[at] = std::int32_t(sum / neighbours - (sum % neighbours < 0 ? 1 : 0));
    }
    std::vector<std::size_t> filled;
    filled.swap(wave);
    for (const std::size_t at : filled) missing[at] = kValid;
    for (const std::size_t at : filled) queueAround(at);
  }
}

}  // namespace spoor
