#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "shaders/host/gl_buffer.h"
#include "shaders/host/gl_limits.h"
#include "shaders/host/tick_tables.h"
#include "shaders/host/tile_pool.h"
#include "shaders/rules/exchange.h"
#include "shared/sim/stage.h"

namespace spoor {

/// How the relaxation is dispatched. The same bits either way.
enum class RelaxSchedule {
  plain,  // one dispatch for each of a sweep's eight matchings, in place
  fused,  // one for a whole sweep, in shared memory with a halo: for hardware, where a dispatch costs more than cells
};

/// Stages 4 to 9 of a tick as compute shaders over all active tiles at once. The context must be current in every call,
/// the constructor's and destructor's too. Calls only queue work: see GlFence.
class GlStages {
 public:
  /// Throws std::runtime_error where a shader does not compile or link.
  GlStages(const GlLimits& limits, const GroupShape& shape, RelaxSchedule schedule, bool skip_settled);

  /// Copies a pack's meshes to the device. Errors: too large for it.
  [[nodiscard]] Status load(const MeshTable& meshes);

  /// Makes room for a tick and copies its tables to the device. Errors: the device has not the memory.
  [[nodiscard]] Status begin(const TickTables& tick);

  // The tick's stages, in order; those with `i` for every sub-step.
  void gather(const TickTables& tick, const TilePool& pool);
  /// @param i  kStood: where the bodies stood before the tick, before the first sub-step
  void depth(const TickTables& tick, int i);
  static constexpr int kStood = rules::kStoodLists;
  void penetration(const TickTables& tick, int i);
  void nearest(const TickTables& tick, int i);
  void displace(const TickTables& tick, int i);
  void relax(const TickTables& tick, int i);
  /// Results, staging and the pool's new heights.
  void hash(const TickTables& tick, const TilePool& pool);

  std::int64_t dispatchCount() const { return dispatch_count_; }  // since it was made
  std::int64_t deviceBytes() const;

  // Where results lie on the device.
  GLuint tables() const { return upload_.name(); }
  const GrowingBuffer& results() const { return results_; }
  const GrowingBuffer& staging() const { return staging_; }
  // Planes, for looking into the stages. Tiles' planes are indexed by TickTables::tile_index, domains' by
  // DomainEntry::first_cell.
  const GrowingBuffer& height() const { return height_[current_]; }
  const GrowingBuffer& underside() const { return underside_; }
  const GrowingBuffer& tileStates() const { return tile_states_; }
  const GrowingBuffer& overlap() const { return overlap_; }
  const GrowingBuffer& target() const { return target_; }

 private:
  void use(const GlProgram& program, int sub_step = 0);
  void dispatch(const GroupList& list);
  void dispatchListed(std::int64_t arguments);
  void bindTable(int binding, const TableRange& range) const;
  void bindCells(const TickTables& tick) const;
  void drawBodies(const TickTables& tick, int i);
  void sweepPlain(const TickTables& tick, int first_step);
  void sweepFused(const TickTables& tick, int first_step);

  RelaxSchedule schedule_;
  bool skip_settled_;
  std::int64_t dispatch_count_ = 0;
  int current_ = 0;  // which of height_ holds the heights
  GlProgram gather_, cover_, ceiling_, place_, depth_, depth_large_, penetration_, nearest_columns_, nearest_search_,
      displace_request_, displace_take_, displace_give_, sweep_, hash_;
  // Of each matching; the second where bodies may stand over active tiles.
  std::array<std::array<GlProgram, 2>, rules::kMatchingCount> exchange_;
  GrowingBuffer upload_, vertices_, indices_, points_, large_;
  GrowingBuffer height_[2];  // the second only where sweeps are fused
  GrowingBuffer bedrock_, underside_, underside_before_, tile_states_;
  GrowingBuffer overlap_, free_mask_, nearest_row_, target_, row_chunks_, receivers_;
  GrowingBuffer requested_low_, requested_high_, granted_low_, granted_high_;
  GrowingBuffer results_, staging_;
};

}  // namespace spoor
