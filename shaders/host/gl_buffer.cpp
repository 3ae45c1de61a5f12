#include "shaders/host/gl_buffer.h"

#include <algorithm>

#include "shaders/host/gl_context.h"

namespace spoor {
namespace {

constexpr std::int64_t kLeastBytes = 4096;
constexpr int kLongestWait_s = 120;  // for one tick; a device that takes longer hangs

}  // namespace

Status GrowingBuffer::reserve(std::int64_t bytes) {
  if (bytes <= bytes_) return {};
  if (bytes > limit_bytes_)
    return Error{"gl: " + name_ + " needs " + std::to_string(bytes) + " bytes, the renderer binds " +
                 std::to_string(limit_bytes_) + " as one storage block"};
  const std::int64_t size = std::min(std::max({bytes, 2 * bytes_, kLeastBytes}), limit_bytes_);
  GlBuffer larger = makeBuffer();
  glNamedBufferStorage(larger.name(), size, nullptr, GL_DYNAMIC_STORAGE_BIT);
  if (Status status = glStatus("making " + name_ + " of " + std::to_string(size) + " bytes"); !status) return status;
  if (content_ == Content::zeroed) glClearNamedBufferData(larger.name(), GL_R32I, GL_RED_INTEGER, GL_INT, nullptr);
  if (content_ == Content::kept && bytes_ > 0) glCopyNamedBufferSubData(name(), larger.name(), 0, 0, bytes_);
  buffer_ = std::move(larger);
  bytes_ = size;
  return {};
}

void GrowingBuffer::bind(int binding) const {
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, GLuint(binding), buffer_.name());
}

Status ReadbackBuffer::reserve(std::int64_t bytes) {
  if (bytes <= bytes_) return {};
  const std::int64_t size = std::max({bytes, 2 * bytes_, kLeastBytes});
  constexpr GLbitfield kAccess = GL_MAP_READ_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
  GlBuffer larger = makeBuffer();
  glNamedBufferStorage(larger.name(), size, nullptr, kAccess | GL_CLIENT_STORAGE_BIT);
  const void* mapped = glMapNamedBufferRange(larger.name(), 0, size, kAccess);
  if (Status status = glStatus("making " + name_ + " of " + std::to_string(size) + " bytes"); !status) return status;
  if (mapped == nullptr) return Error{"gl: " + name_ + " cannot be mapped"};
  buffer_ = std::move(larger);
  data_ = static_cast<const std::uint8_t*>(mapped);
  bytes_ = size;
  return {};
}

void GlFence::place() {
  if (sync_ != nullptr) glDeleteSync(sync_);
  sync_ = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
  glFlush();
}

Status GlFence::wait(const std::string& what) {
  constexpr GLuint64 kSecond_ns = 1000000000;
  for (int waited_s = 0; waited_s < kLongestWait_s; ++waited_s) {
    const GLenum passed = glClientWaitSync(sync_, 0, kSecond_ns);
    if (Status status = contextStatus(); !status) return Error{"gl: " + what + ": " + status.error()};
    if (passed == GL_ALREADY_SIGNALED || passed == GL_CONDITION_SATISFIED) return {};
    if (passed != GL_TIMEOUT_EXPIRED) return Error{"gl: " + what + ": the wait for the device failed"};
  }
  return Error{"gl: " + what + ": the device did not finish within " + std::to_string(kLongestWait_s) + " s"};
}

}  // namespace spoor
