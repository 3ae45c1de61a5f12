#pragma once

#include <cstdint>
#include <vector>

namespace spoor {

/// Fills samples without data, in waves from the valid ones inwards: a sample takes the mean (rounded down) of its side
/// neighbours of earlier waves, so that each gap is closed from its whole rim. Integers, and no order shows; GDAL's own
/// filler interpolates in floats and gives up at a distance.
/// @param height_q  in/out, [rows * columns]
/// @param missing   1 for each sample to fill; at least one must be 0. Used up: left without meaning
void fillMissing(std::vector<std::int32_t>& height_q, std::vector<std::uint8_t>& missing, std::int32_t columns);

}  // namespace spoor
