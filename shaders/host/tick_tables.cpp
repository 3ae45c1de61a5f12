#include "shaders/host/tick_tables.h"

#include <algorithm>
#include <cstring>

#include "shaders/rules/crater.h"
#include "shaders/rules/exchange.h"
#include "shared/base/assert.h"

namespace spoor {
namespace {

constexpr int kSize = rules::kTileSize;

// As GLSL's std430 lays them out: ints, one after the other.
static_assert(sizeof(rules::TileEntry) == 56 && sizeof(rules::TileState) == 64 && sizeof(rules::Block) == 12);
static_assert(sizeof(rules::RowChunk) == 12 && sizeof(rules::BodyEntry) == 108 && sizeof(rules::DomainEntry) == 44);
static_assert(sizeof(rules::TileResult) == 56 && sizeof(rules::GroupCount) == 16 && sizeof(rules::RoundLists) == 64);
static_assert(sizeof(rules::TickHead) == 40 && sizeof(rules::CraterTile) == 40);
static_assert(sizeof(rules::SnowTile) == 20 && sizeof(rules::SnowLayer) == 36 && sizeof(rules::Push) == 24);
static_assert(sizeof(rules::MaterialEntry) == 32 && rules::kMaterialsMost == kMaterialsLimit);

/// Collects tables as bytes.
class TableWriter {
 public:
  explicit TableWriter(std::vector<std::uint8_t>& bytes) : bytes_(&bytes) {}

  template <typename T>
  TableRange put(const std::vector<T>& table) {
    constexpr std::size_t kAlignment = 256;  // the largest that GL may ask for
    bytes_->resize((bytes_->size() + kAlignment - 1) / kAlignment * kAlignment);
    const TableRange range{std::int64_t(bytes_->size()),
                           std::int64_t(std::max<std::size_t>(table.size(), 1) * sizeof(T))};
    bytes_->resize(bytes_->size() + std::size_t(range.bytes));
    if (!table.empty()) std::memcpy(bytes_->data() + range.offset, table.data(), table.size() * sizeof(T));
    return range;
  }

  GroupList dispatch(std::int64_t groups, const GroupShape& shape) {
    const int x = int(std::min<std::int64_t>(groups, shape.groups_per_row));
    const rules::GroupCount size{x, x == 0 ? 0 : int((groups + x - 1) / x), 1, int(groups)};
    return {int(groups), put(std::vector<rules::GroupCount>{size}).offset, {}};
  }

  GroupList dispatch(std::vector<rules::Block>& blocks, const GroupShape& shape) {
    if (shape.reversed) std::ranges::reverse(blocks);
    GroupList list = dispatch(std::int64_t(blocks.size()), shape);
    list.blocks = put(blocks);
    return list;
  }

 private:
  std::vector<std::uint8_t>* bytes_;
};

int groupsFor(std::int64_t count, int group) { return int((count + group - 1) / group); }

/// A tick's tables in the making.
class TableMaker {
 public:
  TableMaker(const ScenePack& pack, const MeshTable& meshes, const TickPlan& plan, const GroupShape& shape)
      : pack_(pack),
        meshes_(meshes),
        plan_(plan),
        shape_(shape),
        writer_(tables_.bytes),
        count_(int(plan.active.size())) {}

  TickTables make(std::span<const int> slots, const TileEvents& events) {
    for (int i = 0; i < count_; ++i) tables_.tile_index.push_back(shape_.reversed ? count_ - 1 - i : i);
    putTiles(slots);
    putMaterials();
    putSnow(slots, events);
    putCraters(slots, events.cratered);
    const std::int64_t tiles = count_;
    tables_.gather = writer_.dispatch(tiles * (rules::kTileCells / 4 / rules::kGatherQuads / shape_.group), shape_);
    tables_.exchange = writer_.dispatch(groupsFor(tiles * kSize / 4, shape_.group), shape_);
    tables_.sweep = writer_.dispatch(tiles * rules::kBlocksPerSide * rules::kBlocksPerSide, shape_);
    tables_.slope = writer_.dispatch(tiles * rules::kTileCells / rules::kSlabRows / shape_.group, shape_);
    tables_.hash = writer_.dispatch(tiles, shape_);
    int sweep = 0;
    covered_before_.assign(std::size_t(count_), 0);
    if (!plan_.stood.bodies.empty()) {
      tables_.stood = subStepTables(plan_.stood, sweep);
      border_covered_ = true;
    }
    for (const SubStep& sub_step : plan_.sub_steps) {
      tables_.sub_steps.push_back(subStepTables(sub_step, sweep));
      sweep += sub_step.sweep_count;
    }
    putHead();
    tables_.tick = plan_.tick;
    tables_.parameters = plan_.parameters;
    return std::move(tables_);
  }

 private:
  /// The shaders' index of a tile, or -1 where it is not active.
  int indexOf(TileCoordinate at) const {
    const auto found = std::ranges::lower_bound(plan_.active, at);
    if (found == plan_.active.end() || *found != at) return -1;
    return tables_.tile_index[std::size_t(found - plan_.active.begin())];
  }

  void putTiles(std::span<const int> slots) {
    entries_.resize(std::size_t(count_));
    for (int i = 0; i < count_; ++i) {
      const TileCoordinate at = plan_.active[std::size_t(i)];
      rules::TileEntry& entry = entries_[std::size_t(tables_.tile_index[std::size_t(i)])];
      entry.slot = slots[std::size_t(i)];
      entry.x0 = at.x * kSize;
      entry.y0 = at.y * kSize;
      entry.inside_columns = std::min(pack_.width_cells - entry.x0, kSize);
      entry.inside_rows = std::min(pack_.height_cells - entry.y0, kSize);
      for (int bit = 0; bit < 9; ++bit) entry.neighbour[bit] = indexOf({at.x + bit % 3 - 1, at.y + bit / 3 - 1});
    }
    tables_.tiles = writer_.put(entries_);
  }

  void putMaterials() {
    const DriftSweep drift = driftSweep(pack_, plan_.parameters);
    tables_.drift = drift.step;
    tables_.mixed = plan_.parameters.materials.size() > 1;
    std::vector<rules::MaterialEntry> entries(rules::kMaterialsMost);
    for (std::size_t i = 0; i < plan_.parameters.materials.size(); ++i) {
      const MaterialRules& own = plan_.parameters.materials[i];
      rules::MaterialEntry& entry = entries[i];
      entry = {own.slope_threshold_q,
               own.diagonal_threshold_q,
               own.roughness_q16,
               own.compression_q16,
               own.compaction_limit_q16,
               own.friction_inverse_q32,
               0,
               0};
      if (plan_.parameters.slopes == SlopeRule::exchange) {
        entry.slope_threshold = rules::exchangeThreshold(own.slope_threshold_q);
        entry.diagonal_threshold = rules::exchangeThreshold(own.diagonal_threshold_q);
      } else if (plan_.parameters.slopes == SlopeRule::drift) {
        entry.slope_threshold = drift.materials[i].rest;
        entry.diagonal_threshold = std::int32_t(drift.materials[i].inverse);
        entry.roughness = drift.materials[i].rate;
      }
    }
    tables_.materials = writer_.put(entries);
  }

  void putSnow(std::span<const int> slots, const TileEvents& events) {
    std::vector<rules::SnowTile> tiles;
    std::vector<rules::SnowLayer> layers;
    for (std::size_t i = 0; i < events.snowed.size(); ++i) {
      if (events.snowed[i] == 0) continue;
      const TileCoordinate at = plan_.active[i];
      rules::SnowTile& tile = tiles.emplace_back(slots[i], at.x * kSize, at.y * kSize, int(layers.size()), 0);
      for (const Snowfall& snowfall : events.snowfalls) {
        if (!snowfall.area.meets(cellsOf(at))) continue;
        const rules::SnowDepth before = snowDepth(snowfall, at, plan_.tick - rules::kSnowBeat);
        const rules::SnowDepth after = snowDepth(snowfall, at, plan_.tick);
        layers.push_back({snowfall.area.x0, snowfall.area.y0, snowfall.area.x1, snowfall.area.y1, snowfall.seed,
                          before.layers, before.share, after.layers, after.share});
      }
      tile.end_layer = int(layers.size());
    }
    if (tiles.empty()) return;
    tables_.snow.tiles = writer_.put(tiles);
    tables_.snow.layers = writer_.put(layers);
    tables_.snow.groups = writer_.dispatch(
        std::int64_t(tiles.size()) * (rules::kTileCells / rules::kSnowLaneCells / shape_.group), shape_);
  }

  void putCraters(std::span<const int> slots, std::span<const CellBox> cratered) {
    CraterTables& craters = tables_.craters;
    for (std::size_t i = 0; i < cratered.size(); ++i) {
      const CellBox& box = cratered[i];
      if (box.empty()) continue;
      const TileCoordinate at = plan_.active[i];
      craters.tiles.push_back(
          {slots[i], at.x * kSize, at.y * kSize, box.x0, box.y0, box.x1, box.y1, int(craters.cells), {}});
      craters.active.push_back(int(i));
      craters.cells += std::int64_t(box.x1 - box.x0) * (box.y1 - box.y0);
    }
    if (craters.tiles.empty()) return;
    craters.range = writer_.put(craters.tiles);
    const int groups_per_tile = rules::kTileCells / rules::kCraterLaneCells / shape_.group;
    craters.groups = writer_.dispatch(std::int64_t(craters.tiles.size()) * groups_per_tile, shape_);
  }

  SubStepTables subStepTables(const SubStep& sub_step, int first_sweep) {
    SubStepTables step;
    step.first_step = first_sweep * rules::kMatchingCount;
    step.sweep_count = sub_step.sweep_count;
    putDomains(sub_step, step);
    putBodies(sub_step, step);
    putPushes(sub_step, step);
    return step;
  }

  void putDomains(const SubStep& sub_step, SubStepTables& step) {
    std::vector<rules::DomainEntry> domains;
    std::vector<std::int32_t> domain_tiles;
    std::vector<rules::Block> blocks;
    std::vector<std::uint8_t> covered(std::size_t(count_), 0);
    domain_of_body_.assign(sub_step.bodies.size(), -1);
    const bool searched = &sub_step != &plan_.stood;
    for (const Domain& domain : sub_step.domains) {
      const CellBox& box = domain.box;
      const int index = int(domains.size());
      rules::DomainEntry entry{};
      entry.x0 = box.x0;
      entry.y0 = box.y0;
      entry.width = box.x1 - box.x0;
      entry.rows = box.y1 - box.y0;
      entry.first_cell = int(step.domain_cells);
      entry.first_word = int(step.mask_words);
      entry.first_row = row_count_;
      entry.first_tile = int(domain_tiles.size());
      entry.tile_x0 = box.x0 / kSize;
      entry.tile_y0 = box.y0 / kSize;
      entry.tile_columns = (box.x1 - 1) / kSize - entry.tile_x0 + 1;
      domains.push_back(entry);
      for (int y = entry.tile_y0; y <= (box.y1 - 1) / kSize; ++y)
        for (int x = entry.tile_x0; x < entry.tile_x0 + entry.tile_columns; ++x) {
          const int tile = indexOf({x, y});
          SPOOR_ASSERT(tile >= 0);
          domain_tiles.push_back(tile);
          covered[std::size_t(tile)] = 1;
        }
      for (const int body : domain.bodies) domain_of_body_[std::size_t(body)] = index;
      if (!searched) continue;
      for (int y = 0; y < entry.rows; y += rules::kMaskRows)
        for (int x = 0; x < groupsFor(entry.width, shape_.group); ++x) blocks.push_back({index, x, y});
      step.domain_cells += std::int64_t(entry.width) * entry.rows;
      step.mask_words += std::int64_t(entry.width) * groupsFor(entry.rows, rules::kMaskRows);
      step.row_chunks += std::int64_t(entry.rows) * groupsFor(entry.width, shape_.group);
      step.longest_side = std::max({step.longest_side, entry.width, entry.rows});
      row_count_ += entry.rows;
    }
    step.domains = writer_.put(domains);
    step.domain_tiles = writer_.put(domain_tiles);
    step.domain_blocks = writer_.dispatch(blocks, shape_);
    putCovered(covered, step);
  }

  /// Tiles whose undersides this sub-step begins anew: all that it or the one before covers, and at first the border's.
  void putCovered(const std::vector<std::uint8_t>& covered, SubStepTables& step) {
    std::vector<rules::Block> blocks;
    for (std::size_t tile = 0; tile < covered.size(); ++tile) {
      const bool border = entries_[tile].inside_columns < kSize || entries_[tile].inside_rows < kSize;
      if (covered[tile] == 0 && covered_before_[tile] == 0 &&
          !(border && !border_covered_ && tables_.sub_steps.empty()))
        continue;
      for (int slab = 0; slab < rules::kSlabs; ++slab) blocks.push_back({int(tile), slab, 0});
    }
    step.cover = writer_.dispatch(blocks, shape_);
    covered_before_ = covered;
  }

  void putBodies(const SubStep& sub_step, SubStepTables& step) {
    std::vector<rules::BodyEntry> bodies;
    std::vector<rules::Block> place, primitives;
    entry_of_body_.clear();
    for (std::size_t i = 0; i < sub_step.bodies.size(); ++i) {
      entry_of_body_.push_back(-1);
      if (domain_of_body_[i] < 0) continue;
      const int index = entry_of_body_.back() = int(bodies.size());
      const rules::BodyEntry& entry =
          bodies.emplace_back(bodyEntry(sub_step.bodies[i], domain_of_body_[i], int(step.point_count)));
      for (int first = 0; first < entry.vertex_count; first += shape_.group) place.push_back({index, first, 0});
      const int primitive_count = entry.triangle_count + entry.edge_count;
      for (int first = 0; first < primitive_count; first += shape_.group) primitives.push_back({index, first, 0});
      step.point_count += entry.vertex_count;
      step.primitive_count += primitive_count;
    }
    step.bodies = writer_.put(bodies);
    step.place = writer_.dispatch(place, shape_);
    step.primitives = writer_.dispatch(primitives, shape_);
  }

  void putPushes(const SubStep& sub_step, SubStepTables& step) {
    if (!anyPush(sub_step, plan_.parameters)) return;
    std::vector<rules::Push> pushes;
    std::vector<rules::Block> blocks;
    for (std::size_t i = 0; i < sub_step.bodies.size(); ++i) {
      const PlacedBody& body = sub_step.bodies[i];
      if (entry_of_body_[i] < 0 || body.force_cell == 0) continue;
      const int index = int(pushes.size());
      pushes.push_back({entry_of_body_[i], rules::uint(body.force_cell), rules::uint(body.force_cell >> 32),
                        body.direction_x_q30, body.direction_y_q30, 0});
      for (int y = 0; y < body.box.y1 - body.box.y0; y += rules::kMaskRows)
        for (int x = 0; x < groupsFor(body.box.x1 - body.box.x0, shape_.group); ++x) blocks.push_back({index, x, y});
    }
    step.pushes = writer_.put(pushes);
    step.push_blocks = writer_.dispatch(blocks, shape_);
    step.push_limit = pushLimit(sub_step);
  }

  rules::BodyEntry bodyEntry(const PlacedBody& body, int domain, int first_point) const {
    const auto mesh_index = std::size_t(pack_.bodies[std::size_t(body.body_index)].mesh_index);
    const Mesh& mesh = pack_.meshes[mesh_index];
    const MeshTable::Place& place = meshes_.places[mesh_index];
    rules::BodyEntry entry{};
    std::ranges::copy(body.placement.matrix, entry.matrix);
    entry.within_x = body.placement.within_x;
    entry.within_y = body.placement.within_y;
    entry.cell = body.placement.cell;
    entry.origin_x = body.origin_x;
    entry.origin_y = body.origin_y;
    entry.z = body.z_q;
    entry.x0 = body.box.x0;
    entry.y0 = body.box.y0;
    entry.x1 = body.box.x1;
    entry.y1 = body.box.y1;
    entry.domain = domain;
    entry.first_vertex = place.first_vertex;
    entry.vertex_count = int(mesh.vertices.size());
    entry.first_point = first_point;
    entry.first_triangle = place.first_triangle;
    entry.triangle_count = int(mesh.triangles.size());
    entry.first_edge = place.first_edge;
    entry.edge_count = int(mesh.edges.size());
    return entry;
  }

  /// A dispatch of so many groups, which are none until a shader finds that there is work for them.
  rules::GroupCount waiting(int groups) const {
    const int x = std::clamp(groups, 1, shape_.groups_per_row);
    return {x, 0, 1, (groups + x - 1) / x};
  }

  /// The head comes last: it ends in the lists of all sub-steps' rounds.
  void putHead() {
    tables_.row_flags = writer_.put(std::vector<std::int32_t>(std::size_t(row_count_)));
    rules::TickHead head{};
    head.tile_count = count_;
    head.obstacle_threshold = plan_.parameters.obstacle_threshold_q;
    head.penetration_divider = plan_.parameters.penetration_divider_q;
    head.spread_cells = plan_.parameters.spread_cells;
    head.highest = -rules::kHeightLimit;
    const rules::GroupCount empty{rules::kDispatchColumns, 0, 1, 0};
    std::vector<rules::RoundLists> lists;
    tables_.stood.first_list = 0;
    lists.push_back({empty, empty, empty, waiting(0)});
    for (SubStepTables& step : tables_.sub_steps) {
      step.first_list = int(lists.size());
      for (int round = 0; round < plan_.parameters.capacity_rounds; ++round)
        lists.push_back({empty, empty, empty, waiting(step.domain_blocks.count)});
    }
    std::vector<std::uint8_t> bytes(sizeof(head) + std::max<std::size_t>(lists.size(), 1) * sizeof(rules::RoundLists));
    std::memcpy(bytes.data(), &head, sizeof(head));
    std::memcpy(bytes.data() + sizeof(head), lists.data(), lists.size() * sizeof(rules::RoundLists));
    tables_.head = writer_.put(bytes);
  }

  const ScenePack& pack_;
  const MeshTable& meshes_;
  const TickPlan& plan_;
  GroupShape shape_;
  TickTables tables_;
  TableWriter writer_;
  int count_;
  int row_count_ = 0;
  bool border_covered_ = false;
  std::vector<rules::TileEntry> entries_;
  std::vector<std::uint8_t> covered_before_;
  std::vector<int> domain_of_body_, entry_of_body_;  // of the sub-step; -1: none
};

}  // namespace

MeshTable makeMeshTable(const ScenePack& pack) {
  MeshTable table;
  for (const Mesh& mesh : pack.meshes) {
    table.places.push_back({int(table.vertices.size() / 3), int(table.indices.size()), 0});
    for (const auto& vertex : mesh.vertices) table.vertices.insert(table.vertices.end(), vertex.begin(), vertex.end());
    for (const auto& triangle : mesh.triangles)
      for (const std::uint32_t index : triangle) table.indices.push_back(std::int32_t(index));
  }
  for (std::size_t i = 0; i < pack.meshes.size(); ++i) {
    table.places[i].first_edge = int(table.indices.size());
    for (const auto& edge : pack.meshes[i].edges)
      for (const std::uint32_t index : edge) table.indices.push_back(std::int32_t(index));
  }
  return table;
}

TickTables makeTickTables(const ScenePack& pack, const MeshTable& meshes, const TickPlan& plan,
                          std::span<const int> slots, std::int32_t highest, const GroupShape& shape,
                          const TileEvents& events) {
  TickTables tables = TableMaker(pack, meshes, plan, shape).make(slots, events);
  // No crater lifts a cell by more: rim, depth and noise as large as both.
  constexpr std::int32_t kRaiseMost = 3 * rules::kCraterHeightLimit;
  std::int64_t raised = tables.craters.tiles.empty() ? 0 : kRaiseMost;
  if (tables.snow.groups.count > 0) raised += kSnowfallsLimit * ((kSnowRateLimit >> 32) * rules::kSnowBeat + 1);
  highest = std::int32_t(std::min<std::int64_t>(highest + raised, rules::kHeightLimit));
  tables.beneath = highest + plan.parameters.obstacle_threshold_q >= rules::kNoUnderside;
  for (const SubStepTables& step : tables.sub_steps) tables.beneath |= step.cover.count > 0;
  return tables;
}

}  // namespace spoor
