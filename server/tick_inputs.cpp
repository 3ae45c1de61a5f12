#include "server/tick_inputs.h"

#include <fmt/format.h>

#include <array>
#include <utility>

namespace spoor {
namespace {

// Parts of what a tick is given.
constexpr int kAsked = 1, kScene = 2, kChange = 4;
// What is tried, one after another.
constexpr int kAttempts[] = {kAsked | kScene | kChange, kScene | kChange, kAsked | kScene, kScene, kChange, 0};

}  // namespace

TickInputs::TickInputs(const ScenePack& pack, const Script& script, const Parameters& start, const LoopOptions& options,
                       SessionHost* host, const Say& say)
    : pack_(pack),
      parameters_(start),
      console_(options.console),
      craters_(pack, script, options.craters, options.console_craters, host, say),
      snowfalls_(pack, options.snowfalls, options.console_snowfalls, say),
      say_(say) {
  for (const ParameterChange& change : options.changes) changes_[change.tick].push_back(change);
}

Status TickInputs::begin(Simulation& simulation, std::int32_t tick, const std::vector<Pose>& poses) {
  const Parameters before = parameters_;
  if (const auto found = changes_.find(tick); found != changes_.end())
    for (const ParameterChange& change : found->second) apply(change, tick);
  if (console_ != nullptr)
    for (const ParameterChange& change : console_->tryTake()) apply(change, tick);
  const CraterBatch batch = craters_.take(tick);
  const std::vector<Snowfall> snowfalls = snowfalls_.take(tick, simulation.state().snowfalls.size());
  const int absent = (batch.askedCount() == 0 ? kAsked : 0) | (batch.scene.empty() ? kScene : 0) |
                     (parameters_ == before ? kChange : 0);
  std::array<bool, 8> tried = {};
  std::string why_not;
  Status status;
  for (const int attempt : kAttempts) {
    const int parts = attempt | absent;
    if (std::exchange(tried[std::size_t(parts)], true)) continue;
    const bool with_scene = (parts & kScene) != 0, with_asked = (parts & kAsked) != 0;
    const bool with_change = (parts & kChange) != 0 && parameters_ != before;
    const std::vector<Crater> craters = batch.all(with_scene, with_asked);
    status = simulation.begin(poses, with_change ? std::optional(parameters_) : std::nullopt, craters, snowfalls);
    if (!status && why_not.empty()) why_not = status.error();
    if (!status) continue;
    if (with_change) say_(fmt::format("tick {}: {}", tick, describeChange(pack_, before, parameters_)));
    if ((parts & kChange) == 0) say_(fmt::format("tick {}: the parameters stay as they were: {}", tick, why_not));
    if (!with_change) parameters_ = before;
    const auto first_id = std::uint32_t(simulation.state().craters.size() - craters.size());
    snowfalls_.note(tick, snowfalls);
    craters_.note(tick, batch, with_scene, with_asked, first_id, why_not);
    return status;
  }
  return status;
}

void TickInputs::apply(const ParameterChange& change, std::int32_t tick) {
  std::vector<std::string> notes;
  const auto changed = changeParameters(pack_, parameters_, change.values, notes);
  if (!changed) return say_(fmt::format("tick {}: {}; nothing changes", tick, changed.error()));
  for (const std::string& text : notes) say_(fmt::format("tick {}: {}", tick, text));
  if (*changed == parameters_) say_(fmt::format("tick {}: the parameters are so already", tick));
  parameters_ = *changed;
}

}  // namespace spoor
