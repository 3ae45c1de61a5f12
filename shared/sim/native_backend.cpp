#include <algorithm>
#include <optional>
#include <thread>
#include <utility>

#include "shaders/rules/exchange.h"
#include "shared/base/assert.h"
#include "shared/sim/native_stages.h"
#include "shared/world/tile_snow.h"

namespace spoor {
namespace {

// Bytes that a stage reads and writes, for the figure TickEffect::bytes_moved.
constexpr std::int64_t kGatherBytes = 16;       // per active cell: height and bedrock, in and out
constexpr std::int64_t kClearBytes = 4;         // per active cell and sub-step: underside
constexpr std::int64_t kPenetrationBytes = 20;  // per domain cell: depth lowers the underside; three planes in, one out
constexpr std::int64_t kCompactionBytes = 8;    // per active cell: compacted soil, in and out
constexpr std::int64_t kHashBytes = 8;          // per active cell: compare with the tile

/// Bytes of the relaxation for each pair of cells visited.
std::int64_t pairBytes(SlopeRule rule) {
  switch (rule) {
    case SlopeRule::exchange:
      return 24;  // two heights in and out, two bedrocks in
    case SlopeRule::flux:
    case SlopeRule::interleaved:
    case SlopeRule::drift:
      return 16 / 4;  // per cell: height, bedrock, underside in, new height out
    case SlopeRule::scatter:
      return 28 / 4;  // per cell: a copy before it, and new heights in and out
  }
  return 0;
}

class NativeBackend final : public Backend {
 public:
  explicit NativeBackend(const NativeOptions& options)
      : pool_(options.thread_count > 0 ? options.thread_count : std::max(1, int(std::thread::hardware_concurrency()))),
        kernels_(options.kernels != nullptr ? options.kernels : &kernels()),
        skip_settled_(options.skip_settled) {}

  std::string name() const override {
    return std::string("native (") + kernels_->name + ", " + std::to_string(pool_.threadCount()) + " threads)";
  }

  std::string renderer() const override { return "none (native)"; }

  Status submit(TickPlan plan, const BaseTerrain& base, const WorldState&) override {
    SPOOR_ASSERT(!submitted_);
    submitted_.emplace(std::move(plan), &base);
    return {};
  }

  Result<TickEffect> settle(WorldState& state) override {
    SPOOR_ASSERT(submitted_.has_value());
    const auto [plan, base] = *std::exchange(submitted_, std::nullopt);
    const NativeContext context{base->pack(), plan.tick, plan.parameters, *kernels_, pool_, area_};
    TickEffect effect;
    ActiveTiles active;
    {
      StageTimer timer(effect.stage_ms, Stage::active);
      active = takeTiles(plan, *base, state, pool_);
    }
    {
      StageTimer timer(effect.stage_ms, Stage::craters);
      runSnow(plan, base->pack(), active, state);
      runCraters(plan, active, state);
    }
    {
      StageTimer timer(effect.stage_ms, Stage::active);
      area_.gather(active.tiles, plan.parameters, pool_);
    }
    effect.active_cells = std::int64_t(area_.tiles.size()) * rules::kTileCells;
    effect.bytes_moved = effect.active_cells * (kGatherBytes + kHashBytes);
    {
      StageTimer timer(effect.stage_ms, Stage::depth);
      area_.clearUnderside(context.pack, pool_);
      runStood(context, plan.stood);
    }
    if (anyCompression(plan.parameters)) effect.bytes_moved += effect.active_cells * kCompactionBytes;
    int sweep = 0;
    for (const SubStep& sub_step : plan.sub_steps) {
      runSubStep(context, sub_step, sweep, effect);
      sweep += sub_step.sweep_count;
    }
    {
      StageTimer timer(effect.stage_ms, Stage::hash);
      effect.changes = commitTick(plan, std::move(active), runHash(context), state);
    }
    return effect;
  }

  Status collect(WorldState&, std::vector<TileChange>&) override { return {}; }  // settle() has done it all

  void tilesChanged(std::span<Tile* const>) override {}

  void forget() override { submitted_.reset(); }

  BackendMemory memory() const override {
    BackendMemory memory{0, 0, area_.buffers()};
    for (const DomainWork& domain : domains_) domain.addBuffers(memory.buffers);
    for (const BufferBytes& buffer : memory.buffers) memory.host_bytes += buffer.bytes;
    return memory;
  }

 private:
  void runSnow(const TickPlan& plan, const ScenePack& pack, const ActiveTiles& active, WorldState& state) {
    for (std::size_t i = 0; i < active.tiles.size(); ++i)
      if (active.snowed[i] != 0) snowOnTile(*active.tiles[i], pack, plan.tick, state);
  }

  /// Stage craters: what new ones do to live tiles.
  void runCraters(const TickPlan& plan, const ActiveTiles& active, WorldState& state) {
    std::vector<std::size_t> touched;
    for (std::size_t i = 0; i < active.tiles.size(); ++i)
      if (!active.cratered[i].empty()) touched.push_back(i);
    std::vector<std::pair<std::int64_t, std::uint64_t>> outcomes(touched.size());
    pool_.forEach(int(touched.size()), [&](int i, int) {
      Tile& tile = *active.tiles[touched[i]];
      outcomes[i].first =
          addCraters(tile.at, tile.height(), *tile.bedrock, state.craters, plan.first_new_crater, tile.craters);
      outcomes[i].second = tileHash(tile);
    });
    for (std::size_t i = 0; i < touched.size(); ++i)
      commitCraters(*active.tiles[touched[i]], outcomes[i].first, outcomes[i].second, state);
  }

  void runSubStep(const NativeContext& context, const SubStep& sub_step, int sweep, TickEffect& effect) {
    const int step = sweep * rules::kMatchingCount;
    {
      StageTimer timer(effect.stage_ms, Stage::depth);
      lowest_before_ = area_.lowest_underside;
      std::swap(area_.underside, area_.underside_before);
      area_.clearUnderside(context.pack, pool_);
      runDepth(context, sub_step);
      // Where a body was or is, room beneath it may have changed.
      for (std::size_t i = 0; i < lowest_before_.size(); ++i)
        if (std::min(area_.lowest_underside[i], lowest_before_[i]) < rules::kNoUnderside) area_.last_change[i] = step;
    }
    effect.bytes_moved += effect.active_cells * kClearBytes;
    domains_.resize(std::max(domains_.size(), sub_step.domains.size()));
    for (std::size_t i = 0; i < sub_step.domains.size(); ++i) {
      DomainWork& domain = domains_[i];
      domain.reset(sub_step.domains[i].box, area_);
      const auto cells = std::int64_t(domain.overlap.size());
      effect.domain_cells += cells;
      effect.bytes_moved += cells * kPenetrationBytes;
      {
        StageTimer timer(effect.stage_ms, Stage::penetration);
        runPenetration(context, domain);
      }
      effect.penetrating_cells += domain.penetrating_count;
      if (domain.penetratingLeft() == 0 || context.parameters.displacement == Displacement::none) continue;
      {
        StageTimer timer(effect.stage_ms, Stage::nearest);
        runNearest(context, domain);
      }
      {
        StageTimer timer(effect.stage_ms, Stage::displace);
        effect.kept_back += runDisplace(context, domain, step);
      }
      effect.bytes_moved += domain.bytes_moved;
    }
    StageTimer timer(effect.stage_ms, Stage::relax);
    runPush(context, sub_step);
    const std::int64_t pairs = runRelax(context, sweep, sub_step.sweep_count, skip_settled_);
    effect.pairs_visited += pairs;
    const std::int64_t bytes = pairs * pairBytes(context.parameters.slopes);
    effect.relax_bytes += bytes;
    effect.bytes_moved += bytes;
  }

  ThreadPool pool_;
  const Kernels* kernels_;
  bool skip_settled_;
  WorkArea area_;
  std::vector<std::int32_t> lowest_before_;  // of segments, a sub-step earlier
  std::vector<DomainWork> domains_;
  std::optional<std::pair<TickPlan, const BaseTerrain*>> submitted_;
};

}  // namespace

std::unique_ptr<Backend> makeNativeBackend(const NativeOptions& options) {
  return std::make_unique<NativeBackend>(options);
}

}  // namespace spoor
