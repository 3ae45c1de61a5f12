#include "server/tick_loop.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "server/tick_inputs.h"
#include "shared/base/json.h"

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
  figures.waiting_ticks += result.waiting_tiles > 0 ? 1 : 0;
  figures.too_fast_ticks += result.too_fast ? 1 : 0;
  figures.unbalanced_ticks += result.ledger.error() != 0 ? 1 : 0;
  figures.kept_back += result.effect.kept_back;
}

/// Says what a user would want to know when it happens for the first time; `figures` are those before this tick.
void sayFirsts(const LoopFigures& figures, const TickResult& result, std::int32_t tick,
               const std::function<void(const std::string&)>& say) {
  if (result.too_fast && figures.too_fast_ticks == 0)
    say(fmt::format("tick {}: a body moves farther than one cell in each of {} sub-steps; its trail may have gaps",
                    tick, kSubStepLimit));
  if (result.waiting_tiles > 0 && figures.waiting_ticks == 0)
    say(fmt::format("tick {}: more than {} tiles are awake; {} of them wait for later ticks", tick, kTickTilesLimit,
                    result.waiting_tiles));
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
  TickInputs inputs(base.pack(), script, simulation.state().parameters, options, host, say);
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
      if (Status status = inputs.begin(simulation, begun + 1, poses); status) {
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
      writer->append({tick, result->update.poses, hash, result->ledger, result->update.parameters,
                      result->update.craters, result->update.snowfalls});
    if (host != nullptr) host->publish(std::move(result->update));
    inputs.published(tick);
    result->effect.stage_ms[int(Stage::publish)] = millisecondsSince(publish_start);
    sayFirsts(figures, *result, tick, say);
    note(figures, *result, tick, tick_ms);
    if (Clock::now() - said > std::chrono::seconds(1) || tick == last) {
      said = Clock::now();
      const std::size_t crater_count = simulation.state().craters.size();
      say(fmt::format("tick {:5} of {}: {:6.2f} ms, {:7} active cells, {} live tiles, {}hash {}", tick, options.ticks,
                      tick_ms, result->effect.active_cells, simulation.state().tiles.size(),
                      crater_count > 0 ? fmt::format("{} craters, ", crater_count) : "", hexText(hash)));
    }
  }
  if (!failure.empty()) say(failure);
  figures.snowfalls = inputs.snowfalls().count();
  figures.snowfalls_refused = inputs.snowfalls().refusedCount();
  figures.craters = inputs.craters().count();
  figures.craters_refused = inputs.craters().refusedCount();
  figures.wall_s = millisecondsSince(start) / 1e3;
  return figures;
}

}  // namespace spoor
