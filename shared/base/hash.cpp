#include "shared/base/hash.h"

#include <cstring>

namespace spoor {

std::uint64_t hashBytes(std::span<const std::uint8_t> bytes, std::uint64_t seed) {
  std::uint64_t state = mix64(seed ^ (bytes.size() * 0x9e3779b97f4a7c15u));
  while (!bytes.empty()) {
    const auto count = bytes.size() < 8 ? bytes.size() : 8;
    std::uint64_t word = 0;
    std::memcpy(&word, bytes.data(), count);
    // Sequential, so that the order of words matters; the sum keeps a zero word from being invisible.
    state = mix64(state + word * 0x9fb21c651e98df25u + 0x2545f4914f6cdd1du);
    bytes = bytes.subspan(count);
  }
  return state;
}

}  // namespace spoor
