#include "client/gl_window.h"

#include <epoxy/gl.h>
// After epoxy, which replaces the system's GL header.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>

namespace spoor {

namespace {

std::string glfwProblem() {
  const char* text = nullptr;
  glfwGetError(&text);
  return text == nullptr ? "no reason given" : text;
}

class GlfwWindow final : public WindowContext {
 public:
  GlfwWindow() { initialised_ = glfwInit() == GLFW_TRUE; }
  ~GlfwWindow() override {
    if (window_ != nullptr) glfwDestroyWindow(window_);
    if (initialised_) glfwTerminate();
  }

  Status open(int width_px, int height_px, const std::string& title) {
    if (!initialised_) return Error{fmt::format("window: no display ({}); --headless needs none", glfwProblem())};
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    window_ = glfwCreateWindow(width_px, height_px, title.c_str(), nullptr, nullptr);
    if (window_ == nullptr) return Error{fmt::format("window: no OpenGL 4.5 core on this display ({})", glfwProblem())};
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(1);
    renderer_ = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
    path_ = "window";
    return {};
  }

  GLFWwindow* window() const override { return window_; }

 private:
  bool initialised_ = false;
  GLFWwindow* window_ = nullptr;
};

}  // namespace

Result<std::unique_ptr<WindowContext>> openWindowContext(int width_px, int height_px, const std::string& title) {
  auto context = std::make_unique<GlfwWindow>();
  if (const Status opened = context->open(width_px, height_px, title); !opened) return Error{opened.error()};
  return std::unique_ptr<WindowContext>(std::move(context));
}

}  // namespace spoor
