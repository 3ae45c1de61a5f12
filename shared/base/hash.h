#pragma once

#include <cstdint>
#include <span>

namespace spoor {

/// A bijection of 64 bits with full avalanche.
constexpr std::uint64_t mix64(std::uint64_t v) {
  v ^= v >> 32;
  v *= 0xd6e8feb86659fd93u;
  v ^= v >> 32;
  v *= 0xd6e8feb86659fd93u;
  v ^= v >> 32;
  return v;
}

/// Hash of bytes; different seeds give independent hashes.
std::uint64_t hashBytes(std::span<const std::uint8_t> bytes, std::uint64_t seed = 0);

}  // namespace spoor
