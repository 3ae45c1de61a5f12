#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <fmt/format.h>

#include <array>
#include <cstring>
#include <string_view>
#include <vector>

#include "client/gl_context.h"

namespace spoor {

namespace {

constexpr EGLint kDeviceLimit = 16;

const char* eglErrorName() {
  switch (eglGetError()) {
    case EGL_NOT_INITIALIZED:
      return "EGL_NOT_INITIALIZED";
    case EGL_BAD_ALLOC:
      return "EGL_BAD_ALLOC";
    case EGL_BAD_ATTRIBUTE:
      return "EGL_BAD_ATTRIBUTE";
    case EGL_BAD_CONFIG:
      return "EGL_BAD_CONFIG";
    case EGL_BAD_MATCH:
      return "EGL_BAD_MATCH";
    case EGL_BAD_DISPLAY:
      return "EGL_BAD_DISPLAY";
    case EGL_BAD_PARAMETER:
      return "EGL_BAD_PARAMETER";
    case EGL_SUCCESS:
      return "no EGL error given";
    default:
      return "another EGL error";
  }
}

bool listed(const char* extensions, std::string_view wanted) {
  std::string_view rest = extensions == nullptr ? "" : extensions;
  while (!rest.empty()) {
    const auto end = rest.find(' ');
    if (rest.substr(0, end) == wanted) return true;
    if (end == std::string_view::npos) break;
    rest.remove_prefix(end + 1);
  }
  return false;
}

class HeadlessContext final : public GlContext {
 public:
  explicit HeadlessContext(EGLDisplay display) : display_(display) {}
  ~HeadlessContext() override {
    if (context_ != EGL_NO_CONTEXT) {
      eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
      eglDestroyContext(display_, context_);
    }
    // The display stays initialised: EGL hands the same one to everybody in the process who asks for it.
  }

  /// Makes the context and makes it current.
  Status open(std::string path) {
    path_ = std::move(path);
    EGLint major = 0, minor = 0;
    if (!eglInitialize(display_, &major, &minor)) return Error{fmt::format("cannot start ({})", eglErrorName())};
    if (!eglBindAPI(EGL_OPENGL_API)) return Error{fmt::format("EGL {}.{} without OpenGL", major, minor)};
    const char* extensions = eglQueryString(display_, EGL_EXTENSIONS);
    if (!listed(extensions, "EGL_KHR_surfaceless_context"))
      return Error{fmt::format("EGL {}.{} without EGL_KHR_surfaceless_context", major, minor)};
    EGLConfig config = EGL_NO_CONFIG_KHR;
    if (!listed(extensions, "EGL_KHR_no_config_context")) {
      const std::array<EGLint, 5> wanted{EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT,
                                         EGL_NONE};
      EGLint count = 0;
      if (!eglChooseConfig(display_, wanted.data(), &config, 1, &count) || count < 1)
        return Error{fmt::format("EGL {}.{} without a config for OpenGL", major, minor)};
    }
    const std::array<EGLint, 7> attributes{
        EGL_CONTEXT_MAJOR_VERSION,           4,       EGL_CONTEXT_MINOR_VERSION, 5, EGL_CONTEXT_OPENGL_PROFILE_MASK,
        EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
    context_ = eglCreateContext(display_, config, EGL_NO_CONTEXT, attributes.data());
    if (context_ == EGL_NO_CONTEXT) return Error{fmt::format("no OpenGL 4.5 core ({})", eglErrorName())};
    if (!makeCurrent()) return Error{fmt::format("the context cannot be made current ({})", eglErrorName())};
    renderer_ = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
    return {};
  }

  bool makeCurrent() { return eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) == EGL_TRUE; }

  bool software() const {
    for (const char* name : {"llvmpipe", "softpipe", "swrast", "SWR", "lavapipe", "Software Rasterizer"})
      if (renderer_.find(name) != std::string::npos) return true;
    return false;
  }

 private:
  EGLDisplay display_;
  EGLContext context_ = EGL_NO_CONTEXT;
};

struct Platform {
  std::string path;
  EGLDisplay display;
};

/// Every display worth a try, in order.
std::vector<Platform> platforms(const char* client_extensions) {
  std::vector<Platform> found;
  if (!listed(client_extensions, "EGL_EXT_platform_base")) return found;
  if (listed(client_extensions, "EGL_MESA_platform_surfaceless"))
    found.push_back({"EGL surfaceless", eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr)});
  const bool devices =
      listed(client_extensions, "EGL_EXT_device_base") || listed(client_extensions, "EGL_EXT_device_enumeration");
  if (devices && listed(client_extensions, "EGL_EXT_platform_device")) {
    std::array<EGLDeviceEXT, kDeviceLimit> handles{};
    EGLint count = 0;
    if (eglQueryDevicesEXT(kDeviceLimit, handles.data(), &count))
      for (EGLint i = 0; i < count; ++i)
        found.push_back({fmt::format("EGL device {}", i),
                         eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, handles[std::size_t(i)], nullptr)});
  }
  return found;
}

}  // namespace

Result<std::unique_ptr<GlContext>> openHeadlessContext() {
  const char* client_extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  if (client_extensions == nullptr) return Error{"headless OpenGL: EGL is missing or lists no client extensions"};
  std::string lacking;
  std::unique_ptr<HeadlessContext> best;
  for (const auto& platform : platforms(client_extensions)) {
    if (platform.display == EGL_NO_DISPLAY) {
      lacking += fmt::format("; {}: no display", platform.path);
      continue;
    }
    auto candidate = std::make_unique<HeadlessContext>(platform.display);
    if (const Status opened = candidate->open(platform.path); !opened) {
      lacking += fmt::format("; {}: {}", platform.path, opened.error());
      continue;
    }
    const bool hardware = !candidate->software();
    if (hardware || best == nullptr) best = std::move(candidate);
    if (hardware) break;
  }
  if (best == nullptr)
    return Error{"headless OpenGL: no OpenGL 4.5 core by EGL" +
                 (lacking.empty() ? std::string("; neither surfaceless platform nor devices are listed") : lacking)};
  if (!best->makeCurrent()) return Error{"headless OpenGL: the context cannot be made current"};
  return std::unique_ptr<GlContext>(std::move(best));
}

}  // namespace spoor
