#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <span>

#include "shared/world/state.h"

namespace spoor {

/// The ground as a renderer sees it: dormant tiles are the base with the state's craters and snow, live ones the
/// state's heights. Borrows both.
struct TerrainView {
  const BaseTerrain* base = nullptr;
  const WorldState* state = nullptr;
};

/// Samples of one terrain level (shaders/render/frame.h): first sample and count along x and y.
struct SampleBox {
  glm::ivec2 first{0};
  glm::ivec2 count{0};
};

/// Heights of a box of samples, row-major [count.x * count.y], 0.1 mm.
/// Level 0 samples are cells. A sample of another level is dormant ground at the middle of its cells; in a live tile it
/// is the base there plus the mean of what its cells gained or lost, by craters and snow too. Of levels coarser than a
/// tile all is dormant ground. The ground beyond the world's border mirrors the dormant ground within, so that pictures
/// reach the horizon. `box` is made of whole tiles where a tile has a sample at all. Thread-safe where nobody changes
/// the state.
void fillSamples(const TerrainView& view, int level, const SampleBox& box, std::span<std::int32_t> height_q);

/// Values of every `stride`-th cell from `first_cell` on, row-major [count.x * count.y], mirrored at the borders of a
/// world of `size` cells.
/// @param fill  fills in the values of cells within the world: the first, how many along x and y, and where to
void fillMirrored(glm::ivec2 size, glm::ivec2 first_cell, int stride, glm::ivec2 count, std::span<std::int32_t> out,
                  const std::function<void(glm::ivec2, glm::ivec2, std::span<std::int32_t>)>& fill);

/// Calls visit(tile, its first sample, samples along its side, place of that sample in the box) for each live tile
/// that a level shows in a box of whole tiles.
void forEachLiveTile(const TerrainView& view, int level, const SampleBox& box,
                     const std::function<void(const Tile&, glm::ivec2, int, std::size_t)>& visit);

}  // namespace spoor
