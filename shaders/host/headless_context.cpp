#include <dlfcn.h>
#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <array>
#include <span>
#include <string_view>

#include "shaders/host/gl_context.h"

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

std::string inBrackets(const char* reason) { return std::string(" (") + reason + ")"; }

void releaseCurrent(EGLDisplay display) { eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT); }

/// An OpenGL 4.5 core context that is lost on a reset, or where the driver cannot say so, one that is not.
EGLContext createContext(EGLDisplay display, EGLConfig config, EGLint notification) {
  constexpr std::array<EGLint, 6> kVersion{EGL_CONTEXT_MAJOR_VERSION,       4,
                                           EGL_CONTEXT_MINOR_VERSION,       5,
                                           EGL_CONTEXT_OPENGL_PROFILE_MASK, EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT};
  std::vector<EGLint> attributes(kVersion.begin(), kVersion.end());
  if (notification != EGL_NONE) {
    attributes.insert(attributes.end(), {notification, EGL_LOSE_CONTEXT_ON_RESET, EGL_NONE});
    const EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, attributes.data());
    if (context != EGL_NO_CONTEXT) return context;
    attributes.resize(kVersion.size());
  }
  attributes.push_back(EGL_NONE);
  return eglCreateContext(display, config, EGL_NO_CONTEXT, attributes.data());
}

class EglContext final : public HeadlessContext {
 public:
  explicit EglContext(EGLDisplay display) : display_(display) {}
  ~EglContext() override {
    if (context_ == EGL_NO_CONTEXT) return;
    release();
    eglDestroyContext(display_, context_);
    // The display stays initialised: EGL hands the same one to everybody in the process who asks for it.
  }

  /// Makes the context; what is current stays so.
  Status create(const std::string& path) {
    path_ = path;
    EGLint major = 0, minor = 0;
    if (!eglInitialize(display_, &major, &minor)) return Error{"cannot start" + inBrackets(eglErrorName())};
    const std::string version = "EGL " + std::to_string(major) + "." + std::to_string(minor);
    if (!eglBindAPI(EGL_OPENGL_API)) return Error{version + " without OpenGL"};
    const char* extensions = eglQueryString(display_, EGL_EXTENSIONS);
    if (!listed(extensions, "EGL_KHR_surfaceless_context"))
      return Error{version + " without EGL_KHR_surfaceless_context"};
    EGLConfig config = EGL_NO_CONFIG_KHR;
    if (!listed(extensions, "EGL_KHR_no_config_context")) {
      const std::array<EGLint, 5> wanted{EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT,
                                         EGL_NONE};
      EGLint count = 0;
      if (!eglChooseConfig(display_, wanted.data(), &config, 1, &count) || count < 1)
        return Error{version + " without a config for OpenGL"};
    }
    EGLint notification = EGL_NONE;
    if (major > 1 || minor >= 5 || listed(extensions, "EGL_KHR_create_context"))
      notification = EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY;
    else if (listed(extensions, "EGL_EXT_create_context_robustness"))
      notification = EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY_EXT;
    context_ = createContext(display_, config, notification);
    if (context_ == EGL_NO_CONTEXT) return Error{"no OpenGL 4.5 core" + inBrackets(eglErrorName())};
    return {};
  }

  /// Makes it current for the first time. On failure what was current stays so.
  Status start() {
    if (!makeCurrent()) return Error{"the context cannot be made current" + inBrackets(eglErrorName())};
    renderer_ = glText(GL_RENDERER);
    return {};
  }

  bool makeCurrent() override {
    eglBindAPI(EGL_OPENGL_API);  // a thread's choice, and another one at first
    return eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) == EGL_TRUE;
  }
  void release() override {
    if (!isCurrent()) return;
    eglBindAPI(EGL_OPENGL_API);
    releaseCurrent(display_);
  }
  bool isCurrent() const override { return eglGetCurrentContext() == context_; }

 private:
  EGLDisplay display_;
  EGLContext context_ = EGL_NO_CONTEXT;
};

struct Platform {
  std::string path;
  std::string name;  ///< what openHeadlessContext takes for it
  EGLDisplay display;
};

/// Can a library be loaded? epoxy would end the program where it cannot.
bool loads(const char* library) {
  void* const handle = dlopen(library, RTLD_LAZY | RTLD_LOCAL);
  if (handle != nullptr) dlclose(handle);
  return handle != nullptr;
}

/// Every display worth a try, in order. Errors: no EGL, no OpenGL.
Result<std::vector<Platform>> platforms() {
  if (!loads("libEGL.so.1")) return Error{"headless OpenGL: EGL is missing (libEGL.so.1 cannot be loaded)"};
  if (!loads("libOpenGL.so.0") && !loads("libGL.so.1"))
    return Error{"headless OpenGL: OpenGL is missing (neither libOpenGL.so.0 nor libGL.so.1 can be loaded)"};
  const char* client_extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  if (client_extensions == nullptr) return Error{"headless OpenGL: EGL is missing or lists no client extensions"};
  std::vector<Platform> found;
  if (!listed(client_extensions, "EGL_EXT_platform_base")) return found;
  if (listed(client_extensions, "EGL_MESA_platform_surfaceless"))
    found.push_back(
        {"EGL surfaceless", "surfaceless", eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr)});
  const bool devices =
      listed(client_extensions, "EGL_EXT_device_base") || listed(client_extensions, "EGL_EXT_device_enumeration");
  if (devices && listed(client_extensions, "EGL_EXT_platform_device")) {
    std::array<EGLDeviceEXT, kDeviceLimit> handles{};
    EGLint count = 0;
    if (eglQueryDevicesEXT(kDeviceLimit, handles.data(), &count))
      for (EGLint i = 0; i < count; ++i)
        found.push_back({"EGL device " + std::to_string(i), std::to_string(i),
                         eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, handles[std::size_t(i)], nullptr)});
  }
  return found;
}

Result<std::unique_ptr<EglContext>> createOn(const Platform& platform) {
  if (platform.display == EGL_NO_DISPLAY) return Error{platform.path + ": no display"};
  auto context = std::make_unique<EglContext>(platform.display);
  if (const Status made = context->create(platform.path); !made) return Error{platform.path + ": " + made.error()};
  return context;
}

Result<std::unique_ptr<HeadlessContext>> openFirst(std::span<const Platform> choice) {
  std::string lacking;
  std::unique_ptr<EglContext> best;
  for (const auto& platform : choice) {
    auto candidate = createOn(platform);
    if (!candidate) {
      lacking += "; " + candidate.error();
      continue;
    }
    if (const Status started = (*candidate)->start(); !started) {
      lacking += "; " + platform.path + ": " + started.error();
      continue;
    }
    const bool hardware = !(*candidate)->software();
    if (hardware || best == nullptr) best = std::move(*candidate);
    if (hardware) break;
  }
  if (best == nullptr)
    return Error{"headless OpenGL: no OpenGL 4.5 core by EGL" +
                 (lacking.empty() ? std::string("; neither surfaceless platform nor devices are listed") : lacking)};
  if (!best->makeCurrent()) return Error{"headless OpenGL: the context cannot be made current"};
  return std::unique_ptr<HeadlessContext>(std::move(best));
}

std::string describe(const Platform& platform) {
  const auto context = createOn(platform);
  if (!context) return context.error();
  const CurrentContext current(**context);  // before start(): it puts back what is current now
  if (const Status started = (*context)->start(); !started) return platform.path + ": " + started.error();
  return platform.path + ": " + (*context)->renderer() + ", OpenGL " + glText(GL_VERSION);
}

}  // namespace

CurrentContext::CurrentContext(HeadlessContext& context)
    : earlier_{eglGetCurrentDisplay(), eglGetCurrentSurface(EGL_DRAW), eglGetCurrentSurface(EGL_READ),
               eglGetCurrentContext(), eglQueryAPI()} {
  switched_ = !context.isCurrent();
  ok_ = !switched_ || context.makeCurrent();
}

CurrentContext::~CurrentContext() {
  if (!switched_) return;
  const bool back = earlier_.context != EGL_NO_CONTEXT &&
                    eglMakeCurrent(earlier_.display, earlier_.draw, earlier_.read, earlier_.context) == EGL_TRUE;
  // None was current, or it cannot be any more: then none is, rather than the wrong one.
  if (const EGLDisplay display = eglGetCurrentDisplay(); !back && display != EGL_NO_DISPLAY) releaseCurrent(display);
  eglBindAPI(earlier_.api);
}

Result<std::unique_ptr<HeadlessContext>> openHeadlessContext(const std::string& device) {
  const auto all = platforms();
  if (!all) return Error{all.error()};
  if (device == "auto") return openFirst(*all);
  for (const auto& platform : *all)
    if (platform.name == device) return openFirst(std::span(&platform, 1));
  std::string message = "headless OpenGL: no device \"" + device + "\"; want auto";
  for (const auto& platform : *all) message += ", " + platform.name;
  for (const auto& line : listHeadlessDevices()) message += "; " + line;
  return Error{message};
}

std::vector<std::string> listHeadlessDevices() {
  const auto all = platforms();
  if (!all) return {all.error()};
  std::vector<std::string> lines;
  for (const auto& platform : *all) lines.push_back(describe(platform));
  return lines;
}

}  // namespace spoor
