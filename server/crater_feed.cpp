#include "server/crater_feed.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>
#include <utility>

namespace spoor {

std::vector<Crater> CraterBatch::all(bool with_scene, bool with_asked) const {
  std::vector<Crater> craters;
  if (with_scene) craters = scene;
  if (!with_asked) return craters;
  craters.insert(craters.end(), typed.begin(), typed.end());
  for (const CraterOrder& order : orders) craters.push_back(order.crater);
  return craters;
}

CraterFeed::CraterFeed(const ScenePack& pack, const Script& script, const std::vector<TimedCrater>& timed,
                       CraterQueue* console, SessionHost* host, const Say& say)
    : pack_(pack), script_(script), console_(console), host_(host), say_(say) {
  for (const TimedCrater& crater : timed) timed_.emplace(crater.tick, crater.wish);
}

CraterBatch CraterFeed::take(std::int32_t tick) {
  CraterBatch batch;
  const auto scene = script_.craters(tick);
  batch.scene.assign(scene.begin(), scene.end());
  const auto [first, last] = timed_.equal_range(tick);
  for (auto wish = first; wish != last; ++wish) addTyped(batch, tick, wish->second);
  if (console_ != nullptr)
    for (const CraterWish& wish : console_->tryTake()) addTyped(batch, tick, wish);
  if (host_ != nullptr) batch.orders = host_->tryTakeCraters();
  std::ranges::sort(batch.orders, {},
                    [](const CraterOrder& order) { return std::tuple(order.client, order.sequence); });
  return batch;
}

void CraterFeed::addTyped(CraterBatch& batch, std::int32_t tick, const CraterWish& wish) {
  if (auto crater = resolveCrater(pack_, wish)) {
    batch.typed.push_back(*crater);
  } else {
    ++refused_count_;
    say_(fmt::format("tick {}: {}; there is none", tick, crater.error()));
  }
}

void CraterFeed::note(std::int32_t tick, const CraterBatch& batch, bool with_scene, bool with_asked,
                      std::uint32_t first_id, const std::string& why_not) {
  const std::size_t left_out = (with_scene ? 0 : batch.scene.size()) + (with_asked ? 0 : batch.askedCount());
  if (left_out > 0)
    say_(fmt::format("tick {}: {} craters, {} of them the scene's, are left out: {}", tick, left_out,
                     with_scene ? 0 : batch.scene.size(), why_not));
  refused_count_ += std::int64_t(left_out);
  if (with_scene) {
    count_ += std::int64_t(batch.scene.size());
    first_id += std::uint32_t(batch.scene.size());
  }
  std::vector<CraterAnswer> refused;
  for (const CraterOrder& order : batch.orders)
    if (!with_asked) refused.push_back({order.client, order.sequence, 0, 0, why_not});
  if (host_ != nullptr) host_->answer(std::move(refused));
  if (!with_asked) return;
  count_ += std::int64_t(batch.askedCount());
  for (const Crater& crater : batch.typed)
    say_(fmt::format("tick {}: crater {} at {}", tick, first_id++, describeCrater(crater)));
  for (const CraterOrder& order : batch.orders) {
    say_(fmt::format("tick {}: crater {} at {}, asked for by client {}", tick, first_id, describeCrater(order.crater),
                     order.client));
    answers_[tick].push_back({order.client, order.sequence, tick, first_id++});
  }
}

void CraterFeed::published(std::int32_t tick) {
  const auto found = answers_.find(tick);
  if (found == answers_.end()) return;
  if (host_ != nullptr) host_->answer(std::move(found->second));
  answers_.erase(found);
}

}  // namespace spoor
