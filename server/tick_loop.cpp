#include "server/tick_loop.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <thread>

#include "shared/base/json.h"
#include "shared/world/script.h"

namespace spoor {
namespace {

using Clock = std::chrono::steady_clock;

double millisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// Sleeps until a tick's time. A session that fell behind starts counting anew instead of hurrying after.
class Pace {
 public:
  explicit Pace(double rate_hz) : period_(rate_hz > 0 ? 1 / rate_hz : 0), next_(Clock::now()) {}

  /// Returns whether the tick is late.
  bool await() {
    if (period_ == std::chrono::duration<double>::zero()) return false;
    const auto now = Clock::now();
    const bool late = now > next_ + std::chrono::duration_cast<Clock::duration>(period_);
    if (late) next_ = now;
    std::this_thread::sleep_until(next_);
    next_ += std::chrono::duration_cast<Clock::duration>(period_);
    return late;
  }

 private:
  std::chrono::duration<double> period_;
  Clock::time_point next_;
};

void note(LoopFigures& figures, const TickResult& result, std::int32_t tick, double tick_ms) {
  const auto keep = [at = std::size_t(tick)](std::vector<double>& values, double value) {
    if (values.size() < LoopFigures::kTicksKept) {
      values.push_back(value);
    } else {
      values[at % LoopFigures::kTicksKept] = value;
    }
  };
  keep(figures.tick_ms, tick_ms);
  for (int stage = 0; stage < kStageCount; ++stage) keep(figures.stage_ms[stage], result.effect.stage_ms[stage]);
  keep(figures.active_cells, double(result.effect.active_cells));
  figures.too_fast_ticks += result.too_fast ? 1 : 0;
  figures.unbalanced_ticks += result.ledger.error() != 0 ? 1 : 0;
  figures.kept_back += result.effect.kept_back;
}

/// What the session's parameters become, tick by tick.
class Steering {
 public:
  Steering(const ScenePack& pack, const Parameters& start, const LoopOptions& options,
           const std::function<void(const std::string&)>& say)
      : pack_(pack), parameters_(start), console_(options.console), say_(say) {
    for (const ParameterChange& change : options.changes) changes_[change.tick].push_back(change);
  }

  /// Begins a tick, with new parameters where they change. Those with which it cannot begin are taken back.
  Status begin(Simulation& simulation, std::int32_t tick, const std::vector<Pose>& poses) {
    const Parameters before = parameters_;
    if (const auto found = changes_.find(tick); found != changes_.end())
      for (const ParameterChange& change : found->second) apply(change, tick);
    if (console_ != nullptr)
      for (const ParameterChange& change : console_->tryTake()) apply(change, tick);
    if (parameters_ == before) return simulation.begin(poses);
    const Status status = simulation.begin(poses, parameters_);
    if (status) {
      say_(fmt::format("tick {}: {}", tick, describeChange(before, parameters_, pack_.cell_q)));
      return status;
    }
    parameters_ = before;
    const Status without = simulation.begin(poses);
    if (without) say_(fmt::format("tick {}: the parameters stay as they were: {}", tick, status.error()));
    return without;
  }

 private:
  void apply(const ParameterChange& change, std::int32_t tick) {
    std::vector<std::string> notes;
    const auto changed = changeParameters(pack_, parameters_, change.values, notes);
    if (!changed) return say_(fmt::format("tick {}: {}; nothing changes", tick, changed.error()));
    for (const std::string& text : notes) say_(fmt::format("tick {}: {}", tick, text));
    if (*changed == parameters_) say_(fmt::format("tick {}: the parameters are so already", tick));
    parameters_ = *changed;
  }

  const ScenePack& pack_;
  Parameters parameters_;
  ChangeQueue* console_;
  std::map<std::int32_t, std::vector<ParameterChange>> changes_;
  const std::function<void(const std::string&)>& say_;
};

/// Says what a user would want to know when it happens for the first time; `figures` are those before this tick.
void sayFirsts(const LoopFigures& figures, const TickResult& result, std::int32_t tick,
               const std::function<void(const std::string&)>& say) {
  if (result.too_fast && figures.too_fast_ticks == 0)
    say(fmt::format("tick {}: a body moves farther than one cell in each of {} sub-steps; its trail may have gaps",
                    tick, kSubStepLimit));
  if (result.effect.kept_back > 0 && figures.kept_back == 0)
    say(
        fmt::format("tick {}: {} units of soil (0.1 mm of a cell) found no room, or did not get out yet, and stay "
                    "where bodies are",
                    tick, result.effect.kept_back));
}

}  // namespace

LoopFigures runTicks(Simulation& simulation, const BaseTerrain& base, const LoopOptions& options, SessionHost* host,
                     SessionWriter* writer, const std::function<void(const std::string&)>& say) {
  const Script script(base);
  Steering steering(base.pack(), simulation.state().parameters, options, say);
  LoopFigures figures;
  Pace pace(options.rate_hz);
  const auto start = Clock::now();
  auto said = start;
  // A paced tick is published as soon as it can be. Without a pace the next one is begun first, so that a device works
  // on it while this one is encoded.
  const std::int32_t ahead = options.rate_hz > 0 ? 0 : 1;
  std::int32_t begun = 0, last = options.ticks;
  std::string failure;
  for (std::int32_t tick = 1; tick <= last; ++tick) {
    figures.late_ticks += pace.await() ? 1 : 0;
    const auto tick_start = Clock::now();
    StageTimes outer{};
    while (begun < std::min(tick + ahead, last)) {
      std::vector<Pose> poses;
      {
        StageTimer timer(outer, Stage::commands);
        poses = script.poses(begun + 1);
      }
      if (Status status = steering.begin(simulation, begun + 1, poses); status) {
        ++begun;
      } else {  // the pack's own script left the range, or a device failed: the session ends, what is done stays done
        failure = fmt::format("tick {}: {}", begun + 1, status.error());
        last = begun;
      }
    }
    if (tick > last) break;
    auto result = simulation.finish();
    if (!result) {
      failure = fmt::format("tick {}: {}", tick, result.error());
      break;
    }
    const double tick_ms = millisecondsSince(tick_start);
    result->effect.stage_ms[int(Stage::commands)] = outer[int(Stage::commands)];
    const std::uint64_t hash = result->update.state_hash;
    const auto publish_start = Clock::now();
    if (writer != nullptr)
      writer->append(
          {tick, result->update.poses, hash, result->ledger, result->update.parameters, result->update.craters});
    if (host != nullptr) host->publish(std::move(result->update));
    result->effect.stage_ms[int(Stage::publish)] = millisecondsSince(publish_start);
    sayFirsts(figures, *result, tick, say);
    note(figures, *result, tick, tick_ms);
    if (Clock::now() - said > std::chrono::seconds(1) || tick == last) {
      said = Clock::now();
      say(fmt::format("tick {:5} of {}: {:6.2f} ms, {:7} active cells, {} live tiles, hash {}", tick, options.ticks,
                      tick_ms, result->effect.active_cells, simulation.state().tiles.size(), hexText(hash)));
    }
  }
  if (!failure.empty()) say(failure);
  figures.wall_s = millisecondsSince(start) / 1e3;
  return figures;
}

}  // namespace spoor
