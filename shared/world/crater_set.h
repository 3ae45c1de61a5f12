#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shaders/rules/crater_hash.h"
#include "shared/world/crater.h"

namespace spoor {

/// The spatial hash of a set's records (rules/crater_hash.h), laid out as a device holds it too.
struct CraterTable {
  std::int32_t side_q = 1;          // of a cell
  std::int32_t width_q = 0;         // of the map
  std::int32_t height_q = 0;        //
  std::vector<std::int32_t> first;  // [buckets] first place of each bucket in `entries`; buckets are a power of two
  std::vector<std::int32_t> used;   // [buckets] places taken, of rules::craterCapacity
  std::vector<rules::CraterEntry> entries;  // of each bucket by record, then tag; what no bucket uses is 0
  std::uint32_t built_count = 0;            // records there were when it was built: they set its layout
  std::uint32_t generation = 0;             // how often it was built

  std::int32_t mask() const { return std::int32_t(used.size()) - 1; }
};

/// All craters of a session so far, by id, and where to find them. What they do to dormant ground is a function of the
/// set alone: neither order nor the hash's cells show.
class CraterSet {
 public:
  /// A set that admits none.
  CraterSet() = default;
  /// An empty set. The pack must be valid; it is not kept.
  explicit CraterSet(const ScenePack& pack);

  /// Adds valid craters, whose ids follow on (asserted). Costs as much as they have hash cells, but where a bucket is
  /// full: then the table is built anew, larger.
  void add(std::span<const Crater> craters);
  /// Takes back the newest.
  void truncate(std::size_t count);

  std::span<const Crater> records() const { return records_; }
  std::size_t size() const { return records_.size(); }
  const CraterTable& table() const { return table_; }
  /// In how many hash cells the records are, all together.
  std::int64_t hashCells() const { return hash_cells_; }
  /// Of all records, in order.
  std::uint64_t hash() const { return hash_; }

  /// Ids of the records whose square meets a box of cells, in order, each once. Looks only into the hash cells that the
  /// box meets.
  /// @param read  where given: how many records it looked at, each once for each of those cells
  std::vector<std::uint32_t> meeting(const CellBox& cells, std::size_t* read = nullptr) const;

  /// D(S) at every `stride`-th cell from (x, y) on, row-major [rows * columns], 0.1 mm; 0 outside the map.
  void fill(std::int32_t x, std::int32_t y, std::int32_t stride, std::int32_t columns, std::int32_t rows,
            std::span<std::int32_t> displacement) const;

  /// Adds what one record does to the sums of a box of cells, row-major.
  void addTo(std::span<rules::CraterSum> sums, const CellBox& cells, std::uint32_t id) const;

  std::size_t memoryBytes() const;

 private:
  template <typename Visit>
  void forEachHashCell(const Crater& crater, Visit visit) const;
  struct Lattice;
  void addTo(std::span<rules::CraterSum> sums, const Lattice& lattice, const Crater& crater) const;
  bool insert(std::uint32_t record);
  void build();

  std::int32_t cell_q_ = 1, width_cells_ = 0, height_cells_ = 0;
  CraterTable table_;
  std::vector<Crater> records_;
  std::uint64_t hash_ = 0;
  std::int64_t hash_cells_ = 0;
};

}  // namespace spoor
