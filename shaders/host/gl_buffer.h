#pragma once

#include <cstdint>
#include <string>

#include "shaders/host/gl_objects.h"
#include "shared/base/result.h"

namespace spoor {

/// A buffer in device memory that grows by doubling, up to what the renderer binds as one storage block.
class GrowingBuffer {
 public:
  enum class Content { lost, kept, zeroed };  // what growing does to the cells

  /// @param name         for errors
  /// @param limit_bytes  GlLimits::storage_block_bytes
  GrowingBuffer(std::string name, std::int64_t limit_bytes, Content content = Content::lost)
      : name_(std::move(name)), limit_bytes_(limit_bytes), content_(content) {}

  /// Makes room for at least `bytes` (and at least a little). Zeroed: all of it is 0 where it grew.
  /// Errors, which leave the buffer as it was: more than the limit; the device has not the memory.
  [[nodiscard]] Status reserve(std::int64_t bytes);

  void bind(int binding) const;
  GLuint name() const { return buffer_.name(); }
  std::int64_t bytes() const { return bytes_; }

 private:
  std::string name_;
  std::int64_t limit_bytes_;
  Content content_;
  std::int64_t bytes_ = 0;
  GlBuffer buffer_;
};

/// A buffer that the device writes and the host reads in place, mapped as long as it lives.
class ReadbackBuffer {
 public:
  explicit ReadbackBuffer(std::string name) : name_(std::move(name)) {}

  /// Makes room; what it held is lost. Errors: the memory cannot be had or mapped.
  [[nodiscard]] Status reserve(std::int64_t bytes);

  GLuint name() const { return buffer_.name(); }
  /// What the device wrote; valid once the fence after it has been passed.
  const std::uint8_t* data() const { return data_; }
  std::int64_t bytes() const { return bytes_; }

 private:
  std::string name_;
  std::int64_t bytes_ = 0;
  GlBuffer buffer_;
  const std::uint8_t* data_ = nullptr;
};

/// A point in the device's queue.
class GlFence {
 public:
  GlFence() = default;
  GlFence(GlFence&& other) noexcept : sync_(std::exchange(other.sync_, nullptr)) {}
  GlFence& operator=(GlFence&& other) noexcept {
    std::swap(sync_, other.sync_);
    return *this;
  }
  ~GlFence() {
    if (sync_ != nullptr) glDeleteSync(sync_);
  }

  /// After everything asked of the device so far.
  void place();
  /// Waits until the device is past it. Errors: the context was lost, the wait itself failed, or took minutes.
  [[nodiscard]] Status wait(const std::string& what);

 private:
  GLsync sync_ = nullptr;
};

}  // namespace spoor
