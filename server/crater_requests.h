#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <set>
#include <span>

#include "protocol/messages.h"

namespace spoor {

/// The craters that one client asks for: which of them it may have. Knows neither clocks nor connections.
class CraterRequests {
 public:
  static constexpr std::size_t kPendingLimit = 64;
  /// Requests of a minute beyond those that the scene allows, after which a client only disturbs.
  static constexpr std::size_t kExcessLimit = 600;

  /// Counts a request. False: too many came within a minute, whatever they asked for.
  [[nodiscard]] bool count(const CraterLimits& limits, std::int64_t now_ms);

  /// The crater that a request asks for; it is pending from then on. Safe on untrusted values. Errors: what the scene
  /// or its limits for clients do not admit, with the value and what is allowed.
  /// @param bodies  where they are now
  Result<Crater> admit(const ScenePack& pack, std::span<const Pose> bodies, const CraterRequest& request,
                       std::int64_t now_ms);

  /// A pending request has been answered.
  void close(std::uint32_t sequence) { pending_.erase(sequence); }
  const std::set<std::uint32_t>& pending() const { return pending_; }

 private:
  std::deque<std::int64_t> asked_ms_, admitted_ms_;  // the last minute's
  std::optional<std::uint32_t> last_sequence_;
  std::set<std::uint32_t> pending_;
};

}  // namespace spoor
