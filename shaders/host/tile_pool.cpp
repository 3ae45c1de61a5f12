#include "shaders/host/tile_pool.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "shared/base/assert.h"
#include "shared/base/kernels.h"
#include "shared/codec/tile_codec.h"

namespace spoor {
namespace {

constexpr std::int64_t kPlaneBytes = sizeof(PlaneCells);

/// Numbers of four cells' materials in a word, the first in the low byte.
using PackedMaterials = std::array<std::uint32_t, rules::kTileCells / 4>;

PackedMaterials packedMaterials(const Tile& tile) {
  PackedMaterials packed{};
  if (tile.material() == nullptr) return packed;
  for (std::size_t cell = 0; cell < rules::kTileCells; ++cell)
    packed[cell / 4] |= std::uint32_t((*tile.material())[cell]) << (cell % 4 * 8);
  return packed;
}

}  // namespace

TilePool::TilePool(std::int64_t block_bytes, int tile_limit, std::function<void(const std::string&)> say)
    : most_slots_(int(std::min<std::int64_t>(block_bytes / kPlaneBytes, 1 << 19))),  // cells are counted in ints
      tile_limit_(std::clamp(tile_limit, 1, most_slots_)),
      say_(std::move(say)),
      height_("the pool's heights", block_bytes, GrowingBuffer::Content::kept),
      bedrock_("the pool's bedrock", block_bytes, GrowingBuffer::Content::kept),
      compacted_("the pool's compacted soil", block_bytes, GrowingBuffer::Content::kept),
      material_("the pool's materials", block_bytes, GrowingBuffer::Content::kept) {
  SPOOR_ASSERT(std::size_t(most_slots_) >= kTickTilesLimit);
}

Result<std::vector<int>> TilePool::hold(std::span<Tile* const> tiles, std::int32_t tick, const PoolPlanes& planes) {
  std::vector<int> slots(tiles.size(), -1), fresh;
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    const auto found = slot_of_.find(tiles[i]);
    if (found == slot_of_.end()) {
      fresh.push_back(int(i));
      continue;
    }
    slots[i] = found->second;
    slots_[std::size_t(found->second)].used_at = tick;
  }
  if (Status status = makeRoom(int(fresh.size()), tick); !status) return Error{status.error()};
  for (const int i : fresh) {
    const int slot = slots[std::size_t(i)] = free_.back();
    free_.pop_back();
    slots_[std::size_t(slot)] = {tiles[std::size_t(i)], tick, false};
    slot_of_.emplace(tiles[std::size_t(i)], slot);
  }
  copyToDevice(height_, tiles, slots, fresh, [&](const Tile& tile) {
    highest_ = std::max(highest_, kernels().highest(tile.height().data(), rules::kTileCells));
    return tile.height();
  });
  copyToDevice(bedrock_, tiles, slots, fresh, [](const Tile& tile) { return *tile.bedrock; });
  if (planes.material) {
    const auto bytes = std::int64_t(slots_.size() * sizeof(PackedMaterials));
    if (Status status = material_.reserve(bytes); !status) return Error{status.error()};
    copyToDevice(material_, tiles, slots, std::move(fresh), packedMaterials);
  }
  if (planes.compacted)
    if (Status status = holdCompacted(tiles, slots); !status) return Error{status.error()};
  return slots;
}

/// Copies the compacted soil of tiles that came to the device in ticks that do not compact. No later tick changed it.
Status TilePool::holdCompacted(std::span<Tile* const> tiles, std::span<const int> slots) {
  if (Status status = compacted_.reserve(std::int64_t(slots_.size()) * kPlaneBytes); !status) return status;
  std::vector<int> fresh;
  for (std::size_t i = 0; i < tiles.size(); ++i)
    if (!std::exchange(slots_[std::size_t(slots[i])].has_compacted, true)) fresh.push_back(int(i));
  copyToDevice(compacted_, tiles, slots, std::move(fresh),
               [](const Tile& tile) { return tile.compacted() != nullptr ? *tile.compacted() : PlaneCells{}; });
  return {};
}

void TilePool::forget() {
  slot_of_.clear();
  free_.clear();
  for (std::size_t slot = 0; slot < slots_.size(); ++slot) {
    slots_[slot] = {};
    free_.push_back(int(slot));
  }
  std::ranges::sort(free_, std::greater<>());
}

/// Frees or adds slots until there are `missing` free ones.
Status TilePool::makeRoom(int missing, std::int32_t tick) {
  int lacking = missing - int(free_.size());
  if (lacking <= 0) return {};
  const int in_use_now = int(std::ranges::count(slots_, tick, &Slot::used_at));
  const int limit = std::max(tile_limit_, in_use_now + missing);
  SPOOR_ASSERT(limit <= most_slots_);
  const int wanted = std::min(std::max(int(slots_.size()) + lacking, 2 * int(slots_.size())), limit);
  if (wanted > int(slots_.size())) {
    const Status grown = grow(wanted);
    lacking = missing - int(free_.size());
    const int idle = int(slots_.size()) - int(free_.size()) - in_use_now;
    if (!grown && idle < lacking) return grown;
    if (!grown) {
      say_(grown.error() + "; the tile pool stays at " + std::to_string(slots_.size()) + " tiles");
      tile_limit_ = std::max(int(slots_.size()), 1);
    }
  }
  if (lacking > 0) evict(lacking, tick);
  return {};
}

Status TilePool::grow(int slot_count) {
  if (Status status = height_.reserve(slot_count * kPlaneBytes); !status) return status;
  if (Status status = bedrock_.reserve(slot_count * kPlaneBytes); !status) return status;
  for (int slot = int(slots_.size()); slot < slot_count; ++slot) free_.push_back(slot);
  slots_.resize(std::size_t(slot_count));
  std::ranges::sort(free_, std::greater<>());
  return {};
}

void TilePool::evict(int count, std::int32_t tick) {
  if (evicted_count_ == 0)
    say_("gl: the tile pool is full at " + std::to_string(slots_.size()) +
         " tiles; those not used for longest stay on the host until they are active again");
  std::vector<int> idle;
  for (std::size_t slot = 0; slot < slots_.size(); ++slot)
    if (slots_[slot].tile != nullptr && slots_[slot].used_at != tick) idle.push_back(int(slot));
  SPOOR_ASSERT(int(idle.size()) >= count);
  std::ranges::nth_element(idle, idle.begin() + (count - 1), {},
                           [&](int slot) { return slots_[std::size_t(slot)].used_at; });
  for (int i = 0; i < count; ++i) release(idle[std::size_t(i)]);
  std::ranges::sort(free_, std::greater<>());
  evicted_count_ += count;
}

void TilePool::drop(std::span<Tile* const> tiles) {
  if (tiles.empty()) return;
  for (const Tile* tile : tiles)
    if (const auto found = slot_of_.find(tile); found != slot_of_.end()) release(found->second);
  std::ranges::sort(free_, std::greater<>());
}

void TilePool::release(int slot) {
  slot_of_.erase(slots_[std::size_t(slot)].tile);
  slots_[std::size_t(slot)] = {};
  free_.push_back(slot);
}

/// One copy for each stretch of slots that follow one another.
template <typename PlaneOf>
void TilePool::copyToDevice(const GrowingBuffer& to, std::span<Tile* const> tiles, std::span<const int> slots,
                            std::vector<int> fresh, PlaneOf planeOf) {
  constexpr std::size_t kTilesAtOnce = 256;
  std::ranges::sort(fresh, {}, [&](int i) { return slots[std::size_t(i)]; });
  std::vector<decltype(planeOf(*tiles[0]))> cells;
  constexpr auto kBytes = std::int64_t(sizeof(cells[0]));
  for (std::size_t begin = 0; begin < fresh.size();) {
    const int first_slot = slots[std::size_t(fresh[begin])];
    std::size_t end = begin;
    while (end < fresh.size() && end - begin < kTilesAtOnce &&
           slots[std::size_t(fresh[end])] == first_slot + int(end - begin))
      ++end;
    cells.resize(end - begin);
    for (std::size_t i = begin; i < end; ++i) cells[i - begin] = planeOf(*tiles[std::size_t(fresh[i])]);
    const std::int64_t bytes = std::int64_t(cells.size()) * kBytes;
    glNamedBufferSubData(to.name(), first_slot * kBytes, bytes, cells.data());
    copied_bytes_ += bytes;
    begin = end;
  }
}

std::int64_t TilePool::hostBytes() const {
  return std::int64_t(slots_.capacity() * sizeof(Slot) + free_.capacity() * sizeof(int) +
                      slot_of_.size() * 4 * sizeof(void*) + slot_of_.bucket_count() * sizeof(void*));
}

}  // namespace spoor
