#include "shared/world/crater_set.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "shared/base/assert.h"
#include "shared/base/hash.h"
#include "shared/base/kernels.h"
#include "shared/world/pack.h"

namespace spoor {
namespace {

constexpr std::size_t kLeastBuckets = 64;
constexpr std::size_t kEntriesPerBucket = 4;

std::uint64_t hashOf(std::uint64_t before, const Crater& crater) {
  ByteWriter writer;
  putCrater(writer, crater);
  return hashBytes(writer.bytes, mix64(before));
}

}  // namespace

CraterSet::CraterSet(const ScenePack& pack)
    : cell_q_(pack.cell_q), width_cells_(pack.width_cells), height_cells_(pack.height_cells) {
  table_.side_q = pack.crater_limits.hash_cell_q;
  table_.width_q = width_cells_ * cell_q_;
  table_.height_q = height_cells_ * cell_q_;
}

/// Calls visit(bucket, tag) for each hash cell that the crater is in, row by row.
template <typename Visit>
void CraterSet::forEachHashCell(const Crater& crater, Visit visit) const {
  const auto outer = std::int32_t(crater.outerRadius());
  const int x0 = rules::craterFirstCell(crater.x_q, outer, table_.side_q);
  const int x1 = rules::craterLastCell(crater.x_q, outer, table_.side_q, table_.width_q);
  const int y0 = rules::craterFirstCell(crater.y_q, outer, table_.side_q);
  const int y1 = rules::craterLastCell(crater.y_q, outer, table_.side_q, table_.height_q);
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) visit(rules::craterBucket(x, y, table_.mask()), rules::craterTag(x, y));
}

void CraterSet::add(std::span<const Crater> craters) {
  bool fits = !table_.used.empty();
  for (const Crater& crater : craters) {
    SPOOR_ASSERT(crater.id == records_.size() && records_.size() < kCratersLimit);
    records_.push_back(crater);
    hash_ = hashOf(hash_, crater);
    forEachHashCell(crater, [&](int, std::uint32_t) { ++hash_cells_; });
    SPOOR_ASSERT(hash_cells_ <= kCraterHashCellsLimit);
    fits = fits && insert(crater.id);
  }
  if (!fits && !craters.empty()) build();
}

void CraterSet::truncate(std::size_t count) {
  if (count >= records_.size()) return;
  records_.resize(count);
  hash_ = 0;
  hash_cells_ = 0;
  for (const Crater& crater : records_) {
    hash_ = hashOf(hash_, crater);
    forEachHashCell(crater, [&](int, std::uint32_t) { ++hash_cells_; });
  }
  build();
}

/// Puts a record into its buckets; false, and some of it may be there, where one is full.
bool CraterSet::insert(std::uint32_t record) {
  bool fits = true;
  forEachHashCell(records_[record], [&](int bucket, std::uint32_t tag) {
    const std::int32_t first = table_.first[std::size_t(bucket)];
    const std::int32_t end = std::size_t(bucket) + 1 < table_.first.size() ? table_.first[std::size_t(bucket) + 1]
                                                                           : std::int32_t(table_.entries.size());
    std::int32_t& used = table_.used[std::size_t(bucket)];
    if (first + used == end) {
      fits = false;
      return;
    }
    // Cells are visited row by row; only where tags wrap round does one of the same record come after.
    std::int32_t place = first + used++;
    for (; place > first; --place) {
      const rules::CraterEntry& before = table_.entries[std::size_t(place) - 1];
      if (before.record != std::int32_t(record) || before.tag < tag) break;
      table_.entries[std::size_t(place)] = before;
    }
    table_.entries[std::size_t(place)] = {std::int32_t(record), tag};
  });
  return fits;
}

/// Counting, a prefix sum, and then each record to its place.
void CraterSet::build() {
  const std::size_t buckets = std::bit_ceil(std::max(kLeastBuckets, std::size_t(hash_cells_) / kEntriesPerBucket));
  table_.used.assign(buckets, 0);
  for (const Crater& crater : records_)
    forEachHashCell(crater, [&](int bucket, std::uint32_t) { ++table_.used[std::size_t(bucket)]; });
  table_.first.resize(buckets);
  std::int32_t next = 0;
  for (std::size_t bucket = 0; bucket < buckets; ++bucket) {
    table_.first[bucket] = next;
    next += rules::craterCapacity(table_.used[bucket]);
  }
  table_.entries.assign(std::size_t(next), {});
  table_.used.assign(buckets, 0);
  for (const Crater& crater : records_) {
    const bool fits = insert(crater.id);
    SPOOR_ASSERT(fits);
  }
  table_.built_count = std::uint32_t(records_.size());
  ++table_.generation;
}

std::vector<std::uint32_t> CraterSet::meeting(const CellBox& cells, std::size_t* read) const {
  if (read != nullptr) *read = 0;
  std::vector<std::uint32_t> found;
  const CellBox box{std::max(cells.x0, 0), std::max(cells.y0, 0), std::min(cells.x1, width_cells_),
                    std::min(cells.y1, height_cells_)};
  if (box.empty() || records_.empty()) return found;
  const std::int64_t west = std::int64_t(box.x0) * cell_q_, east = std::int64_t(box.x1) * cell_q_ - 1;
  const std::int64_t south = std::int64_t(box.y0) * cell_q_, north = std::int64_t(box.y1) * cell_q_ - 1;
  const auto look = [&](const Crater& crater) {
    if (read != nullptr) ++*read;
    const std::int64_t outer = crater.outerRadius();
    if (crater.x_q + outer >= west && crater.x_q - outer <= east && crater.y_q + outer >= south &&
        crater.y_q - outer <= north)
      found.push_back(crater.id);
  };
  const std::int64_t x0 = west / table_.side_q, x1 = east / table_.side_q;
  const std::int64_t y0 = south / table_.side_q, y1 = north / table_.side_q;
  if ((x1 - x0 + 1) * (y1 - y0 + 1) > std::int64_t(records_.size())) {  // fewer records than hash cells
    std::ranges::for_each(records_, look);
    return found;
  }
  for (auto y = std::int32_t(y0); y <= y1; ++y)
    for (auto x = std::int32_t(x0); x <= x1; ++x) {
      const auto bucket = std::size_t(rules::craterBucket(x, y, table_.mask()));
      const std::uint32_t tag = rules::craterTag(x, y);
      const rules::CraterEntry* entry = table_.entries.data() + table_.first[bucket];
      for (const rules::CraterEntry* end = entry + table_.used[bucket]; entry != end; ++entry)
        if (entry->tag == tag) look(records_[std::size_t(entry->record)]);
    }
  std::ranges::sort(found);
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

/// Every `stride`-th cell from (x, y) on.
struct CraterSet::Lattice {
  std::int32_t x, y, stride, columns, rows;

  CellBox box() const { return {x, y, x + (columns - 1) * stride + 1, y + (rows - 1) * stride + 1}; }

  /// Of `count` samples along one axis those at cells [low, high).
  static std::pair<std::int32_t, std::int32_t> samplesIn(std::int32_t from, std::int32_t stride, std::int32_t count,
                                                         std::int32_t low, std::int32_t high) {
    const auto sampleFrom = [&](std::int64_t cell) {
      return std::int32_t(cell <= from ? 0 : std::min<std::int64_t>((cell - from + stride - 1) / stride, count));
    };
    return {sampleFrom(low), sampleFrom(high)};
  }
};

void CraterSet::addTo(std::span<rules::CraterSum> sums, const Lattice& lattice, const Crater& crater) const {
  const CellBox box = craterBox(cell_q_, width_cells_, height_cells_, crater);
  const auto [x0, x1] = Lattice::samplesIn(lattice.x, lattice.stride, lattice.columns, box.x0, box.x1);
  const auto [y0, y1] = Lattice::samplesIn(lattice.y, lattice.stride, lattice.rows, box.y0, box.y1);
  if (x0 >= x1 || y0 >= y1) return;
  const rules::CraterShape shape = shapeOf(crater);
  std::vector<std::int32_t> displacement(std::size_t(x1 - x0));
  const std::int32_t dx = (lattice.x + x0 * lattice.stride) * cell_q_ + cell_q_ / 2 - shape.x;
  for (std::int32_t row = y0; row < y1; ++row) {
    const std::int32_t dy = (lattice.y + row * lattice.stride) * cell_q_ + cell_q_ / 2 - shape.y;
    kernels().craterRow(shape, dx, lattice.stride * cell_q_, dy, x1 - x0, displacement.data());
    rules::CraterSum* sum = sums.data() + std::size_t(row) * std::size_t(lattice.columns) + x0;
    for (const std::int32_t change : displacement) {
      *sum = rules::withCrater(*sum, change, shape.rim);
      ++sum;
    }
  }
}

void CraterSet::addTo(std::span<rules::CraterSum> sums, const CellBox& cells, std::uint32_t id) const {
  SPOOR_ASSERT(sums.size() == std::size_t(cells.x1 - cells.x0) * std::size_t(cells.y1 - cells.y0));
  addTo(sums, Lattice{cells.x0, cells.y0, 1, cells.x1 - cells.x0, cells.y1 - cells.y0}, records_[id]);
}

void CraterSet::fill(std::int32_t x, std::int32_t y, std::int32_t stride, std::int32_t columns, std::int32_t rows,
                     std::span<std::int32_t> displacement) const {
  SPOOR_ASSERT(displacement.size() == std::size_t(columns) * std::size_t(rows) && stride >= 1);
  const Lattice lattice{x, y, stride, columns, rows};
  const std::vector<std::uint32_t> ids = meeting(lattice.box());
  if (ids.empty()) return std::ranges::fill(displacement, 0), void();
  std::vector<rules::CraterSum> sums(displacement.size(), rules::craterSumOfNone());
  for (const std::uint32_t id : ids) addTo(sums, lattice, records_[id]);
  std::ranges::transform(sums, displacement.begin(), rules::craterTotal);
}

std::size_t CraterSet::memoryBytes() const {
  return records_.capacity() * sizeof(Crater) + table_.first.capacity() * sizeof(std::int32_t) +
         table_.used.capacity() * sizeof(std::int32_t) + table_.entries.capacity() * sizeof(rules::CraterEntry);
}

}  // namespace spoor
