#pragma once

#include <epoxy/gl.h>

#include <utility>

namespace spoor {

/// A GL name that this object owns. Move-only; needs its context current when it dies.
template <typename Deleter>
class GlObject {
 public:
  GlObject() = default;
  explicit GlObject(GLuint name) : name_(name) {}
  GlObject(GlObject&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
  GlObject& operator=(GlObject&& other) noexcept {
    if (this != &other) {
      reset();
      name_ = std::exchange(other.name_, 0);
    }
    return *this;
  }
  ~GlObject() { reset(); }

  GLuint name() const { return name_; }

 private:
  void reset() {
    if (name_ != 0) Deleter::destroy(name_);
    name_ = 0;
  }
  GLuint name_ = 0;
};

struct BufferDeleter {
  static void destroy(GLuint name) { glDeleteBuffers(1, &name); }
};
struct TextureDeleter {
  static void destroy(GLuint name) { glDeleteTextures(1, &name); }
};
struct FramebufferDeleter {
  static void destroy(GLuint name) { glDeleteFramebuffers(1, &name); }
};
struct RenderbufferDeleter {
  static void destroy(GLuint name) { glDeleteRenderbuffers(1, &name); }
};
struct VertexArrayDeleter {
  static void destroy(GLuint name) { glDeleteVertexArrays(1, &name); }
};
struct ProgramDeleter {
  static void destroy(GLuint name) { glDeleteProgram(name); }
};
struct ShaderDeleter {
  static void destroy(GLuint name) { glDeleteShader(name); }
};

using GlBuffer = GlObject<BufferDeleter>;
using GlTexture = GlObject<TextureDeleter>;
using GlFramebuffer = GlObject<FramebufferDeleter>;
using GlRenderbuffer = GlObject<RenderbufferDeleter>;
using GlVertexArray = GlObject<VertexArrayDeleter>;
using GlProgram = GlObject<ProgramDeleter>;
using GlShader = GlObject<ShaderDeleter>;

inline GlBuffer makeBuffer() {
  GLuint name = 0;
  glCreateBuffers(1, &name);
  return GlBuffer(name);
}
inline GlTexture makeTexture(GLenum target) {
  GLuint name = 0;
  glCreateTextures(target, 1, &name);
  return GlTexture(name);
}
inline GlFramebuffer makeFramebuffer() {
  GLuint name = 0;
  glCreateFramebuffers(1, &name);
  return GlFramebuffer(name);
}
inline GlRenderbuffer makeRenderbuffer() {
  GLuint name = 0;
  glCreateRenderbuffers(1, &name);
  return GlRenderbuffer(name);
}
inline GlVertexArray makeVertexArray() {
  GLuint name = 0;
  glCreateVertexArrays(1, &name);
  return GlVertexArray(name);
}

}  // namespace spoor
