#include "server/import/crater_maker.h"

#include <algorithm>

#include "shared/base/hash.h"

namespace spoor {
namespace {

/// Numbers that follow from a seed and an index, one after another.
class Draw {
 public:
  Draw(std::uint64_t seed, std::int32_t index) : state_(mix64(seed ^ mix64(std::uint64_t(index) + 1))) {}

  std::uint64_t next() {
    state_ += 0x9e3779b97f4a7c15u;
    return mix64(state_);
  }
  std::int32_t within(std::int64_t least, std::int64_t most) {
    return std::int32_t(least + std::int64_t((next() >> 1) % std::uint64_t(most - least + 1)));
  }
  std::int32_t of(const DrawnFrom& from) { return within(from.least, from.most); }

 private:
  std::uint64_t state_;
};

/// Anywhere in a disc, every place as likely as any other.
std::array<std::int64_t, 2> offsetIn(Draw& draw, std::int64_t radius_q) {
  for (;;) {
    const std::int64_t x = draw.within(-radius_q, radius_q), y = draw.within(-radius_q, radius_q);
    if (x * x + y * y <= radius_q * radius_q) return {x, y};
  }
}

std::array<std::int64_t, 2> offsetOf(const CraterGroup& group, Draw& draw) {
  if (group.disc_q > 0) return offsetIn(draw, group.disc_q);
  if (group.width_q == 0 && group.height_q == 0) return {0, 0};
  const std::int64_t x = draw.within(0, group.width_q) - group.width_q / 2;
  return {x, draw.within(0, group.height_q) - group.height_q / 2};
}

bool fits(std::int64_t value) { return value > INT32_MIN / 2 && value < INT32_MAX; }

}  // namespace

std::vector<Crater> makeCraters(const CraterGroup& group) {
  std::vector<Crater> craters;
  craters.reserve(std::size_t(group.count));
  for (std::int32_t i = 0; i < group.count; ++i) {
    Draw draw(group.seed, i);
    const auto offset = offsetOf(group, draw);
    const std::int64_t x_q = group.x_q + i * group.step_x_q + offset[0];
    const std::int64_t y_q = group.y_q + i * group.step_y_q + offset[1];
    const std::int64_t tick = group.first_tick + ((i * group.apart_ticks_q16 + group.ahead_q16) >> 16);
    Crater crater;
    crater.crest_radius_q = draw.of(group.crest_radius_q);
    const std::int32_t inner_most = std::min(group.inner_radius_q.most, crater.crest_radius_q);
    crater.inner_radius_q = draw.within(std::min(group.inner_radius_q.least, inner_most), inner_most);
    crater.depth_q = draw.of(group.depth_q);
    crater.rim_height_q = group.balanced
                              ? balancedRimHeight(crater.inner_radius_q, crater.crest_radius_q, crater.depth_q)
                              : draw.of(group.rim_height_q);
    crater.noise_q16 = std::uint16_t(draw.of(group.noise_q16));
    crater.noise_seed = std::uint16_t(group.noise_seed >= 0 ? std::uint64_t(group.noise_seed) : draw.next() >> 48);
    if (!fits(x_q) || !fits(y_q) || !fits(tick)) continue;
    crater.x_q = std::int32_t(x_q);
    crater.y_q = std::int32_t(y_q);
    crater.tick = std::int32_t(tick);
    craters.push_back(crater);
  }
  return craters;
}

}  // namespace spoor
