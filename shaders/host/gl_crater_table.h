#pragma once

#include "shaders/host/gl_buffer.h"
#include "shared/world/crater_set.h"

namespace spoor {

/// A set's craters and spatial hash on the device, for the stage that deforms and for whoever draws
/// (shaders/sim/crater_table.glsl). Needs its context current.
class GlCraterTable {
 public:
  /// @param block_bytes  GlLimits::storage_block_bytes
  explicit GlCraterTable(std::int64_t block_bytes);

  /// Brings the device to the set, which is the one of the last call with more craters, or, after forget(), another.
  /// New craters cost their own entries, but where the set's table was built anew.
  /// Errors: the device has not the memory; what it holds is then of no use.
  [[nodiscard]] Status update(const CraterSet& craters, std::int32_t cell_q);

  /// Binds the buffers to rules::kCraterTableBuffers storage bindings.
  void bind(int first_binding) const;

  void forget();

  std::int64_t deviceBytes() const;

 private:
  GlBuffer head_;
  GrowingBuffer shapes_, first_, used_, entries_;
  std::size_t count_ = 0;  // craters that the device holds
};

}  // namespace spoor
