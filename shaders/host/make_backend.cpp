#include "shaders/host/make_backend.h"

#ifdef SPOOR_WITH_GL
#include "shaders/host/gl_backend.h"
#include "shaders/host/gl_context.h"
#endif

namespace spoor {
namespace {

#ifndef SPOOR_WITH_GL
constexpr const char* kWithoutGl = "the gl backend is not in this build (it needs libepoxy and EGL)";
#endif

using Say = std::function<void(const std::string&)>;

Result<std::unique_ptr<Backend>> openGl(const BackendChoice& choice, bool hardware_only, const Say& say) {
#ifdef SPOOR_WITH_GL
  GlOptions options;
  options.device = choice.gl_device;
  options.hardware_only = hardware_only;
  options.thread_count = choice.thread_count;
  options.say = say;
  return makeGlBackend(options);
#else
  (void)choice, (void)hardware_only, (void)say;
  return Error{kWithoutGl};
#endif
}

}  // namespace

Result<std::unique_ptr<Backend>> makeBackend(const BackendChoice& choice, const Say& say) {
  const NativeOptions native{choice.thread_count, nullptr, true};
  if (choice.name == "native") return makeNativeBackend(native);
  if (choice.name == "gl") return openGl(choice, false, say);
  if (choice.name != "auto") return Error{"backend '" + choice.name + "' is none of auto, gl, native"};
  auto backend = openGl(choice, true, say);
  if (backend) {
    say("backend auto: " + (*backend)->name());
    return backend;
  }
  auto fallback = makeNativeBackend(native);
  say("backend auto: " + fallback->name() + ", since " + backend.error());
  return fallback;
}

std::vector<std::string> listDevices() {
#ifdef SPOOR_WITH_GL
  return listHeadlessDevices();
#else
  return {kWithoutGl};
#endif
}

}  // namespace spoor
