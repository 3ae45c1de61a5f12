#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "server/session_host.h"
#include "server/waiting_queue.h"
#include "shared/world/crater_text.h"
#include "shared/world/script.h"

namespace spoor {

/// Craters on their way from a console to the tick loop.
using CraterQueue = WaitingQueue<CraterWish>;

/// The craters that want to come with one tick, all valid, in the order in which they would.
struct CraterBatch {
  std::vector<Crater> scene;        // timed by the pack
  std::vector<Crater> typed;        // by command line and console
  std::vector<CraterOrder> orders;  // of clients, by (client, sequence)

  std::size_t askedCount() const { return typed.size() + orders.size(); }
  std::vector<Crater> all(bool with_scene, bool with_asked) const;
};

/// Where a session's craters come from, and what becomes of them.
class CraterFeed {
 public:
  using Say = std::function<void(const std::string&)>;

  /// @param timed    of the command line
  /// @param console  may be nullptr, and so may `host`
  /// All of these outlive the feed.
  CraterFeed(const ScenePack& pack, const Script& script, const std::vector<TimedCrater>& timed, CraterQueue* console,
             SessionHost* host, const Say& say);

  /// What wants to come with a tick. Each tick is asked for once, in order. Never waits.
  CraterBatch take(std::int32_t tick);

  /// A tick has begun with these craters of a batch.
  /// @param first_id  of the first of them
  /// @param why_not   of the parts that are left out
  void note(std::int32_t tick, const CraterBatch& batch, bool with_scene, bool with_asked, std::uint32_t first_id,
            const std::string& why_not);

  /// A tick has been published: clients hear of theirs.
  void published(std::int32_t tick);

  std::int64_t count() const { return count_; }
  std::int64_t refusedCount() const { return refused_count_; }

 private:
  void addTyped(CraterBatch& batch, std::int32_t tick, const CraterWish& wish);

  const ScenePack& pack_;
  const Script& script_;
  std::multimap<std::int32_t, CraterWish> timed_;
  CraterQueue* console_;
  SessionHost* host_;
  const Say& say_;
  std::map<std::int32_t, std::vector<CraterAnswer>> answers_;  // by tick, until that is published
  std::int64_t count_ = 0, refused_count_ = 0;
};

}  // namespace spoor
