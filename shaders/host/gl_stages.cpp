#include "shaders/host/gl_stages.h"

#include <algorithm>
#include <cstddef>

#include "shaders/host/gl_context.h"
#include "shaders/host/shader_loader.h"
#include "shaders/rules/exchange.h"

namespace spoor {
namespace {

constexpr int kCellBytes = sizeof(std::int32_t);
// Lanes of a fused sweep, for each lane of the other stages: its groups have 1024 cells and their halo to work on.
constexpr int kSweepLanes = 4;

GlProgram program(const std::string& name, int group, std::vector<std::pair<std::string, std::string>> defines = {}) {
  defines.emplace_back("SPOOR_GROUP", std::to_string(group));
  return makeProgram({"sim/" + name + ".comp"}, defines);
}

GlProgram exchangeProgram(int matching, int beneath, int group) {
  const int shift = matching < rules::kMatchDiagonal ? 0 : matching < rules::kMatchAntidiagonal ? 1 : -1;
  return program(matching < rules::kMatchVertical ? "exchange_along" : "exchange_across", group,
                 {{"SPOOR_PARITY", std::to_string(matching & 1)},
                  {"SPOOR_SHIFT", std::to_string(shift)},
                  {"SPOOR_BENEATH", std::to_string(beneath)}});
}

void setUniform(int location, int value) { glUniform1i(location, value); }

/// Where the arguments of a list that the GPU makes lie; `list` is its offset in SubStepLists.
std::int64_t listOffset(const TickTables& tick, int sub_step, std::size_t list) {
  return tick.head.offset +
         std::int64_t(offsetof(rules::TickHead, lists) + sub_step * sizeof(rules::SubStepLists) + list);
}

}  // namespace

GlStages::GlStages(const GlLimits& limits, const GroupShape& shape, RelaxSchedule schedule, bool skip_settled)
    : schedule_(schedule),
      skip_settled_(skip_settled),
      gather_(program("gather", shape.group)),
      cover_(program("cover", shape.group)),
      ceiling_(program("ceiling", shape.group)),
      place_(program("place", shape.group)),
      depth_(program("depth", shape.group)),
      depth_large_(program("depth_large", shape.group)),
      penetration_(program("penetration", shape.group)),
      nearest_columns_(program("nearest_columns", shape.group)),
      nearest_search_(program("nearest_search", shape.group)),
      displace_request_(program("displace_request", shape.group)),
      displace_take_(program("displace_take", shape.group)),
      displace_give_(program("displace_give", shape.group)),
      hash_(program("hash", shape.group)),
      upload_("a tick's tables", limits.storage_block_bytes),
      vertices_("the meshes' vertices", limits.storage_block_bytes),
      indices_("the meshes' triangles and edges", limits.storage_block_bytes),
      points_("the bodies' points", limits.storage_block_bytes),
      large_("the list of large primitives", limits.storage_block_bytes),
      height_{{"the active tiles' heights", limits.storage_block_bytes},
              {"the active tiles' next heights", limits.storage_block_bytes}},
      bedrock_("the active tiles' bedrock", limits.storage_block_bytes),
      underside_("the active tiles' undersides", limits.storage_block_bytes),
      underside_before_("the active tiles' earlier undersides", limits.storage_block_bytes),
      tile_states_("the active tiles' states", limits.storage_block_bytes),
      overlap_("the domains' overlap", limits.storage_block_bytes),
      free_mask_("the domains' free cells", limits.storage_block_bytes),
      nearest_row_("the domains' nearest rows", limits.storage_block_bytes),
      target_("the domains' targets", limits.storage_block_bytes),
      row_chunks_("the list of penetrating rows", limits.storage_block_bytes),
      receivers_("the list of receiving rows", limits.storage_block_bytes),
      requested_low_("the domains' requests", limits.storage_block_bytes, GrowingBuffer::Content::zeroed),
      requested_high_("the domains' requests", limits.storage_block_bytes, GrowingBuffer::Content::zeroed),
      granted_low_("the domains' grants", limits.storage_block_bytes, GrowingBuffer::Content::zeroed),
      granted_high_("the domains' grants", limits.storage_block_bytes, GrowingBuffer::Content::zeroed),
      results_("the tiles' results", limits.storage_block_bytes),
      staging_("the changed cells", limits.storage_block_bytes) {
  if (schedule == RelaxSchedule::fused) {
    sweep_ = program("sweep", kSweepLanes * shape.group);
    return;
  }
  for (int matching = 0; matching < rules::kMatchingCount; ++matching)
    for (int beneath = 0; beneath < 2; ++beneath)
      exchange_[std::size_t(matching)][std::size_t(beneath)] = exchangeProgram(matching, beneath, shape.group);
}

Status GlStages::load(const MeshTable& meshes) {
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
  const std::int64_t tiles = std::int64_t(tick.tile_index.size());
  SubStepTables largest = tick.stood;
  for (const SubStepTables& step : tick.sub_steps) {
    largest.point_count = std::max(largest.point_count, step.point_count);
    largest.primitive_count = std::max(largest.primitive_count, step.primitive_count);
    largest.domain_cells = std::max(largest.domain_cells, step.domain_cells);
    largest.mask_words = std::max(largest.mask_words, step.mask_words);
    largest.row_chunks = std::max(largest.row_chunks, step.row_chunks);
  }
  const std::int64_t plane_bytes = tiles * rules::kTileCells * kCellBytes;
  const std::int64_t domain_bytes = largest.domain_cells * kCellBytes;
  const std::pair<GrowingBuffer*, std::int64_t> needs[] = {
      {&upload_, std::int64_t(tick.bytes.size())},
      {&points_, largest.point_count * std::int64_t(sizeof(rules::RasterPoint))},
      {&large_, largest.primitive_count * 2 * kCellBytes},
      {&height_[0], plane_bytes},
      {&height_[1], schedule_ == RelaxSchedule::fused ? plane_bytes : 0},
      {&bedrock_, plane_bytes},
      {&underside_, plane_bytes},
      {&underside_before_, plane_bytes},
      {&tile_states_, tiles * std::int64_t(sizeof(rules::TileState))},
      {&overlap_, domain_bytes},
      {&free_mask_, largest.mask_words * kCellBytes},
      {&nearest_row_, domain_bytes},
      {&target_, domain_bytes},
      {&row_chunks_, largest.row_chunks * std::int64_t(sizeof(rules::RowChunk))},
      {&receivers_, largest.row_chunks * std::int64_t(sizeof(rules::RowChunk))},
      {&requested_low_, domain_bytes},
      {&requested_high_, domain_bytes},
      {&granted_low_, domain_bytes},
      {&granted_high_, domain_bytes},
      {&results_, tiles * std::int64_t(sizeof(rules::TileResult))},
      {&staging_, plane_bytes},
  };
  for (const auto& [buffer, bytes] : needs)
    if (Status status = buffer->reserve(bytes); !status) return status;
  glNamedBufferSubData(upload_.name(), 0, std::int64_t(tick.bytes.size()), tick.bytes.data());
  glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, upload_.name());
  return glStatus("copying a tick's tables");
}

void GlStages::use(const GlProgram& program, int sub_step) {
  glUseProgram(program.name());
  setUniform(1, sub_step);
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

void GlStages::gather(const TickTables& tick, const TilePool& pool) {
  bindCells(tick);
  pool.height().bind(rules::kBindPoolHeight);
  pool.bedrock().bind(rules::kBindPoolBedrock);
  use(gather_);
  dispatch(tick.gather);
}

void GlStages::depth(const TickTables& tick, int i) {
  const SubStepTables& step = i == kStood ? tick.stood : tick.sub_steps[std::size_t(i)];
  bindCells(tick);
  underside_before_.bind(rules::kBindUndersideBefore);
  use(cover_, i);
  setUniform(2, step.first_step);
  dispatch(step.cover);
  if (step.primitives.count > 0) drawBodies(tick, i);
  use(ceiling_, i);
  setUniform(2, step.first_step);
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
  use(place_, i);
  dispatch(step.place);
  use(depth_, i);
  dispatch(step.primitives);
  use(depth_large_, i);
  dispatchListed(listOffset(tick, i, offsetof(rules::SubStepLists, large)));
}

void GlStages::penetration(const TickTables& tick, int i) {
  const SubStepTables& step = tick.sub_steps[std::size_t(i)];
  if (step.domain_blocks.count == 0) return;
  bindCells(tick);
  bindTable(rules::kBindDomains, step.domains);
  bindTable(rules::kBindDomainTiles, step.domain_tiles);
  underside_before_.bind(rules::kBindUndersideBefore);
  overlap_.bind(rules::kBindOverlap);
  free_mask_.bind(rules::kBindFreeMask);
  row_chunks_.bind(rules::kBindRowChunks);
  use(penetration_, i);
  dispatch(step.domain_blocks);
}

void GlStages::nearest(const TickTables& tick, int i) {
  const SubStepTables& step = tick.sub_steps[std::size_t(i)];
  if (step.domain_blocks.count == 0) return;
  const std::int64_t rows = listOffset(tick, i, offsetof(rules::SubStepLists, rows));
  target_.bind(rules::kBindTarget);
  nearest_row_.bind(rules::kBindNearestRow);
  use(nearest_columns_, i);
  dispatchListed(rows);
  use(nearest_search_, i);
  int found_stride = 0;
  for (const int stride : {64, 8, 1}) {
    setUniform(2, stride);
    setUniform(3, found_stride);
    dispatchListed(rows);
    found_stride = stride;
  }
}

void GlStages::displace(const TickTables& tick, int i) {
  const SubStepTables& step = tick.sub_steps[std::size_t(i)];
  if (step.domain_blocks.count == 0) return;
  const std::int64_t rows = listOffset(tick, i, offsetof(rules::SubStepLists, rows));
  requested_low_.bind(rules::kBindRequestedLow);
  requested_high_.bind(rules::kBindRequestedHigh);
  receivers_.bind(rules::kBindReceivers);
  use(displace_request_, i);
  dispatchListed(rows);
  granted_low_.bind(rules::kBindGrantedLow);
  granted_high_.bind(rules::kBindGrantedHigh);
  use(displace_take_, i);
  dispatchListed(rows);
  receivers_.bind(rules::kBindRowChunks);
  use(displace_give_, i);
  setUniform(2, step.first_step);
  dispatchListed(listOffset(tick, i, offsetof(rules::SubStepLists, receivers)));
}

void GlStages::relax(const TickTables& tick, int i) {
  const SubStepTables& step = tick.sub_steps[std::size_t(i)];
  for (int sweep = 0; sweep < step.sweep_count; ++sweep) {
    const int first_step = step.first_step + sweep * rules::kMatchingCount;
    if (schedule_ == RelaxSchedule::fused)
      sweepFused(tick, first_step);
    else
      sweepPlain(tick, first_step);
  }
}

void GlStages::sweepPlain(const TickTables& tick, int first_step) {
  bindCells(tick);
  for (int matching = 0; matching < rules::kMatchingCount; ++matching) {
    use(exchange_[std::size_t(matching)][tick.beneath ? 1 : 0]);
    setUniform(2, first_step + matching);
    setUniform(3, skip_settled_ ? 1 : 0);
    setUniform(4, int(tick.tile_index.size()));
    setUniform(5, rules::exchangeThreshold(matching < rules::kMatchDiagonal ? tick.parameters.slope_threshold_q
                                                                            : tick.parameters.diagonal_threshold_q));
    setUniform(6, tick.parameters.obstacle_threshold_q);
    dispatch(tick.exchange);
  }
}

void GlStages::sweepFused(const TickTables& tick, int first_step) {
  bindCells(tick);
  height_[1 - current_].bind(rules::kBindNextHeight);
  use(sweep_);
  setUniform(2, first_step);
  setUniform(3, skip_settled_ ? 1 : 0);
  dispatch(tick.sweep);
  current_ = 1 - current_;
}

void GlStages::hash(const TickTables& tick, const TilePool& pool) {
  bindCells(tick);
  pool.height().bind(rules::kBindPoolHeight);
  results_.bind(rules::kBindResults);
  staging_.bind(rules::kBindStaging);
  use(hash_);
  dispatch(tick.hash);
}

std::int64_t GlStages::deviceBytes() const {
  std::int64_t bytes = height_[0].bytes() + height_[1].bytes();
  for (const GrowingBuffer* buffer :
       {&upload_,           &vertices_,      &indices_,        &points_,      &large_,        &bedrock_, &underside_,
        &underside_before_, &tile_states_,   &overlap_,        &free_mask_,   &nearest_row_,  &target_,  &row_chunks_,
        &receivers_,        &requested_low_, &requested_high_, &granted_low_, &granted_high_, &results_, &staging_})
    bytes += buffer->bytes();
  return bytes;
}

}  // namespace spoor
