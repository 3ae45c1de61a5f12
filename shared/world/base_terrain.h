#pragma once

#include <cstdint>
#include <span>

#include "shaders/rules/limits.h"
#include "shared/world/pack.h"

namespace spoor {

/// The undisturbed ground of a pack, computed on demand, any part of any size of world. Thread-safe (const).
/// Cells outside the world have height 0.
class BaseTerrain {
 public:
  /// The pack must be valid and outlive this.
  explicit BaseTerrain(const ScenePack& pack) : pack_(&pack) {}

  /// Heights of a tile, row-major [kTileCells], 0.1 mm: bedrock + soil depth.
  void fillHeights(TileCoordinate tile, std::span<std::int32_t, rules::kTileCells> height) const;

  /// Every `stride`-th cell from (x, y) on, row-major [rows * columns]: for views from afar.
  void fillArea(std::int32_t x, std::int32_t y, std::int32_t stride, std::int32_t columns, std::int32_t rows,
                std::span<std::int32_t> height) const;

  std::int32_t height(std::int32_t x, std::int32_t y) const;

  /// Numbers of the materials of the same cells as fillArea's (the description map); 0 outside the world.
  void fillMaterials(std::int32_t x, std::int32_t y, std::int32_t stride, std::int32_t columns, std::int32_t rows,
                     std::span<std::int32_t> material) const;

  /// Height at a point between cell centres (0.1 mm units from the south-west corner): bilinear, rounded down.
  /// Points outside the world take the nearest cell's.
  std::int32_t heightAt(std::int32_t x_q, std::int32_t y_q) const;

  const ScenePack& pack() const { return *pack_; }

 private:
  const ScenePack* pack_;
};

}  // namespace spoor
