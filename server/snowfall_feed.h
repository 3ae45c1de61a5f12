#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "server/snowfall_text.h"
#include "server/waiting_queue.h"

namespace spoor {

/// Snowfalls on their way from a console to the tick loop.
using SnowfallQueue = WaitingQueue<SnowfallWish>;

/// The snowfalls that come while a session runs, from command line and console.
class SnowfallFeed {
 public:
  using Say = std::function<void(const std::string&)>;

  /// @param console  may be nullptr
  /// All of these outlive the feed.
  SnowfallFeed(const ScenePack& pack, const std::vector<TimedSnowfall>& timed, SnowfallQueue* console, const Say& say);

  /// Those that come with a tick, and begin with it: all valid. What cannot be is said. Each tick is asked for once, in
  /// order. Never waits.
  /// @param known_count  snowfalls of the session so far
  std::vector<Snowfall> take(std::int32_t tick, std::size_t known_count);

  /// A tick has begun with these.
  void note(std::int32_t tick, const std::vector<Snowfall>& snowfalls);

  std::int64_t count() const { return count_; }
  std::int64_t refusedCount() const { return refused_count_; }

 private:
  void add(std::int32_t tick, std::size_t known_count, const SnowfallWish& wish, std::vector<Snowfall>& snowfalls);

  const ScenePack& pack_;
  std::multimap<std::int32_t, SnowfallWish> timed_;
  SnowfallQueue* console_;
  const Say& say_;
  std::int64_t count_ = 0, refused_count_ = 0;
};

}  // namespace spoor
