#include "client/crater_colours.h"

#include <fmt/format.h>

#include <stdexcept>

#include "shaders/render/frame.h"

namespace spoor {

namespace {

/// Bytes of a storage block, of a renderer whose fragment shaders have enough of them.
std::int64_t checkedBlockBytes() {
  GLint blocks = 0;
  glGetIntegerv(GL_MAX_FRAGMENT_SHADER_STORAGE_BLOCKS, &blocks);
  if (blocks < render::kCraterBlocks)
    throw std::runtime_error(
        fmt::format("OpenGL: GL_MAX_FRAGMENT_SHADER_STORAGE_BLOCKS is {}, drawing craters needs {}", blocks,
                    render::kCraterBlocks));
  GLint64 bytes = 0;
  glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &bytes);
  return bytes;
}

}  // namespace

CraterColours::CraterColours() : table_(checkedBlockBytes()) {}

bool CraterColours::goesOn(const CraterSet& craters) const {
  return craters.size() >= count_ && (!newest_ || craters.records()[count_ - 1] == *newest_);
}

void CraterColours::update(const CraterSet& craters, std::int32_t cell_q) {
  if (craters.size() == count_) return;
  if (const Status sent = table_.update(craters, cell_q); !sent) throw std::runtime_error(sent.error());
  count_ = craters.size();
  newest_ = craters.records().back();
}

void CraterColours::bind() const { table_.bind(render::kCraterBinding); }

void CraterColours::forget() {
  table_.forget();
  count_ = 0;
  newest_.reset();
}

}  // namespace spoor
