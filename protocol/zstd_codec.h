#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "shared/base/result.h"

namespace spoor {

/// One zstd frame (level 1) that states its content size.
std::vector<std::uint8_t> zstdCompress(std::span<const std::uint8_t> raw);

/// Safe on untrusted bytes: `stored` must be exactly one frame whose stated content size is `raw_bytes`, which the
/// caller has compared with a limit. Decoded in one go into a buffer of that size: zstd keeps no window of its own,
/// whatever window the frame asks for.
Result<std::vector<std::uint8_t>> zstdDecompress(std::span<const std::uint8_t> stored, std::size_t raw_bytes);

}  // namespace spoor
