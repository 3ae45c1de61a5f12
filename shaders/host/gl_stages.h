#pragma once

#include <vector>

#include "shaders/host/gl_buffer.h"
#include "shaders/host/gl_crater_table.h"
#include "shaders/host/gl_limits.h"
#include "shaders/host/gl_programs.h"
#include "shaders/host/tick_tables.h"
#include "shaders/host/tile_pool.h"
#include "shared/sim/backend.h"

namespace spoor {

/// Stages 2 and 4 to 9 of a tick as compute shaders over all active tiles at once. The context must be current in every
/// call, the constructor's and destructor's too. Calls only queue work: see GlFence.
class GlStages {
 public:
  /// Throws std::runtime_error where a shader of the default methods does not compile or link.
  GlStages(const GlLimits& limits, const GroupShape& shape, RelaxSchedule schedule, bool skip_settled);

  /// Copies a pack's meshes to the device, and compiles what craters and snow need where there may be any, as no tick
  /// should wait for that. Errors: too large for the device; it does not compile.
  [[nodiscard]] Status load(const MeshTable& meshes, bool with_craters = false, bool with_snow = false);

  /// Makes room for a tick and copies its tables to the device. Errors: the device has not the memory; a shader of the
  /// tick's methods does not compile.
  [[nodiscard]] Status begin(const TickTables& tick);

  // The tick's stages, in order; those with `i` for every sub-step.
  /// Stage craters first lets snow fall on tiles in the pool. Errors: as begin().
  [[nodiscard]] Status snow(const TickTables& tick, const TilePool& pool);
  /// Then it deforms tiles in the pool; only where the tick's tables have such.
  /// @param craters  those of this tick too, from `first_new` on; the table holds them
  /// @param cell_q   side of a cell
  /// Errors: as begin().
  [[nodiscard]] Status craters(const TickTables& tick, const TilePool& pool, const CraterSet& craters,
                               std::size_t first_new, const GlCraterTable& table, std::int32_t cell_q);
  void gather(const TickTables& tick, const TilePool& pool);
  /// @param i  kStood: where the bodies stood before the tick, before the first sub-step
  void depth(const TickTables& tick, int i);
  static constexpr int kStood = -1;
  void penetration(const TickTables& tick, int i);
  void nearest(const TickTables& tick, int i);
  void displace(const TickTables& tick, int i);
  /// With what bodies push soil, for drift.
  void relax(const TickTables& tick, int i);
  /// Results, staging and the pool's new heights.
  void hash(const TickTables& tick, const TilePool& pool);

  std::int64_t dispatchCount() const { return dispatch_count_; }  // since it was made
  std::vector<BufferBytes> buffers() const;
  /// What flooding and iterative displacement read and write in this tick where bodies penetrate, in first rounds.
  std::int64_t domainBytes() const { return domain_bytes_; }

  // Where results lie on the device.
  GLuint tables() const { return upload_.name(); }
  const GrowingBuffer& results() const { return results_; }
  const GrowingBuffer& staging() const { return staging_; }
  const GrowingBuffer& craterChanges() const { return crater_changes_; }
  // Planes, for looking into the stages. Tiles' planes are indexed by TickTables::tile_index, domains' by
  // DomainEntry::first_cell.
  const GrowingBuffer& height() const { return height_[current_]; }
  const GrowingBuffer& underside() const { return underside_; }
  const GrowingBuffer& tileStates() const { return tile_states_; }
  const GrowingBuffer& overlap() const { return overlap_; }
  const GrowingBuffer& target() const { return target_; }
  const GrowingBuffer& compacted() const { return compacted_; }

 private:
  Result<const GlProgram*> compiled(const GlProgram& (GlPrograms::*program)());
  Status reserve(const TickTables& tick);
  static void setUniform(int location, int value) { glUniform1i(location, value); }
  static std::int64_t listOffset(const TickTables& tick, int list, std::size_t member);
  void use(const GlProgram& program, int list = 0);
  void dispatch(const GroupList& list);
  void dispatchListed(std::int64_t arguments);
  void bindTable(int binding, const TableRange& range) const;
  void bindCells(const TickTables& tick) const;
  void bindMaterials(const TickTables& tick, int binding = rules::kBindMaterial) const;
  void beginUndersides(const TickTables& tick, const SubStepTables& step);
  void findCeilings(const TickTables& tick, const SubStepTables& step);
  void drawBodies(const TickTables& tick, int i);
  void search(const TickTables& tick, int i);
  void dispatchWholes(const TickTables& tick, int i, int round);
  void flood(const TickTables& tick, int i, int round);
  void displaceRound(const TickTables& tick, int i, int round);
  void flow(const TickTables& tick, int i);
  void sweepPlain(const TickTables& tick, int first_step);
  void sweepFused(const TickTables& tick, int first_step);
  int nextHeights(const TickTables& tick, int turns) const;
  void clearNextHeights(const TickTables& tick);
  void sweepSlopes(const TickTables& tick);
  void push(const TickTables& tick, const SubStepTables& step);
  void sweepDrift(const TickTables& tick, int sweep, bool pushes);

  RelaxSchedule schedule_;
  bool skip_settled_;
  std::int64_t dispatch_count_ = 0;
  std::int64_t domain_bytes_ = 0;
  int current_ = 0;  // which of height_ holds the heights
  GlPrograms programs_;
  TickPrograms chosen_;  // by the present tick
  GrowingBuffer upload_, vertices_, indices_, points_, large_;
  GrowingBuffer height_[3];  // others than the first only where sweeps take turns
  GrowingBuffer bedrock_, underside_, underside_before_, compacted_, material_, push_x_, push_y_, tile_states_;
  GrowingBuffer overlap_, free_mask_, nearest_row_, target_, row_chunks_, receivers_;
  GrowingBuffer requested_low_, requested_high_, granted_;
  GrowingBuffer flood_, carried_[2], offered_, room_, amounts_;
  GrowingBuffer results_, staging_, crater_changes_, crater_sums_;
};

}  // namespace spoor
