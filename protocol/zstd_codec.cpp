#include "protocol/zstd_codec.h"

#include <zstd.h>

#include <string>

#include "shared/base/assert.h"

namespace spoor {

std::vector<std::uint8_t> zstdCompress(std::span<const std::uint8_t> raw) {
  std::vector<std::uint8_t> stored(ZSTD_compressBound(raw.size()));
  const std::size_t size = ZSTD_compress(stored.data(), stored.size(), raw.data(), raw.size(), 1);
  SPOOR_ASSERT(!ZSTD_isError(size));  // the buffer is large enough by ZSTD_compressBound
  stored.resize(size);
  return stored;
}

Result<std::vector<std::uint8_t>> zstdDecompress(std::span<const std::uint8_t> stored, std::size_t raw_bytes) {
  const unsigned long long stated = ZSTD_getFrameContentSize(stored.data(), stored.size());
  if (stated == ZSTD_CONTENTSIZE_ERROR) return Error{"zstd: not a frame"};
  if (stated == ZSTD_CONTENTSIZE_UNKNOWN) return Error{"zstd: the frame does not state its content size"};
  if (stated != raw_bytes || raw_bytes == 0) {
    return Error{"zstd: the frame holds " + std::to_string(stated) + " bytes, announced were " +
                 std::to_string(raw_bytes)};
  }
  const std::size_t frame_bytes = ZSTD_findFrameCompressedSize(stored.data(), stored.size());
  if (ZSTD_isError(frame_bytes)) return Error{std::string("zstd: ") + ZSTD_getErrorName(frame_bytes)};
  if (frame_bytes != stored.size()) {
    return Error{"zstd: " + std::to_string(stored.size() - frame_bytes) + " bytes after the frame"};
  }
  std::vector<std::uint8_t> raw(raw_bytes);
  const std::size_t size = ZSTD_decompress(raw.data(), raw.size(), stored.data(), stored.size());
  if (ZSTD_isError(size)) return Error{std::string("zstd: ") + ZSTD_getErrorName(size)};
  if (size != raw_bytes) return Error{"zstd: the frame holds fewer bytes than it states"};
  return raw;
}

}  // namespace spoor
