#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "protocol/messages.h"
#include "shared/base/result.h"

namespace spoor {

/// A pack or a snapshot, ready to be cut into chunks.
struct BulkPackage {
  BulkKind kind = BulkKind::pack;
  bool compressed = false;
  std::uint64_t raw_bytes = 0;
  std::vector<std::uint8_t> stored;
};

/// Compresses where it helps.
BulkPackage makeBulkPackage(BulkKind kind, std::vector<std::uint8_t> raw);

/// The piece from `offset` on, which must be below the stored size.
BulkChunk chunkAt(const BulkPackage& package, std::uint64_t offset);

/// Puts chunks together again. Memory grows with what has arrived, never with what was announced.
class BulkAssembler {
 public:
  explicit BulkAssembler(BulkKind kind) : kind_(kind) {}

  /// Chunks must come in order and agree with the first. After an error the assembler is of no more use.
  [[nodiscard]] Status add(const BulkChunk& chunk);
  bool complete() const { return stored_bytes_ > 0 && stored_.size() == stored_bytes_; }
  std::uint64_t rawBytes() const { return raw_bytes_; }

  /// The raw bytes; only once complete.
  Result<std::vector<std::uint8_t>> unpack() const;

 private:
  BulkKind kind_;
  bool compressed_ = false;
  std::uint64_t raw_bytes_ = 0;
  std::uint64_t stored_bytes_ = 0;
  std::vector<std::uint8_t> stored_;
};

}  // namespace spoor
