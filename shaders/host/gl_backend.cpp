#include "shaders/host/gl_backend.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <deque>
#include <stdexcept>
#include <thread>

#include "shaders/host/gl_context.h"
#include "shaders/host/stage_clock.h"
#include "shared/base/assert.h"
#include "shared/base/thread_pool.h"

namespace spoor {
namespace {

// Bytes that a stage reads and writes, for the figure TickEffect::bytes_moved.
constexpr std::int64_t kGatherBytes = 16;       // per active cell: height and bedrock, in and out
constexpr std::int64_t kCoverBytes = 4;         // per domain cell: underside (of whole tiles; counted once)
constexpr std::int64_t kPenetrationBytes = 20;  // per domain cell: depth lowers the underside; three planes in, one out
constexpr std::int64_t kNearestBytes = 20;   // per penetrating cell: nearest row out and in, overlap in, target out, in
constexpr std::int64_t kDisplaceBytes = 48;  // per penetrating cell: target, sums and height, in and out
constexpr std::int64_t kSlabPairs = rules::kSlabRows * rules::kTileSize / 2;
constexpr std::int64_t kPairBytes = 24;           // two heights in and out, two bedrocks in
constexpr std::int64_t kFusedPairBytes = 24 / 4;  // a fused sweep reads and writes a cell once, for its four pairs
constexpr std::int64_t kHashBytes = 8;            // per active cell: compare with the pool

/// What a tick left on the device for collect().
struct Uncollected {
  std::int64_t cells = 0;  // differences, of all changes in their order
  std::vector<std::int64_t> first_of_change;
  int readback = 0;  // which of the two
};

class GlBackend final : public Backend {
 public:
  GlBackend(std::unique_ptr<HeadlessContext> context, GlLimits limits, const GlOptions& options, RelaxSchedule schedule)
      : context_(std::move(context)),
        limits_(std::move(limits)),
        shape_(options.shape),
        schedule_(schedule),
        pool_(options.thread_count > 0 ? options.thread_count : std::max(1, int(std::thread::hardware_concurrency()))),
        device_(std::make_unique<Device>(limits_, options, schedule)) {}

  ~GlBackend() override {
    const CurrentContext current(*context_);
    if (current.ok())
      device_.reset();
    else
      device_.release();  // GL names can only be given back to their context; they end with it
  }

  std::string name() const override {
    return "gl (" + limits_.renderer + ", " + context_->path() +
           (schedule_ == RelaxSchedule::fused ? ", fused sweeps)" : ", plain sweeps)");
  }

  std::string renderer() const override { return limits_.renderer; }

  Result<TickEffect> run(const TickPlan& plan, const BaseTerrain& base, WorldState& state) override {
    SPOOR_ASSERT(uncollected_.size() < 2);
    if (failed_ && !uncollected_.empty())
      return Error{"gl: after a failed tick the one before it must be collected first"};
    failed_ = false;
    TickEffect effect;
    if (plan.active.empty()) {
      uncollected_.emplace_back();
      return effect;
    }
    const CurrentContext current(*context_);
    if (!current.ok()) return Error{"gl: the context cannot be made current on this thread"};
    std::vector<Tile*> made_live;
    const std::vector<Tile*> tiles = takeTiles(plan, base, state, pool_, made_live);
    Status done = compute(plan, base.pack(), tiles, effect);
    if (!done) {
      device_->tiles.forget();  // the pool may be a tick ahead of the state, and the state a tick ahead of its cells
      failed_ = true;
      for (Tile* tile : made_live) state.tiles.remove(*tile);
      return Error{"tick " + std::to_string(plan.tick) + ": " + done.error()};
    }
    commit(plan, base.pack(), tiles, made_live, state, effect);
    return effect;
  }

  Status collect(WorldState& state, std::vector<TileChange>& changes) override {
    SPOOR_ASSERT(!uncollected_.empty());
    Uncollected tick = std::move(uncollected_.front());
    uncollected_.pop_front();
    if (tick.cells == 0) return {};
    const CurrentContext current(*context_);
    if (!current.ok()) return Error{"gl: the context cannot be made current on this thread"};
    if (Status status = device_->copied[tick.readback].wait("changed cells"); !status) return status;
    const auto* cells = reinterpret_cast<const std::int32_t*>(device_->changed_cells[tick.readback].data());
    for (std::size_t i = 0; i < changes.size(); ++i) {
      TileChange& change = changes[i];
      const std::int32_t* first = cells + tick.first_of_change[i];
      change.difference.assign(first, first + change.width * change.height);
      PlaneCells& height = state.tiles.find(change.at)->height();
      for (int row = 0; row < change.height; ++row)
        for (int column = 0; column < change.width; ++column)
          height[std::size_t((change.y + row) * rules::kTileSize + change.x + column)] +=
              change.difference[std::size_t(row * change.width + column)];
    }
    return {};
  }

  void forget() override {
    device_->tiles.forget();
    uncollected_.clear();
    loaded_ = nullptr;
  }

  BackendMemory memory() const override {
    return {device_->tiles.hostBytes() + device_->results.bytes() + device_->changed_cells[0].bytes() +
                device_->changed_cells[1].bytes() + std::int64_t(tables_.bytes.capacity()),
            device_->tiles.deviceBytes() + device_->stages.deviceBytes()};
  }

 private:
  /// All that needs the context current when it dies.
  struct Device {
    Device(const GlLimits& limits, const GlOptions& options, RelaxSchedule schedule)
        : stages(limits, options.shape, schedule, options.skip_settled),
          tiles(
              limits.storage_block_bytes, options.pool_tiles, options.say ? options.say : [](const std::string&) {}),
          clock(!limits.software) {}
    GlStages stages;
    TilePool tiles;
    StageClock clock;
    ReadbackBuffer results{"the tick's results on the host"};
    ReadbackBuffer changed_cells[2] = {ReadbackBuffer{"the changed cells on the host"},
                                       ReadbackBuffer{"the changed cells on the host"}};
    GlFence finished, copied[2];
  };

  /// Runs the stages and waits for their results. Leaves the state alone.
  Status compute(const TickPlan& plan, const ScenePack& pack, const std::vector<Tile*>& tiles, TickEffect& effect) {
    GlStages& stages = device_->stages;
    StageClock& clock = device_->clock;
    const std::int64_t copied_before = device_->tiles.copiedBytes(), dispatched_before = stages.dispatchCount();
    clock.begin();
    if (loaded_ != &pack) {
      meshes_ = makeMeshTable(pack);
      if (Status status = stages.load(pack, meshes_); !status) return status;
      loaded_ = &pack;
    }
    auto slots = device_->tiles.hold(tiles, plan.tick);
    if (!slots) return Error{slots.error()};
    tables_ = makeTickTables(pack, meshes_, plan, *slots, shape_);
    if (Status status = stages.begin(tables_); !status) return status;
    stages.gather(device_->tiles);
    clock.end(Stage::active);
    for (int i = 0; i < int(tables_.sub_steps.size()); ++i) {
      const SubStepTables& step = tables_.sub_steps[std::size_t(i)];
      stages.depth(step, i);
      clock.end(Stage::depth);
      stages.penetration(step, i);
      clock.end(Stage::penetration);
      stages.nearest(step, i);
      clock.end(Stage::nearest);
      stages.displace(step, i);
      clock.end(Stage::displace);
      stages.relax(step);
      clock.end(Stage::relax);
      effect.domain_cells += step.domain_cells;
    }
    stages.hash(device_->tiles);
    clock.end(Stage::hash);
    if (Status status = fetchResults(std::int64_t(tiles.size())); !status) return status;
    std::memcpy(&head_, device_->results.data(), kHeadBytes);
    if (Status status = readback().reserve(stagedBytes()); !status) return status;
    clock.addTo(effect.stage_ms);
    effect.dispatches = stages.dispatchCount() - dispatched_before;
    effect.bytes_to_device = device_->tiles.copiedBytes() - copied_before + std::int64_t(tables_.bytes.size());
    return {};
  }

  /// Waits for the tick's head and its tiles' results.
  Status fetchResults(std::int64_t tile_count) {
    const std::int64_t bytes = tile_count * std::int64_t(sizeof(rules::TileResult));
    if (Status status = device_->results.reserve(kHeadBytes + bytes); !status) return status;
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);  // the tables' head, results, and staging, which is copied later
    glCopyNamedBufferSubData(device_->stages.tables(), device_->results.name(), tables_.head.offset, 0, kHeadBytes);
    glCopyNamedBufferSubData(device_->stages.results().name(), device_->results.name(), 0, kHeadBytes, bytes);
    device_->finished.place();
    if (Status status = device_->finished.wait("results"); !status) return status;
    return glStatus("the stages");
  }

  /// Takes the state to the new tick and sends the changed cells on their way.
  void commit(const TickPlan& plan, const ScenePack& pack, const std::vector<Tile*>& tiles,
              const std::vector<Tile*>& made_live, WorldState& state, TickEffect& effect) {
    std::vector<TileOutcome> outcomes(tiles.size());
    std::vector<std::int64_t> first_of_tile(tiles.size());
    for (std::size_t i = 0; i < tiles.size(); ++i) {
      rules::TileResult result;
      std::memcpy(&result, device_->results.data() + kHeadBytes + std::size_t(tables_.tile_index[i]) * sizeof(result),
                  sizeof(result));
      outcomes[i] = outcomeOf(result);
      first_of_tile[i] = result.first_staged;
    }
    Uncollected& tick = uncollected_.emplace_back();
    effect.changes = commitTick(plan, pack.sweeps_per_tick, tiles, made_live, std::move(outcomes), state);
    std::size_t tile = 0;
    for (const TileChange& change : effect.changes) {
      while (tiles[tile]->at != change.at) ++tile;
      tick.first_of_change.push_back(first_of_tile[tile]);
    }
    tick.cells = head_.staged_cells;
    tick.readback = next_readback_;
    if (tick.cells > 0) {
      glCopyNamedBufferSubData(device_->stages.staging().name(), readback().name(), 0, 0, stagedBytes());
      device_->copied[tick.readback].place();
    }
    next_readback_ = 1 - next_readback_;
    count(std::int64_t(tiles.size()), effect);
  }

  ReadbackBuffer& readback() { return device_->changed_cells[next_readback_]; }
  std::int64_t stagedBytes() const { return head_.staged_cells * std::int64_t(sizeof(std::int32_t)); }

  static TileOutcome outcomeOf(const rules::TileResult& result) {
    TileOutcome outcome;
    if (result.x1 == 0) return outcome;
    outcome.change.x = std::uint8_t(result.x0);
    outcome.change.y = std::uint8_t(result.y0);
    outcome.change.width = std::uint8_t(result.x1 - result.x0);
    outcome.change.height = std::uint8_t(result.y1 - result.y0);
    const auto joined = [](const rules::uint(&halves)[2]) { return halves[0] + (std::uint64_t(halves[1]) << 16); };
    outcome.hash = joined(result.hash_low) + (joined(result.hash_high) << 32);
    outcome.ground = std::int64_t(joined(result.height)) - (std::int64_t(rules::kTileCells) << 30);
    return outcome;
  }

  void count(std::int64_t tile_count, TickEffect& effect) const {
    effect.active_cells = tile_count * rules::kTileCells;
    effect.penetrating_cells = head_.penetrating_cells;
    effect.pairs_visited = head_.slabs_visited * kSlabPairs;
    effect.bytes_moved = effect.active_cells * (kGatherBytes + kHashBytes) +
                         effect.domain_cells * (kCoverBytes + kPenetrationBytes) +
                         effect.penetrating_cells * (kNearestBytes + kDisplaceBytes) +
                         effect.pairs_visited * (schedule_ == RelaxSchedule::fused ? kFusedPairBytes : kPairBytes);
    effect.bytes_from_device = kHeadBytes + tile_count * std::int64_t(sizeof(rules::TileResult)) + stagedBytes();
  }

  static constexpr std::int64_t kHeadBytes = offsetof(rules::TickHead, lists);

  std::unique_ptr<HeadlessContext> context_;
  GlLimits limits_;
  GroupShape shape_;
  RelaxSchedule schedule_;
  ThreadPool pool_;
  std::unique_ptr<Device> device_;
  const ScenePack* loaded_ = nullptr;  // whose meshes are on the device
  MeshTable meshes_;
  TickTables tables_;
  rules::TickHead head_{};  // of the last tick, as the stages left it
  std::deque<Uncollected> uncollected_;
  int next_readback_ = 0;
  bool failed_ = false;  // the last run did
};

Result<std::unique_ptr<Backend>> openBackend(const GlOptions& options) {
  auto context = openHeadlessContext(options.device);
  if (!context) return Error{context.error()};
  if (options.hardware_only && (*context)->software())
    return Error{"the renderer is software (" + (*context)->renderer() + ")"};
  auto limits = checkLimits(**context);
  if (!limits) return Error{limits.error()};
  if (options.say) options.say(describe(*limits));
  const bool fused = options.schedule == GlOptions::Schedule::fused ||
                     (options.schedule == GlOptions::Schedule::by_renderer && !limits->software);
  try {
    HeadlessContext& opened = **context;
    auto backend = std::make_unique<GlBackend>(std::move(*context), std::move(*limits), options,
                                               fused ? RelaxSchedule::fused : RelaxSchedule::plain);
    opened.release();
    return std::unique_ptr<Backend>(std::move(backend));
  } catch (const std::runtime_error& error) {
    return Error{error.what()};
  }
}

}  // namespace

Result<std::unique_ptr<Backend>> makeGlBackend(const GlOptions& options) {
  SPOOR_ASSERT(options.shape.group == 64 || options.shape.group == 128 || options.shape.group == 256);
  // Opening a context makes it current; on a thread of its own, so that what is current on the caller's stays so.
  Result<std::unique_ptr<Backend>> backend = Error{};
  std::thread([&] { backend = openBackend(options); }).join();
  return backend;
}

}  // namespace spoor
