#pragma once

#include <memory>
#include <string>

#include "shaders/host/gl_context.h"

struct GLFWwindow;

namespace spoor {

/// A context with a window, by GLFW. It stays current on the thread that opened it until it dies.
class WindowContext : public GlContext {
 public:
  virtual GLFWwindow* window() const = 0;
};

/// Errors: no display, or the display has no OpenGL 4.5 core.
Result<std::unique_ptr<WindowContext>> openWindowContext(int width_px, int height_px, const std::string& title);

}  // namespace spoor
