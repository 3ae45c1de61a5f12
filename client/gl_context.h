#pragma once

#include <memory>
#include <string>

#include "shared/base/result.h"

struct GLFWwindow;

namespace spoor {

/// A current OpenGL 4.5 core context. It stays current on the thread that made it until it dies.
class GlContext {
 public:
  virtual ~GlContext() = default;
  /// What draws, as the driver names it.
  const std::string& renderer() const { return renderer_; }
  /// How it was reached, for messages: "EGL surfaceless", "EGL device 0", "window".
  const std::string& path() const { return path_; }

 protected:
  std::string renderer_;
  std::string path_;
};

/// A context without a window, by EGL: Mesa's surfaceless platform, then each EGL device. The first hardware renderer
/// is taken, else the first software one. Errors: no EGL, or what each attempt lacked.
Result<std::unique_ptr<GlContext>> openHeadlessContext();

/// A context with a window, by GLFW.
class WindowContext : public GlContext {
 public:
  virtual GLFWwindow* window() const = 0;
};

/// Errors: no display, or the display has no OpenGL 4.5 core.
Result<std::unique_ptr<WindowContext>> openWindowContext(int width_px, int height_px, const std::string& title);

/// Throws std::runtime_error with the error's name where GL recorded one. `after` says what was done.
void checkGl(const char* after);

}  // namespace spoor
