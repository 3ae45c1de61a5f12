#include "client/gl_context.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <stdexcept>

namespace spoor {

namespace {

const char* errorName(GLenum error) {
  switch (error) {
    case GL_INVALID_ENUM:
      return "GL_INVALID_ENUM";
    case GL_INVALID_VALUE:
      return "GL_INVALID_VALUE";
    case GL_INVALID_OPERATION:
      return "GL_INVALID_OPERATION";
    case GL_INVALID_FRAMEBUFFER_OPERATION:
      return "GL_INVALID_FRAMEBUFFER_OPERATION";
    case GL_OUT_OF_MEMORY:
      return "GL_OUT_OF_MEMORY";
    default:
      return "an unknown GL error";
  }
}

}  // namespace

void checkGl(const char* after) {
  const GLenum error = glGetError();
  if (error != GL_NO_ERROR) throw std::runtime_error(fmt::format("OpenGL: {} after {}", errorName(error), after));
}

}  // namespace spoor
