#include "shaders/host/gl_stages.h"

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <utility>

#include "shaders/host/gl_context.h"

namespace spoor {
namespace {

constexpr int kCellBytes = sizeof(std::int32_t);
}  // namespace

/// Where the arguments of a list that the GPU makes lie; `member` is its offset in RoundLists.
std::int64_t GlStages::listOffset(const TickTables& tick, int list, std::size_t member) {
  return tick.head.offset +
         std::int64_t(sizeof(rules::TickHead) + std::size_t(list) * sizeof(rules::RoundLists) + member);
}

GlStages::GlStages(const GlLimits& limits, const GroupShape& shape, RelaxSchedule schedule, bool skip_settled)
    : schedule_(schedule),
      skip_settled_(skip_settled),
      programs_(shape.group, schedule),
      chosen_(programs_.choose(Parameters{})),
      upload_("a tick's tables", limits.storage_block_bytes),
      vertices_("the meshes' vertices", limits.storage_block_bytes),
      indices_("the meshes' triangles and edges", limits.storage_block_bytes),
      points_("the bodies' points", limits.storage_block_bytes),
      large_("the list of large primitives", limits.storage_block_bytes),
      height_{{"the active tiles' heights", limits.storage_block_bytes},
              {"the active tiles' next heights", limits.storage_block_bytes},
              {"the active tiles' spare heights", limits.storage_block_bytes}},
      bedrock_("the active tiles' bedrock", limits.storage_block_bytes),
      underside_("the active tiles' undersides", limits.storage_block_bytes),
      underside_before_("the active tiles' earlier undersides", limits.storage_block_bytes),
      compacted_("the active tiles' compacted soil", limits.storage_block_bytes),
      material_("the active tiles' materials", limits.storage_block_bytes),
      push_x_("the active tiles' pushes", limits.storage_block_bytes),
      push_y_("the active tiles' pushes", limits.storage_block_bytes),
      tile_states_("the active tiles' states", limits.storage_block_bytes),
      overlap_("the domains' overlap", limits.storage_block_bytes),
      free_mask_("the domains' free cells", limits.storage_block_bytes),
      nearest_row_("the domains' nearest rows", limits.storage_block_bytes),
      target_("the domains' targets", limits.storage_block_bytes),
      row_chunks_("the list of penetrating rows", limits.storage_block_bytes),
      receivers_("the list of receiving rows", limits.storage_block_bytes),
      requested_low_("the domains' requests", limits.storage_block_bytes, GrowingBuffer::Content::zeroed),
      requested_high_("the domains' requests", limits.storage_block_bytes, GrowingBuffer::Content::zeroed),
      granted_("the domains' grants", limits.storage_block_bytes, GrowingBuffer::Content::zeroed),
      flood_("the domains' flooding", limits.storage_block_bytes),
      carried_{{"the domains' moving soil", limits.storage_block_bytes},
               {"the domains' moving soil", limits.storage_block_bytes}},
      offered_("the domains' offers", limits.storage_block_bytes),
      room_("the domains' room", limits.storage_block_bytes),
      amounts_("the active tiles' amounts", limits.storage_block_bytes),
      results_("the tiles' results", limits.storage_block_bytes),
      staging_("the changed cells", limits.storage_block_bytes),
      crater_changes_("what craters change", limits.storage_block_bytes),
      crater_sums_("the sums of craters", limits.storage_block_bytes) {}

Status GlStages::load(const MeshTable& meshes, bool with_craters, bool with_snow) {
  if (with_craters)
    if (auto program = compiled(&GlPrograms::craters); !program) return Error{program.error()};
  if (with_snow)
    if (auto program = compiled(&GlPrograms::snow); !program) return Error{program.error()};
  const auto copy = [](GrowingBuffer& to, const std::vector<std::int32_t>& table) -> Status {
    if (Status status = to.reserve(std::int64_t(table.size()) * kCellBytes); !status) return status;
    if (!table.empty()) glNamedBufferSubData(to.name(), 0, std::int64_t(table.size()) * kCellBytes, table.data());
    return {};
  };
  if (Status status = copy(vertices_, meshes.vertices); !status) return status;
  return copy(indices_, meshes.indices);
}

Status GlStages::begin(const TickTables& tick) {
  current_ = 0;
  domain_bytes_ = 0;
  try {
    chosen_ = programs_.choose(tick.parameters);
  } catch (const std::runtime_error& error) {
    return Error{error.what()};
  }
  if (Status status = reserve(tick); !status) return status;
  glNamedBufferSubData(upload_.name(), 0, std::int64_t(tick.bytes.size()), tick.bytes.data());
  glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, upload_.name());
  return glStatus("copying a tick's tables");
}

Status GlStages::reserve(const TickTables& tick) {
  const std::int64_t tiles = std::int64_t(tick.tile_index.size());
  SubStepTables largest = tick.stood;
  for (const SubStepTables& step : tick.sub_steps) {
    largest.point_count = std::max(largest.point_count, step.point_count);
    largest.primitive_count = std::max(largest.primitive_count, step.primitive_count);
    largest.domain_cells = std::max(largest.domain_cells, step.domain_cells);
    largest.mask_words = std::max(largest.mask_words, step.mask_words);
    largest.row_chunks = std::max(largest.row_chunks, step.row_chunks);
    largest.push_blocks.count = std::max(largest.push_blocks.count, step.push_blocks.count);
  }
  const SlopeRule slopes = tick.parameters.slopes;
  const bool iterative = tick.parameters.displacement == Displacement::iterative;
  const bool flooded = tick.parameters.nearest != NearestSearch::exact;
  const bool compacts = anyCompression(tick.parameters);
  const bool in_turns = slopes != SlopeRule::exchange || schedule_ == RelaxSchedule::fused;
  const std::int64_t plane_bytes = tiles * rules::kTileCells * kCellBytes;
  const std::int64_t domain_bytes = largest.domain_cells * kCellBytes;
  const std::pair<GrowingBuffer*, std::int64_t> needs[] = {
      {&upload_, std::int64_t(tick.bytes.size())},
      {&points_, largest.point_count * std::int64_t(sizeof(rules::RasterPoint))},
      {&large_, largest.primitive_count * 2 * kCellBytes},
      {&height_[0], plane_bytes},
      {&height_[1], in_turns ? plane_bytes : 0},
      {&height_[2], slopes == SlopeRule::scatter ? plane_bytes : 0},
      {&amounts_, slopes == SlopeRule::interleaved ? plane_bytes : 0},
      {&bedrock_, plane_bytes},
      {&underside_, plane_bytes},
      {&underside_before_, plane_bytes},
      {&compacted_, compacts ? plane_bytes : 0},
      {&material_, tick.mixed ? plane_bytes / 4 : 0},
      {&push_x_, largest.push_blocks.count > 0 ? plane_bytes : 0},
      {&push_y_, largest.push_blocks.count > 0 ? plane_bytes : 0},
      {&tile_states_, tiles * std::int64_t(sizeof(rules::TileState))},
      {&overlap_, domain_bytes},
      {&free_mask_, largest.mask_words * kCellBytes},
      {&nearest_row_, domain_bytes},
      {&target_, domain_bytes},
      {&flood_, flooded ? domain_bytes : 0},
      {&row_chunks_, largest.row_chunks * std::int64_t(sizeof(rules::RowChunk))},
      {&receivers_, iterative ? 0 : largest.row_chunks * std::int64_t(sizeof(rules::RowChunk))},
      {&requested_low_, iterative ? 0 : domain_bytes},
      {&requested_high_, iterative ? 0 : domain_bytes},
      {&granted_, iterative ? 0 : domain_bytes},
      {&carried_[0], iterative ? domain_bytes : 0},
      {&carried_[1], iterative ? domain_bytes : 0},
      {&offered_, iterative ? domain_bytes : 0},
      {&room_, iterative ? domain_bytes : 0},
      {&results_, tiles * std::int64_t(sizeof(rules::TileResult))},
      {&staging_, plane_bytes * (compacts ? 2 : 1)},
  };
  for (const auto& [buffer, bytes] : needs)
    if (Status status = buffer->reserve(bytes); !status) return status;
  return {};
}

void GlStages::use(const GlProgram& program, int list) {
  glUseProgram(program.name());
  setUniform(1, list);
}

void GlStages::bindTable(int binding, const TableRange& range) const {
  glBindBufferRange(GL_SHADER_STORAGE_BUFFER, GLuint(binding), upload_.name(), range.offset, range.bytes);
}

void GlStages::dispatch(const GroupList& list) {
  if (list.count == 0) return;
  setUniform(0, list.count);
  if (list.blocks.bytes > 0) bindTable(rules::kBindBlocks, list.blocks);
  glDispatchComputeIndirect(list.arguments);
  // Every stage reads what the one before wrote: planes and tables, and dispatch sizes in the tables.
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_COMMAND_BARRIER_BIT);
  ++dispatch_count_;
}

void GlStages::dispatchListed(std::int64_t arguments) {
  glDispatchComputeIndirect(arguments);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_COMMAND_BARRIER_BIT);  // as above
  ++dispatch_count_;
}

void GlStages::bindCells(const TickTables& tick) const {
  bindTable(rules::kBindTick, tick.head);
  bindTable(rules::kBindTiles, tick.tiles);
  tile_states_.bind(rules::kBindTileStates);
  height_[current_].bind(rules::kBindHeight);
  bedrock_.bind(rules::kBindBedrock);
  underside_.bind(rules::kBindUnderside);
}

void GlStages::bindMaterials(const TickTables& tick, int binding) const {
  glBindBufferRange(GL_UNIFORM_BUFFER, rules::kBindMaterials, upload_.name(), tick.materials.offset,
                    tick.materials.bytes);
  if (tick.mixed) material_.bind(binding);
}

void GlStages::gather(const TickTables& tick, const TilePool& pool) {
  bindCells(tick);
  pool.height().bind(rules::kBindPoolHeight);
  pool.bedrock().bind(rules::kBindPoolBedrock);
  if (anyCompression(tick.parameters)) {
    compacted_.bind(rules::kBindCompacted);
    pool.compacted().bind(rules::kBindPoolCompacted);
  }
  if (tick.mixed) {
    material_.bind(rules::kBindMaterial);
    pool.material().bind(rules::kBindPoolMaterial);
  }
  use(*chosen_.gather);
  dispatch(tick.gather);
}

void GlStages::depth(const TickTables& tick, int i) {
  const SubStepTables& step = i == kStood ? tick.stood : tick.sub_steps[std::size_t(i)];
  beginUndersides(tick, step);
  if (step.primitives.count > 0) drawBodies(tick, i);
  findCeilings(tick, step);
}

/// Keeps the undersides of a sub-step's tiles aside and takes them away, but for the world's border.
void GlStages::beginUndersides(const TickTables& tick, const SubStepTables& step) {
  bindCells(tick);
  underside_before_.bind(rules::kBindUndersideBefore);
  use(*chosen_.cover);
  setUniform(2, step.first_step);
  dispatch(step.cover);
}

void GlStages::findCeilings(const TickTables& tick, const SubStepTables& step) {
  use(*chosen_.ceiling);
  setUniform(2, step.first_step);
  setUniform(3, tick.parameters.frustum_height_q);
  dispatch(step.cover);
}

void GlStages::drawBodies(const TickTables& tick, int i) {
  const SubStepTables& step = i == kStood ? tick.stood : tick.sub_steps[std::size_t(i)];
  bindTable(rules::kBindBodies, step.bodies);
  bindTable(rules::kBindDomains, step.domains);
  bindTable(rules::kBindDomainTiles, step.domain_tiles);
  vertices_.bind(rules::kBindVertices);
  indices_.bind(rules::kBindIndices);
  points_.bind(rules::kBindPoints);
  large_.bind(rules::kBindLarge);
  use(*chosen_.place);
  dispatch(step.place);
  use(*chosen_.depth, step.first_list);
  dispatch(step.primitives);
  use(*chosen_.depth_large, step.first_list);
  dispatchListed(listOffset(tick, step.first_list, offsetof(rules::RoundLists, large)));
}

void GlStages::hash(const TickTables& tick, const TilePool& pool) {
  bindCells(tick);
  pool.height().bind(rules::kBindPoolHeight);
  results_.bind(rules::kBindResults);
  staging_.bind(rules::kBindStaging);
  if (anyCompression(tick.parameters)) {
    compacted_.bind(rules::kBindCompacted);
    pool.compacted().bind(rules::kBindPoolCompacted);
  }
  use(*chosen_.hash);
  dispatch(tick.hash);
}

std::vector<BufferBytes> GlStages::buffers() const {
  const auto bytes = [](const auto&... buffers) { return (... + buffers.bytes()); };
  return {{"heights", bytes(height_[0])},
          {"heights after a sweep (2)", bytes(height_[1], height_[2])},
          {"amounts that slopes give", bytes(amounts_)},
          {"bedrock", bytes(bedrock_)},
          {"undersides (2)", bytes(underside_, underside_before_)},
          {"compacted soil", bytes(compacted_)},
          {"materials", bytes(material_)},
          {"pushes (2)", bytes(push_x_, push_y_)},
          {"states of tiles", bytes(tile_states_)},
          {"overlap, in domains", bytes(overlap_, free_mask_)},
          {"exact search, in domains", bytes(nearest_row_)},
          {"jump flooding, in domains", bytes(flood_)},
          {"targets, in domains", bytes(target_, row_chunks_, receivers_)},
          {"requests and grants, in domains", bytes(requested_low_, requested_high_, granted_)},
          {"iterative displacement, in domains", bytes(carried_[0], carried_[1], offered_, room_)},
          {"results and changed cells", bytes(results_, staging_)},
          {"what craters change", bytes(crater_changes_, crater_sums_)},
          {"meshes, bodies and tables", bytes(upload_, vertices_, indices_, points_, large_)}};
}

}  // namespace spoor
