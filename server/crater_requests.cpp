#include "server/crater_requests.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>


namespace spoor {
namespace {

constexpr std::int64_t kMinute_ms = 60000;

void forgetOld(std::deque<std::int64_t>& times_ms, std::int64_t now_ms) {
  while (!times_ms.empty() && now_ms - times_ms.front() >= kMinute_ms) times_ms.pop_front();
}

std::string metres(std::int64_t value_q) { return metresText(value_q) + " m"; }

Status checkSize(const CraterLimits& limits, const Crater& crater) {
  if (limits.request_radius_q == 0) return Error{"crater: clients may not ask for craters in this scene"};
  if (crater.outerRadius() > limits.request_radius_q)
    return Error{fmt::format("crater: R3 = 2 R2 - R1 is {}, a client may ask for {}", metres(crater.outerRadius()),
                             metres(limits.request_radius_q))};
  for (const auto& [name, height_q] : {std::pair("D5", crater.depth_q), std::pair("H4", crater.rim_height_q)})
    if (height_q > limits.request_height_q)
      return Error{fmt::format("crater: {} is {}, a client may ask for {}", name, metres(height_q),
                               metres(limits.request_height_q))};
  return {};
}

Status checkDistance(const CraterLimits& limits, const Crater& crater, std::span<const Pose> bodies) {
  if (limits.request_distance_q == 0) return {};
  if (bodies.empty()) return Error{"crater: there is no body that it could be near to"};
  const auto limit = std::uint64_t(limits.request_distance_q);
  std::uint64_t nearest = UINT64_MAX;  // squared; of those within 2^31 along both axes
  for (const Pose& body : bodies) {
    const std::uint64_t dx = std::uint64_t(std::abs(std::int64_t(crater.x_q) - body.x_q));
    const std::uint64_t dy = std::uint64_t(std::abs(std::int64_t(crater.y_q) - body.y_q));
    if (dx <= limit && dy <= limit && dx * dx + dy * dy <= limit * limit) return {};
    if (dx <= INT32_MAX && dy <= INT32_MAX) nearest = std::min(nearest, dx * dx + dy * dy);
  }
  return Error{fmt::format("crater: its centre is {} from the nearest body, {} are allowed",
                           nearest == UINT64_MAX ? "very far" : metres(std::llround(std::sqrt(double(nearest)))),
                           metres(limits.request_distance_q))};
}

}  // namespace

bool CraterRequests::count(const CraterLimits& limits, std::int64_t now_ms) {
  forgetOld(asked_ms_, now_ms);
  asked_ms_.push_back(now_ms);
  return asked_ms_.size() <= std::size_t(limits.requests_per_minute) + kExcessLimit;
}

Result<Crater> CraterRequests::admit(const ScenePack& pack, std::span<const Pose> bodies, const CraterRequest& request,
                                     std::int64_t now_ms) {
  const CraterLimits& limits = pack.crater_limits;
  if (last_sequence_ && request.sequence <= *last_sequence_)
    return Error{fmt::format("crater: request {} came after request {}", request.sequence, *last_sequence_)};
  last_sequence_ = request.sequence;
  auto crater = resolveCrater(pack, request.wish);
  if (!crater) return Error{crater.error()};
  if (Status status = checkSize(limits, *crater); !status) return Error{status.error()};
  if (Status status = checkDistance(limits, *crater, bodies); !status) return Error{status.error()};
  forgetOld(admitted_ms_, now_ms);
  if (admitted_ms_.size() >= std::size_t(limits.requests_per_minute))
    return Error{fmt::format("crater: more than {} a minute", limits.requests_per_minute)};
  if (pending_.size() >= kPendingLimit)
    return Error{fmt::format("crater: {} of this client's wait for a tick already", kPendingLimit)};
  admitted_ms_.push_back(now_ms);
  pending_.insert(request.sequence);
  return crater;
}

}  // namespace spoor
