#pragma once

#include <memory>

#include "shaders/host/gl_buffer.h"
#include "shaders/sim/crater_table.h"
#include "shared/world/crater_set.h"

namespace spoor {

/// A set's craters and spatial hash on the device, for the stage that deforms and for whoever draws
/// (shaders/sim/crater_table.glsl). Only records travel there: compute shaders build the hash, which is the host's to
/// the bit. Needs its context current.
class GlCraterTable {
 public:
  /// @param block_bytes  GlLimits::storage_block_bytes
  explicit GlCraterTable(std::int64_t block_bytes);
  ~GlCraterTable();

  /// Compiles the kernels; else the first update() with craters does. Errors: one does not compile.
  [[nodiscard]] Status compile();

  /// Brings the device to the set, which is the one of the last call with more craters, or, after forget(), another.
  /// New craters cost their own entries, but where the set's table was built anew. Only queues work; changes the
  /// current program and the first storage bindings.
  /// Errors: the device has not the memory; a shader does not compile. What it holds is then of no use.
  [[nodiscard]] Status update(const CraterSet& craters, std::int32_t cell_q);

  /// Binds the buffers to rules::kCraterTableBuffers storage bindings.
  void bind(int first_binding) const;

  void forget();

  std::int64_t deviceBytes() const;
  std::int64_t copiedBytes() const { return copied_bytes_; }      // to the device, since it was made
  std::int64_t dispatchCount() const { return dispatch_count_; }  // the same

 private:
  struct Programs;

  void forgetRecords();
  Status bringTo(const CraterSet& craters, std::int32_t cell_q);
  Status sendShapes(std::span<const Crater> craters);
  void sendHead(const rules::CraterHead& head);
  Status layOut(const CraterTable& table);
  void insert(const CraterTable& table, std::span<const Crater> craters);
  void dispatch(GLuint program, std::int64_t lanes, int first, int end, int group);

  std::unique_ptr<Programs> programs_;  // from the first crater on
  GlBuffer head_;
  GrowingBuffer shapes_, first_, used_, entries_;
  GrowingBuffer starts_, heads_, nodes_;
  std::size_t sent_count_ = 0;      // craters whose shapes the device holds
  std::size_t inserted_count_ = 0;  // of them in the hash
  std::uint32_t built_count_ = 0;   // CraterTable::built_count that set the layout
  std::int64_t bucket_count_ = 0;   // 0: there is none yet
  std::int64_t copied_bytes_ = 0, dispatch_count_ = 0;
};

}  // namespace spoor
