#include <algorithm>
#include <optional>
#include <thread>
#include <utility>

#include "shaders/rules/exchange.h"
#include "shared/base/assert.h"
#include "shared/sim/native_stages.h"

namespace spoor {
namespace {

// Bytes that a stage reads and writes, for the figure TickEffect::bytes_moved.
constexpr std::int64_t kGatherBytes = 16;       // per active cell: height and bedrock, in and out
constexpr std::int64_t kClearBytes = 4;         // per active cell and sub-step: underside
constexpr std::int64_t kPenetrationBytes = 20;  // per domain cell: depth lowers the underside; three planes in, one out
constexpr std::int64_t kNearestBytes = 16;      // per domain cell: two column passes, in and out
constexpr std::int64_t kDisplaceBytes = 48;     // per penetrating cell: target, sums and height, in and out
constexpr std::int64_t kPairBytes = 24;         // two heights in and out, two bedrocks in
constexpr std::int64_t kHashBytes = 8;          // per active cell: compare with the tile

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
    const NativeContext context{base->pack(), plan.parameters, *kernels_, pool_, area_};
    TickEffect effect;
    ActiveTiles active;
    {
      StageTimer timer(effect.stage_ms, Stage::active);
      active = takeTiles(plan, *base, state, pool_);
      area_.gather(active.tiles, plan.parameters.compression_q16 > 0, pool_);
    }
    effect.active_cells = std::int64_t(area_.tiles.size()) * rules::kTileCells;
    effect.bytes_moved = effect.active_cells * (kGatherBytes + kHashBytes);
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

  void forget() override { submitted_.reset(); }

  BackendMemory memory() const override {
    std::size_t cells = area_.height.capacity() + area_.bedrock.capacity() + area_.underside.capacity() +
                        area_.lowest_underside.capacity() + area_.last_change.capacity() + underside_before_.capacity();
    std::size_t sums = 0;
    for (const DomainWork& domain : domains_) {
      cells +=
          domain.overlap.capacity() + domain.nearest_row.capacity() + domain.target.capacity() + domain.room.capacity();
      sums += domain.requested.capacity() + domain.granted.capacity();
    }
    return {std::int64_t(cells * sizeof(std::int32_t) + sums * sizeof(std::int64_t)), 0};
  }

 private:
  void runSubStep(const NativeContext& context, const SubStep& sub_step, int sweep, TickEffect& effect) {
    const int step = sweep * rules::kMatchingCount;
    {
      StageTimer timer(effect.stage_ms, Stage::depth);
      underside_before_ = area_.lowest_underside;
      area_.clearUnderside(context.pack, pool_);
      runDepth(context, sub_step);
      // Where a body was or is, room beneath it may have changed.
      for (std::size_t i = 0; i < underside_before_.size(); ++i)
        if (std::min(area_.lowest_underside[i], underside_before_[i]) < rules::kNoUnderside)
          area_.last_change[i] = step;
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
        effect.penetrating_cells += runPenetration(context, domain);
      }
      if (domain.penetrating_count == 0) continue;
      effect.bytes_moved += cells * kNearestBytes + domain.penetrating_count * kDisplaceBytes;
      {
        StageTimer timer(effect.stage_ms, Stage::nearest);
        runNearest(context, domain);
      }
      StageTimer timer(effect.stage_ms, Stage::displace);
      effect.kept_back += runDisplace(context, domain, step);
    }
    StageTimer timer(effect.stage_ms, Stage::relax);
    const std::int64_t pairs = runRelax(context, sweep, sub_step.sweep_count, skip_settled_);
    effect.pairs_visited += pairs;
    effect.relax_bytes += pairs * kPairBytes;
    effect.bytes_moved += pairs * kPairBytes;
  }

  ThreadPool pool_;
  const Kernels* kernels_;
  bool skip_settled_;
  WorkArea area_;
  std::vector<std::int32_t> underside_before_;
  std::vector<DomainWork> domains_;
  std::optional<std::pair<TickPlan, const BaseTerrain*>> submitted_;
};

}  // namespace

std::unique_ptr<Backend> makeNativeBackend(const NativeOptions& options) {
  return std::make_unique<NativeBackend>(options);
}

}  // namespace spoor
