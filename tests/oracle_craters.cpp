// Stage craters from DESIGN.md's description: every record looked at in every cell.
#include "shared/base/bytes.h"
#include "shared/base/fixed.h"
#include "shared/base/hash.h"
#include "tests/oracle.h"

namespace spoor::test {

/// Takes the craters of a tick in: live ground takes the difference of what they do together with the new ones and
/// without.
void Oracle::addCraters(const std::vector<Crater>& craters) {
  std::ranges::fill(cratered_, std::uint8_t(0));
  if (craters.empty()) return;
  const std::vector<rules::CraterSum> before = crater_sums_;
  for (const Crater& crater : craters) {
    records_.push_back(crater);
    records_.back().tick = tick_ + 1;
    records_.back().id = std::uint32_t(records_.size() - 1);
    addToSums(crater);
    markLiveBox(crater);
  }
  for (int y = 0; y < world_.inside_rows; ++y)
    for (int x = 0; x < world_.inside_columns; ++x) {
      if (!isLive({x / rules::kTileSize, y / rules::kTileSize})) continue;
      const std::size_t i = world_.at(x, y);
      std::int32_t& height = world_.height[i];
      const std::int32_t total = rules::craterTotal(crater_sums_[i]), total_before = rules::craterTotal(before[i]);
      crater_budget_ -= height;
      height = rules::craterGround(height, world_.bedrock[i], total - total_before);
      crater_budget_ += height;
    }
}

/// The base and what all craters together do to it.
std::int32_t Oracle::crateredBase(std::size_t cell) const {
  return rules::craterGround(base_height_[cell], world_.bedrock[cell], rules::craterTotal(crater_sums_[cell]));
}

/// Dormant ground is that and what fell on it.
void Oracle::setDormantHeights() {
  for (int y = 0; y < world_.inside_rows; ++y)
    for (int x = 0; x < world_.inside_columns; ++x) {
      if (isLive({x / rules::kTileSize, y / rules::kTileSize})) continue;
      const std::size_t i = world_.at(x, y);
      world_.height[i] =
          std::int32_t(std::min<std::int64_t>(std::int64_t(crateredBase(i)) + snow_[i], rules::kHeightLimit));
    }
}

void Oracle::addToSums(const Crater& crater) {
  const rules::CraterShape shape = shapeOf(crater);
  const std::int64_t cell_q = base_->pack().cell_q, outer = crater.outerRadius();
  for (int y = 0; y < world_.inside_rows; ++y)
    for (int x = 0; x < world_.inside_columns; ++x) {
      const std::int64_t dx = x * cell_q + cell_q / 2 - crater.x_q, dy = y * cell_q + cell_q / 2 - crater.y_q;
      if (dx * dx + dy * dy > outer * outer) continue;
      rules::CraterSum& sum = crater_sums_[world_.at(x, y)];
      sum = rules::withCrater(sum, rules::craterDisplacement(shape, int(dx), int(dy)), shape.rim);
    }
}

/// Marks cells of live tiles, from that of x - R3 to that of x + R3 and so in y.
void Oracle::markLiveBox(const Crater& crater) {
  const std::int64_t cell_q = base_->pack().cell_q, outer = crater.outerRadius();
  const auto reaches = [&](std::int64_t cell, std::int64_t centre) {
    return cell >= floorDiv(centre - outer, cell_q) && cell <= floorDiv(centre + outer, cell_q);
  };
  for (int y = 0; y < world_.inside_rows; ++y)
    for (int x = 0; x < world_.inside_columns; ++x)
      if (reaches(x, crater.x_q) && reaches(y, crater.y_q) && isLive({x / rules::kTileSize, y / rules::kTileSize}))
        cratered_[world_.at(x, y)] = 1;
}

std::uint64_t Oracle::cratersHash() const {
  std::uint64_t hash = 0;
  for (const Crater& crater : records_) {
    ByteWriter bytes;
    for (const std::int32_t value :
         {crater.x_q, crater.y_q, crater.inner_radius_q, crater.crest_radius_q, crater.rim_height_q, crater.depth_q})
      bytes.put(value);
    bytes.put(crater.noise_seed);
    bytes.put(crater.noise_q16);
    bytes.put(crater.tick);
    bytes.put(crater.id);
    hash = hashBytes(bytes.bytes, mix64(hash));
  }
  return hash;
}

}  // namespace spoor::test
