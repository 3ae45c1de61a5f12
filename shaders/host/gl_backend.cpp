#include "shaders/host/gl_backend.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <deque>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>

#include "shaders/host/gl_context.h"
#include "shaders/host/stage_clock.h"
#include "shaders/host/tick_figures.h"
#include "shaders/host/tick_results.h"
#include "shared/base/assert.h"
#include "shared/base/thread_pool.h"
#include "shared/world/tile_snow.h"

namespace spoor {
namespace {

const Status kNotCurrent = Error{"gl: the context cannot be made current on this thread"};

/// A tick between submit() and settle().
struct Submitted {
  TickPlan plan;
  const ScenePack* pack = nullptr;
  ActiveTiles active;
  TickTables tables;
  TickEffect effect;
};

/// What a tick left on the device for collect().
struct Uncollected {
  struct Place {
    std::int64_t first = 0;  // of a change's differences
    bool compacts = false;   // do those of compacted soil follow those of heights?
    CellBox cratered;        // what new craters changed before; empty: nothing
    std::int64_t first_cratered = 0;
  };
  std::int64_t cells = 0;     // differences, of all tiles, and then those of craters
  std::vector<Place> places;  // [changes]
  int readback = 0;           // which of the two
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

  Status submit(TickPlan plan, const BaseTerrain& base, const WorldState& state) override {
    SPOOR_ASSERT(!submitted_ && uncollected_.size() < 2);
    Submitted tick;
    tick.pack = &base.pack();
    tick.plan = std::move(plan);
    if (!tick.plan.active.empty()) {
      const CurrentContext current(*context_);
      if (!current.ok()) return kNotCurrent;
      {
        StageTimer timer(tick.effect.stage_ms, Stage::active);
        tick.active = takeTiles(tick.plan, base, state, pool_);
      }
      if (Status status = queueStages(tick, state); !status) {
        forgetDevice();  // fresh tiles are gone again
        return status;
      }
    }
    submitted_ = std::move(tick);
    return {};
  }

  Result<TickEffect> settle(WorldState& state) override {
    SPOOR_ASSERT(submitted_.has_value());
    Submitted tick = *std::exchange(submitted_, std::nullopt);
    if (tick.plan.active.empty()) {
      uncollected_.emplace_back();
      return std::move(tick.effect);
    }
    const CurrentContext current(*context_);
    if (!current.ok()) return Error{kNotCurrent.error()};
    if (Status status = fetchResults(tick); !status) {
      forgetDevice();  // the pool may be a tick ahead of the state, and fresh tiles are gone
      return Error{status.error()};
    }
    commit(tick, state);
    return std::move(tick.effect);
  }

  Status collect(WorldState& state, std::vector<TileChange>& changes) override {
    SPOOR_ASSERT(!uncollected_.empty());
    Uncollected tick = std::move(uncollected_.front());
    uncollected_.pop_front();
    if (tick.cells == 0) return {};
    const CurrentContext current(*context_);
    if (!current.ok()) return kNotCurrent;
    if (Status status = device_->copied[tick.readback].wait("changed cells"); !status) return status;
    const auto* cells = reinterpret_cast<const std::int32_t*>(device_->changed_cells[tick.readback].data());
    for (std::size_t i = 0; i < changes.size(); ++i) {
      TileChange& change = changes[i];
      const Uncollected::Place& place = tick.places[i];
      const std::int32_t* first = cells + place.first;
      const int cell_count = change.width * change.height;
      Tile& tile = *state.tiles.find(change.at);
      addBox(tile.height(), place.cratered, cells + place.first_cratered);
      change.difference.assign(first, first + cell_count);
      addBox(tile.height(), boxOf(change), first);
      if (!place.compacts) continue;
      change.compaction.assign(first + cell_count, first + 2 * cell_count);
      addBox(tile.makeCompacted(), boxOf(change), first + cell_count);
    }
    return {};
  }

  void tilesChanged(std::span<Tile* const> tiles) override { device_->tiles.drop(tiles); }

  void forget() override {
    forgetDevice();
    submitted_.reset();
    uncollected_.clear();
    loaded_ = nullptr;
    highest_ = -rules::kHeightLimit;  // the pool sees every tile of the next state
  }

  BackendMemory memory() const override {
    BackendMemory memory;
    memory.host_bytes = device_->tiles.hostBytes() + device_->results.bytes() + device_->changed_cells[0].bytes() +
                        device_->changed_cells[1].bytes();
    memory.buffers = device_->stages.buffers();
    memory.buffers.push_back({"pool of live tiles", device_->tiles.deviceBytes()});
    memory.buffers.push_back({"craters and their spatial hash", device_->craters.deviceBytes()});
    for (const BufferBytes& buffer : memory.buffers) memory.device_bytes += buffer.bytes;
    return memory;
  }

 private:
  /// All that needs the context current when it dies.
  struct Device {
    Device(const GlLimits& limits, const GlOptions& options, RelaxSchedule schedule)
        : stages(limits, options.shape, schedule, options.skip_settled),
          tiles(
              limits.storage_block_bytes, options.pool_tiles, options.say ? options.say : [](const std::string&) {}),
          craters(limits.storage_block_bytes),
          clock(!limits.software) {}
    GlStages stages;
    TilePool tiles;
    GlCraterTable craters;
    StageClock clock;
    ReadbackBuffer results{"the tick's results on the host"};
    ReadbackBuffer changed_cells[2] = {ReadbackBuffer{"the changed cells on the host"},
                                       ReadbackBuffer{"the changed cells on the host"}};
    GlFence finished, copied[2];
  };

  /// What the device holds is of no state.
  void forgetDevice() {
    device_->tiles.forget();
    knows_craters_ = false;
  }

  /// Brings a tick's tiles and tables to the device.
  Status prepare(Submitted& tick, std::span<const Snowfall> snowfalls) {
    StageTimer timer(tick.effect.stage_ms, Stage::active);
    if (loaded_ != tick.pack) {
      meshes_ = makeMeshTable(*tick.pack);
      const bool with_craters = tick.pack->crater_limits.radius_q > 0;
      const bool with_snow = !tick.pack->snowfalls.empty();
      if (Status status = device_->stages.load(meshes_, with_craters, with_snow); !status) return status;
      if (with_craters)
        if (Status status = device_->craters.compile(); !status) return status;
      loaded_ = tick.pack;
    }
    const PoolPlanes planes{compactsIn(tick.plan), tick.plan.parameters.materials.size() > 1};
    auto slots = device_->tiles.hold(tick.active.tiles, tick.plan.tick, planes);
    if (!slots) return Error{slots.error()};
    tick.tables = makeTickTables(*tick.pack, meshes_, tick.plan, *slots, std::max(device_->tiles.highest(), highest_),
                                 shape_, {tick.active.snowed, snowfalls, tick.active.cratered});
    if (Status status = device_->results.reserve(kHeadBytes + resultBytes(tick)); !status) return status;
    return device_->stages.begin(tick.tables);
  }

  /// Brings the device's craters to the state's and queues what this tick's do. The others wait there for a tick that
  /// has to do with craters.
  Status queueCraters(const Submitted& tick, const CraterSet& craters) {
    GlCraterTable& table = device_->craters;
    if (!std::exchange(knows_craters_, true)) table.forget();
    if (Status status = table.update(craters, tick.pack->cell_q); !status) return status;
    return device_->stages.craters(tick.tables, device_->tiles, craters, tick.plan.first_new_crater, table,
                                   tick.pack->cell_q);
  }

  std::int64_t copiedBytes() const { return device_->tiles.copiedBytes() + device_->craters.copiedBytes(); }
  std::int64_t dispatchCount() const { return device_->stages.dispatchCount() + device_->craters.dispatchCount(); }

  /// Queues all stages of a tick, and the copy of their results to the host.
  Status queueStages(Submitted& tick, const WorldState& state) {
    GlStages& stages = device_->stages;
    StageClock& clock = device_->clock;
    const std::int64_t copied_before = copiedBytes(), dispatched_before = dispatchCount();
    if (Status status = prepare(tick, state.snowfalls); !status) return status;
    const TickTables& tables = tick.tables;
    clock.begin();
    const bool snows = tables.snow.groups.count > 0, deforms = !tables.craters.tiles.empty();
    if (snows)
      if (Status status = stages.snow(tables, device_->tiles); !status) return status;
    if (deforms)
      if (Status status = queueCraters(tick, state.craters); !status) return status;
    if (snows || deforms) clock.end(Stage::craters);
    stages.gather(tables, device_->tiles);
    clock.end(Stage::active);
    if (tables.stood.cover.count > 0) stages.depth(tables, GlStages::kStood);
    clock.end(Stage::depth);
    for (int i = 0; i < int(tables.sub_steps.size()); ++i) {
      stages.depth(tables, i);
      clock.end(Stage::depth);
      stages.penetration(tables, i);
      clock.end(Stage::penetration);
      stages.nearest(tables, i);
      clock.end(Stage::nearest);
      stages.displace(tables, i);
      clock.end(Stage::displace);
      stages.relax(tables, i);
      clock.end(Stage::relax);
      tick.effect.domain_cells += tables.sub_steps[std::size_t(i)].domain_cells;
    }
    stages.hash(tables, device_->tiles);
    clock.end(Stage::hash);
    tick.effect.bytes_moved = stages.domainBytes();
    tick.effect.dispatches = dispatchCount() - dispatched_before;
    tick.effect.bytes_to_device = copiedBytes() - copied_before + std::int64_t(tables.bytes.size());

    if (Status status = glStatus("the stages"); !status) return status;
    // What the stages wrote is copied now (head, results) or later (staging), or written over in the next tick.
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glCopyNamedBufferSubData(stages.tables(), device_->results.name(), tables.head.offset, 0, kHeadBytes);
    glCopyNamedBufferSubData(stages.results().name(), device_->results.name(), 0, kHeadBytes, tileBytes(tick));
    if (const std::int64_t bytes = craterBytes(tick); bytes > 0)
      glCopyNamedBufferSubData(stages.tables(), device_->results.name(), tables.craters.range.offset,
                               kHeadBytes + tileBytes(tick), bytes);
    device_->finished.place();
    return glStatus("copying results");
  }

  // What comes back besides the head: results of tiles, then those of craters.
  static std::int64_t tileBytes(const Submitted& tick) {
    return std::int64_t(tick.active.tiles.size() * sizeof(rules::TileResult));
  }
  static std::int64_t craterBytes(const Submitted& tick) {
    return std::int64_t(tick.tables.craters.tiles.size() * sizeof(rules::CraterTile));
  }
  static std::int64_t resultBytes(const Submitted& tick) { return tileBytes(tick) + craterBytes(tick); }

  /// Waits for a tick's head and its tiles' results, and sends the changed cells on their way.
  Status fetchResults(Submitted& tick) {
    if (Status status = device_->finished.wait("results"); !status) return status;
    std::memcpy(&head_, device_->results.data(), kHeadBytes);
    device_->clock.addTo(tick.effect.stage_ms);
    // Only pair exchange never lifts a cell above all others.
    highest_ =
        tick.plan.parameters.slopes == SlopeRule::exchange ? std::max(highest_, head_.highest) : rules::kHeightLimit;
    const std::int64_t staged = bytesOf(head_.staged_cells), cratered = bytesOf(tick.tables.craters.cells);
    if (staged + cratered == 0) return {};
    if (Status status = readback().reserve(staged + cratered); !status) return status;
    if (staged > 0) glCopyNamedBufferSubData(device_->stages.staging().name(), readback().name(), 0, 0, staged);
    if (cratered > 0)
      glCopyNamedBufferSubData(device_->stages.craterChanges().name(), readback().name(), 0, staged, cratered);
    device_->copied[next_readback_].place();
    return glStatus("copying changed cells");
  }

  /// Takes the state to the new tick.
  void commit(Submitted& tick, WorldState& state) {
    const std::size_t count = tick.active.tiles.size();
    const std::vector<Tile*> tiles = tick.active.tiles;
    std::vector<TileOutcome> outcomes(count);
    std::vector<Uncollected::Place> places(count);
    commitSnowed(tick, state);
    commitCratered(tick, places, state);
    for (std::size_t i = 0; i < count; ++i) {
      const auto result = resultOf(tick, i);
      outcomes[i] = outcomeOf(result, *tiles[i], compactsIn(tick.plan));
      places[i].first = result.first_staged;
      places[i].compacts = result.compacts != 0;
    }
    std::vector<TileChange>& changes = tick.effect.changes;
    changes = commitTick(tick.plan, std::move(tick.active), std::move(outcomes), state);
    Uncollected& left = uncollected_.emplace_back();
    std::size_t tile = 0;
    for (const TileChange& change : changes) {
      while (tiles[tile]->at != change.at) ++tile;
      left.places.push_back(places[tile]);
    }
    left.cells = head_.staged_cells + tick.tables.craters.cells;
    left.readback = next_readback_;
    next_readback_ = 1 - next_readback_;
    fillFigures(tick.plan, head_, std::int64_t(count), tick.tables.craters.cells, schedule_, tick.effect);
    tick.effect.bytes_from_device =
        kHeadBytes + std::int64_t(count * sizeof(rules::TileResult)) + craterBytes(tick) + bytesOf(left.cells);
  }

  rules::TileResult resultOf(const Submitted& tick, std::size_t i) const {
    rules::TileResult result;
    std::memcpy(&result, device_->results.data() + kHeadBytes + std::size_t(tick.tables.tile_index[i]) * sizeof(result),
                sizeof(result));
    return result;
  }

  /// Stage craters: what fell on tiles. Their cells on the host take it at once, as rules/snowfall.h tells it: they are
  /// as of the tick before, and what is still to come from the device is added to them. So a tile that this tick leaves
  /// asleep has all its cells before the next one begins, whose snow may look at them.
  void commitSnowed(const Submitted& tick, WorldState& state) {
    std::vector<std::size_t> snowed;
    for (std::size_t i = 0; i < tick.active.tiles.size(); ++i)
      if (tick.active.snowed[i] != 0) snowed.push_back(i);
    std::vector<std::int64_t> gained(snowed.size());
    pool_.forEach(int(snowed.size()), [&](int i, int) {
      Tile& tile = *tick.active.tiles[snowed[std::size_t(i)]];
      gained[std::size_t(i)] = addSnow(*tick.pack, tile.at, state.snowfalls, tick.plan.tick, tile.height());
    });
    // The hash of the tick's end, as with craters.
    for (std::size_t i = 0; i < snowed.size(); ++i) {
      Tile& tile = *tick.active.tiles[snowed[i]];
      commitSnow(tile, gained[i], hashOf(resultOf(tick, snowed[i]), tile, compactsIn(tick.plan)), state);
    }
  }

  /// Stage craters: the sums of tiles that new ones changed, and where the differences of their cells are.
  void commitCratered(const Submitted& tick, std::vector<Uncollected::Place>& places, WorldState& state) const {
    const CraterTables& craters = tick.tables.craters;
    for (std::size_t i = 0; i < craters.tiles.size(); ++i) {
      rules::CraterTile tile;
      std::memcpy(&tile, device_->results.data() + kHeadBytes + tileBytes(tick) + std::int64_t(i * sizeof(tile)),
                  sizeof(tile));
      const auto active = std::size_t(craters.active[i]);
      Uncollected::Place& place = places[active];
      place.cratered = tick.active.cratered[active];
      place.first_cratered = head_.staged_cells + tile.first_change;
      // The hash of the tick's end: commitTick keeps it where no later stage changed the tile, and sets it elsewhere.
      Tile& live = *tick.active.tiles[active];
      commitCraters(live, gainedOf(tile), hashOf(resultOf(tick, active), live, compactsIn(tick.plan)), state);
    }
  }

  ReadbackBuffer& readback() { return device_->changed_cells[next_readback_]; }
  static std::int64_t bytesOf(std::int64_t cells) { return cells * std::int64_t(sizeof(std::int32_t)); }

  static bool compactsIn(const TickPlan& plan) { return anyCompression(plan.parameters); }

  static constexpr std::int64_t kHeadBytes = sizeof(rules::TickHead);

  std::unique_ptr<HeadlessContext> context_;
  GlLimits limits_;
  GroupShape shape_;
  RelaxSchedule schedule_;
  ThreadPool pool_;
  std::unique_ptr<Device> device_;
  const ScenePack* loaded_ = nullptr;  // whose meshes are on the device
  bool knows_craters_ = false;         // is what the device holds of craters from this state?
  MeshTable meshes_;
  std::int32_t highest_ = -rules::kHeightLimit;  // of all cells in all ticks
  rules::TickHead head_{};                       // of the last tick, as the stages left it
  std::optional<Submitted> submitted_;
  std::deque<Uncollected> uncollected_;
  int next_readback_ = 0;
};

Result<std::unique_ptr<Backend>> openBackend(const GlOptions& options) {
  auto context = openHeadlessContext(options.device);
  if (!context) return Error{context.error()};
  if (options.hardware_only && (*context)->software())
    return Error{"the renderer is software (" + (*context)->renderer() + ")"};
  auto limits = checkLimits(**context);
  if (!limits) return Error{limits.error()};
  if (options.say)
    for (const std::string& line : describe(*limits)) options.say("gl: " + line);
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
