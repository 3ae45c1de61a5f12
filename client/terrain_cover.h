#pragma once

#include <cstdint>
#include <span>

#include "client/terrain_view.h"

namespace spoor {

/// What a sample of a terrain level shows of what lies there, as the cover maps hold it.
struct CoverSample {
  std::uint8_t material = 0;
  std::uint8_t snow = 0;  // how much of the ground snowfalls hide, 255: all
  bool operator==(const CoverSample&) const = default;
};

/// Fallen snow of this depth hides the ground.
inline constexpr std::int32_t kWhiteSnow_q = 40;

/// Covers of a box of samples, laid out as fillSamples lays out heights. A sample has its middle cell's material. Snow
/// shows by its depth; not where a live tile's ground lies higher or lower than it would have lain untouched by more
/// than what fell: there bodies laid bare what is beneath, and what fell into a track has not filled it yet.
/// Thread-safe where nobody changes the state.
void fillCover(const TerrainView& view, int level, const SampleBox& box, std::span<CoverSample> cover);

}  // namespace spoor
