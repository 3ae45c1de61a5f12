#include "protocol/bulk.h"

#include <algorithm>

#include "protocol/zstd_codec.h"
#include "shared/base/assert.h"

namespace spoor {

BulkPackage makeBulkPackage(BulkKind kind, std::vector<std::uint8_t> raw) {
  SPOOR_ASSERT(!raw.empty());
  BulkPackage package{kind, false, raw.size(), {}};
  auto compressed = zstdCompress(raw);
  package.compressed = compressed.size() < raw.size();
  package.stored = package.compressed ? std::move(compressed) : std::move(raw);
  package.stored.shrink_to_fit();
  return package;
}

BulkChunk chunkAt(const BulkPackage& package, std::uint64_t offset) {
  SPOOR_ASSERT(offset < package.stored.size());
  const std::size_t size = std::min<std::size_t>(kBulkChunkBytes, package.stored.size() - std::size_t(offset));
  const auto piece = std::span(package.stored).subspan(std::size_t(offset), size);
  return BulkChunk{package.kind, package.compressed,          package.raw_bytes, package.stored.size(),
                   offset,       {piece.begin(), piece.end()}};
}

Status BulkAssembler::add(const BulkChunk& chunk) {
  if (chunk.kind != kind_) return Error{"bulk: a chunk of something that was not asked for"};
  if (chunk.offset != stored_.size()) {
    return Error{"bulk: chunk at " + std::to_string(chunk.offset) + ", expected " + std::to_string(stored_.size())};
  }
  if (chunk.offset == 0) {
    compressed_ = chunk.compressed;
    raw_bytes_ = chunk.raw_bytes;
    stored_bytes_ = chunk.stored_bytes;
  } else if (chunk.compressed != compressed_ || chunk.raw_bytes != raw_bytes_ || chunk.stored_bytes != stored_bytes_) {
    return Error{"bulk: chunks disagree about the whole"};
  }
  if (chunk.bytes.size() > stored_bytes_ - stored_.size()) return Error{"bulk: a chunk past the end of the whole"};
  stored_.insert(stored_.end(), chunk.bytes.begin(), chunk.bytes.end());
  return {};
}

Result<std::vector<std::uint8_t>> BulkAssembler::unpack() const {
  SPOOR_ASSERT(complete());
  if (!compressed_) return stored_;
  return zstdDecompress(stored_, std::size_t(raw_bytes_));
}

}  // namespace spoor
