#pragma once

#include <functional>
#include <span>
#include <unordered_map>
#include <vector>

#include "shaders/host/gl_buffer.h"
#include "shared/world/tile_store.h"

namespace spoor {

/// Which planes of tiles a tick needs on the device besides heights and bedrock.
struct PoolPlanes {
  bool compacted = false;
  bool material = false;
};

/// Live tiles that stay on the device from tick to tick: heights and bedrock, in slots of tile size; materials where
/// there are several, and compacted soil from the first tick on that compacts. It grows as tiles become live; at its
/// limit, tiles that were not used for longest give up their slots and exist on the host only, which holds every live
/// tile anyway, until they are active again.
class TilePool {
 public:
  /// @param block_bytes  GlLimits::storage_block_bytes
  /// @param tile_limit   slots at most, as long as the active tiles of a tick need no more; what one block holds is
  ///                     the limit beyond that
  /// @param say          told once, when tiles begin to give up their slots
  TilePool(std::int64_t block_bytes, int tile_limit, std::function<void(const std::string&)> say);

  /// Sees to it that all these tiles are in slots, and copies to the device those that were not. Their cells on the
  /// host must be as of the last tick in which they were active. At most kTickTilesLimit.
  /// @param planes  materials: in all ticks until forget(), or in none
  /// @return  a slot for each
  Result<std::vector<int>> hold(std::span<Tile* const> tiles, std::int32_t tick, const PoolPlanes& planes);

  /// Takes tiles out of their slots, as far as they are in any: their cells on the host are others now.
  void drop(std::span<Tile* const> tiles);

  /// No tile is in a slot any more.
  void forget();

  const GrowingBuffer& height() const { return height_; }
  const GrowingBuffer& bedrock() const { return bedrock_; }
  const GrowingBuffer& compacted() const { return compacted_; }
  const GrowingBuffer& material() const { return material_; }

  int residentCount() const { return int(slot_of_.size()); }
  std::int64_t deviceBytes() const {
    return height_.bytes() + bedrock_.bytes() + compacted_.bytes() + material_.bytes();
  }
  std::int64_t hostBytes() const;
  std::int64_t copiedBytes() const { return copied_bytes_; }  // to the device, since the pool was made
  /// No cell that came to the device was higher.
  std::int32_t highest() const { return highest_; }
  std::int64_t evictedCount() const { return evicted_count_; }

 private:
  struct Slot {
    const Tile* tile = nullptr;
    std::int32_t used_at = 0;    // tick
    bool has_compacted = false;  // are its cells of that plane here too?
  };

  Status makeRoom(int missing, std::int32_t tick);
  Status grow(int slot_count);
  void evict(int count, std::int32_t tick);
  void release(int slot);
  Status holdCompacted(std::span<Tile* const> tiles, std::span<const int> slots);
  template <typename PlaneOf>
  void copyToDevice(const GrowingBuffer& to, std::span<Tile* const> tiles, std::span<const int> slots,
                    std::vector<int> fresh, PlaneOf planeOf);

  int most_slots_;
  int tile_limit_;
  std::function<void(const std::string&)> say_;
  GrowingBuffer height_, bedrock_, compacted_, material_;
  std::vector<Slot> slots_;
  std::vector<int> free_;  // the lowest at the back
  std::unordered_map<const Tile*, int> slot_of_;
  std::int32_t highest_ = -rules::kHeightLimit;
  std::int64_t copied_bytes_ = 0, evicted_count_ = 0;
};

}  // namespace spoor
