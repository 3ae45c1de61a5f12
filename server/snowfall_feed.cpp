#include "server/snowfall_feed.h"

#include <fmt/format.h>

namespace spoor {

SnowfallFeed::SnowfallFeed(const ScenePack& pack, const std::vector<TimedSnowfall>& timed, SnowfallQueue* console,
                           const Say& say)
    : pack_(pack), console_(console), say_(say) {
  for (const TimedSnowfall& snowfall : timed) timed_.emplace(snowfall.tick, snowfall.wish);
}

std::vector<Snowfall> SnowfallFeed::take(std::int32_t tick, std::size_t known_count) {
  std::vector<Snowfall> snowfalls;
  const auto [first, last] = timed_.equal_range(tick);
  for (auto wish = first; wish != last; ++wish) add(tick, known_count, wish->second, snowfalls);
  if (console_ != nullptr)
    for (const SnowfallWish& wish : console_->tryTake()) add(tick, known_count, wish, snowfalls);
  return snowfalls;
}

void SnowfallFeed::add(std::int32_t tick, std::size_t known_count, const SnowfallWish& wish,
                       std::vector<Snowfall>& snowfalls) {
  const auto snowfall = resolveSnowfall(pack_, wish, tick);
  std::string why_not = snowfall ? "" : snowfall.error();
  if (snowfall && known_count + snowfalls.size() >= kSnowfallsLimit)
    why_not = fmt::format("a session has {} of them at most", kSnowfallsLimit);
  if (why_not.empty()) return snowfalls.push_back(*snowfall);
  ++refused_count_;
  say_(fmt::format("tick {}: snowfall: {}; there is none", tick, why_not));
}

void SnowfallFeed::note(std::int32_t tick, const std::vector<Snowfall>& snowfalls) {
  count_ += std::int64_t(snowfalls.size());
  for (const Snowfall& snowfall : snowfalls)
    say_(fmt::format("tick {}: snowfall on {}", tick, describeSnowfall(pack_, snowfall)));
}

}  // namespace spoor
