#include "shaders/host/gl_context.h"

#include <epoxy/gl.h>

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
    case GL_CONTEXT_LOST:
      return "GL_CONTEXT_LOST";
    default:
      return "an unknown GL error";
  }
}

}  // namespace

bool GlContext::software() const {
  for (const char* name : {"llvmpipe", "softpipe", "swrast", "SWR", "lavapipe", "Software Rasterizer", "SwiftShader"})
    if (renderer_.find(name) != std::string::npos) return true;
  return false;
}

std::string glText(unsigned name) {
  const GLubyte* text = glGetString(name);
  return text == nullptr ? "unnamed" : reinterpret_cast<const char*>(text);
}

Status glStatus(const std::string& after) {
  const GLenum error = glGetError();
  if (error == GL_NO_ERROR) return {};
  return Error{std::string("OpenGL: ") + errorName(error) + " after " + after};
}

void checkGl(const char* after) {
  if (const Status status = glStatus(after); !status) throw std::runtime_error(status.error());
}

Status contextStatus() {
  switch (glGetGraphicsResetStatus()) {
    case GL_NO_ERROR:
      return {};
    case GL_GUILTY_CONTEXT_RESET:
      return Error{"OpenGL: guilty context reset: the context is lost by what it ran itself"};
    case GL_INNOCENT_CONTEXT_RESET:
      return Error{"OpenGL: innocent context reset: the context is lost by what another one ran"};
    default:
      return Error{"OpenGL: unknown context reset: the context is lost, the driver does not say by whom"};
  }
}

}  // namespace spoor
