#include "tests/gl_stage_rig.h"

#include <algorithm>
#include <cstddef>
#include <stdexcept>

#include "shaders/host/gl_context.h"
#include "shaders/host/gl_stages.h"
#include "shaders/rules/exchange.h"
#include "shared/base/assert.h"
#include "tests/gl_cases.h"
#include "tests/shelf.h"

namespace spoor::test {
namespace {

void check(const Status& status) {
  if (!status) throw std::runtime_error(status.error());
}

/// A context and the stages' programs: costly, so they are used again. Current on one thread, in a rig's calls only.
struct StageDevice {
  StageDevice(std::unique_ptr<HeadlessContext> opened, const GlLimits& found, const BackendCase& backend_case)
      : context(std::move(opened)),
        limits(found),
        shape(glOptionsOf(backend_case).shape),
        stages(limits, shape, backend_case.fused ? RelaxSchedule::fused : RelaxSchedule::plain,
               backend_case.skip_settled) {}
  ~StageDevice() { context->makeCurrent(); }  // until the members are gone, the context last

  std::unique_ptr<HeadlessContext> context;
  GlLimits limits;
  GroupShape shape;
  GlStages stages;
};

Shelf<StageDevice>& shelf() {
  static auto* const kept = new Shelf<StageDevice>;
  return *kept;
}

std::unique_ptr<StageDevice> makeDevice(const BackendCase& backend_case) {
  auto context = openHeadlessContext();
  if (!context) throw std::runtime_error(context.error());
  const auto limits = checkLimits(**context);
  if (!limits) throw std::runtime_error(limits.error());
  HeadlessContext& opened = **context;
  auto device = std::make_unique<StageDevice>(std::move(*context), *limits, backend_case);
  opened.release();
  return device;
}

class GlStageRig final : public StageRig {
 public:
  GlStageRig(const BackendCase& backend_case, const World& world, std::vector<TileCoordinate> active)
      : StageRig(world, std::move(active)),
        shelf_name_(backend_case.name + (backend_case.skip_settled ? "" : " every pair")),
        device_(shelf().take(shelf_name_)) {
    if (device_ == nullptr) device_ = makeDevice(backend_case);
    const CurrentContext current(*device_->context);
    SPOOR_ASSERT(current.ok());
    const auto nobody = [](const std::string&) {};
    pool_ = std::make_unique<TilePool>(device_->limits.storage_block_bytes, 1 << 16, nobody);
    ThreadPool threads(1);
    const ActiveTiles tiles = takeTiles(plan_, world.base, WorldState{}, threads);
    auto slots = pool_->hold(tiles.tiles, plan_.tick, {compacts(), plan_.parameters.materials.size() > 1});
    if (!slots) throw std::runtime_error(slots.error());
    slots_ = std::move(*slots);
    check(device_->stages.load(meshes_));
    begin({});
  }

  ~GlStageRig() override {
    {
      const CurrentContext current(*device_->context);
      pool_.reset();
    }
    shelf().putBack(shelf_name_, std::move(device_));
  }

  Cells overlap() const override { return download(device_->stages.overlap().name(), 0, domainCells()); }
  Cells target() const override { return download(device_->stages.target().name(), 0, domainCells()); }
  int penetratingCount() const override {
    return download(device_->stages.tables(), headOffset(offsetof(rules::TickHead, penetrating_cells)), 1)[0];
  }
  void setTarget(const Cells& cells) override { upload(device_->stages.target().name(), 0, cells); }
  Cells tileHeights() const override { return tilesOf(device_->stages.height()); }
  Cells tileUndersides() const override { return tilesOf(device_->stages.underside()); }
  Cells tileCompacted() const override {
    return compacts() ? tilesOf(device_->stages.compacted()) : Cells(slots_.size() * rules::kTileCells);
  }
  std::int64_t keptBack() const override {
    const Cells words = download(device_->stages.tables(), headOffset(offsetof(rules::TickHead, kept_back_low)), 2);
    return std::int64_t(std::uint64_t(std::uint32_t(words[1])) << 32 | std::uint32_t(words[0]));
  }

  void press(const std::vector<PlacedBody>& bodies) override {
    const Cells heights = tileHeights(), compacted = tileCompacted();
    begin(bodies);
    putHeights(heights);
    putTileCompacted(compacted);
  }

  void penetration() override {
    if (penetrated_)
      restart(tileHeights(), tileUndersides(), tileCompacted());  // the lists of a sub-step are made once
    penetrated_ = true;
    const CurrentContext current(*device_->context);
    device_->stages.penetration(tables_, 0);
  }
  void nearest() override {
    const CurrentContext current(*device_->context);
    device_->stages.nearest(tables_, 0);
  }
  void displace() override {
    const CurrentContext current(*device_->context);
    device_->stages.displace(tables_, 0);
  }
  void relax(int first_sweep, int sweep_count) override {
    const CurrentContext current(*device_->context);
    tables_.sub_steps[0].first_step = first_sweep * rules::kMatchingCount;
    tables_.sub_steps[0].sweep_count = sweep_count;
    device_->stages.relax(tables_, 0);
  }

 private:
  /// A new tick: heights as they were at first, and undersides of these bodies.
  void begin(const std::vector<PlacedBody>& bodies) {
    SubStep sub_step{bodies, {}, 0};
    if (hasDomain()) {
      sub_step.domains.push_back({domainBox(), {}});
      for (std::size_t i = 0; i < bodies.size(); ++i) sub_step.domains[0].bodies.push_back(int(i));
    }
    plan_.sub_steps = {std::move(sub_step)};
    tables_ = makeTickTables(world_.pack, meshes_, plan_, slots_, pool_->highest(), device_->shape);
    const CurrentContext current(*device_->context);
    check(device_->stages.begin(tables_));
    device_->stages.gather(tables_, *pool_);
    device_->stages.depth(tables_, 0);
    penetrated_ = false;
  }

  bool compacts() const { return anyCompression(plan_.parameters); }

  void restart(const Cells& heights, const Cells& undersides, const Cells& compacted) {
    begin({});
    putHeights(heights);
    putTileCompacted(compacted);
    const Cells cells = inDeviceOrder(undersides);
    upload(device_->stages.underside().name(), 0, cells);
    // What ceiling.comp would find.
    std::vector<rules::TileState> states(slots_.size());
    auto slab = cells.begin();
    for (rules::TileState& state : states)
      for (int& ceiling : state.ceiling) {
        ceiling = *std::min_element(slab, slab + rules::kSlabCells);
        slab += rules::kSlabCells;
      }
    upload(device_->stages.tileStates().name(), 0, states);
  }
  void putTileHeights(const Cells& cells) override { restart(cells, tileUndersides(), tileCompacted()); }
  void putTileCompacted(const Cells& cells) override {
    if (compacts()) upload(device_->stages.compacted().name(), 0, inDeviceOrder(cells));
  }
  void putTileUndersides(const Cells& cells) override { restart(tileHeights(), cells, tileCompacted()); }

  void putHeights(const Cells& heights) {
    upload(device_->stages.height().name(), 0, inDeviceOrder(heights));
    upload(device_->stages.tables(), headOffset(offsetof(rules::TickHead, highest)), Cells{std::ranges::max(heights)});
  }

  std::int64_t headOffset(std::size_t member) const { return tables_.head.offset + std::int64_t(member); }
  std::size_t domainCells() const { return std::size_t(tables_.sub_steps[0].domain_cells); }

  Cells download(GLuint buffer, std::int64_t offset, std::size_t count) const {
    const CurrentContext current(*device_->context);
    Cells cells(count);
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glGetNamedBufferSubData(buffer, offset, std::int64_t(count * sizeof(cells[0])), cells.data());
    check(glStatus("looking into a stage"));
    return cells;
  }
  template <typename T>
  void upload(GLuint buffer, std::int64_t offset, const std::vector<T>& data) {
    const CurrentContext current(*device_->context);
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glNamedBufferSubData(buffer, offset, std::int64_t(data.size() * sizeof(T)), data.data());
    check(glStatus("setting up a stage"));
  }

  Cells tilesOf(const GrowingBuffer& plane) const {
    const Cells cells = download(plane.name(), 0, slots_.size() * rules::kTileCells);
    Cells result;
    for (const int tile : tables_.tile_index) {
      const auto first = cells.begin() + std::ptrdiff_t(tile) * rules::kTileCells;
      result.insert(result.end(), first, first + rules::kTileCells);
    }
    return result;
  }
  Cells inDeviceOrder(const Cells& cells) const {
    Cells result(cells.size());
    auto from = cells.begin();
    for (const int tile : tables_.tile_index) {
      std::copy_n(from, rules::kTileCells, result.begin() + std::ptrdiff_t(tile) * rules::kTileCells);
      from += rules::kTileCells;
    }
    return result;
  }

  std::string shelf_name_;
  std::unique_ptr<StageDevice> device_;
  std::unique_ptr<TilePool> pool_;
  MeshTable meshes_ = makeMeshTable(world_.pack);
  std::vector<int> slots_;
  TickTables tables_;
  bool penetrated_ = false;
};

}  // namespace

std::unique_ptr<StageRig> makeGlStageRig(const BackendCase& backend_case, const World& world,
                                         std::vector<TileCoordinate> active) {
  return std::make_unique<GlStageRig>(backend_case, world, std::move(active));
}

}  // namespace spoor::test
