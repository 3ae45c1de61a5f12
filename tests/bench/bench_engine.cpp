#include "tests/bench/bench_engine.h"

#ifdef SPOOR_WITH_GL
#include "shaders/host/copy_bandwidth.h"
#include "shaders/host/gl_backend.h"
#endif

namespace spoor {
namespace {

#ifdef SPOOR_WITH_GL

Result<std::unique_ptr<Backend>> openGl(const Engine& engine, bool hardware_only) {
  using Schedule = GlOptions::Schedule;
  GlOptions options;
  options.device = engine.gl_device;
  options.hardware_only = hardware_only;
  options.thread_count = engine.thread_count;
  if (engine.gl_group != 0) options.shape.group = engine.gl_group;
  options.schedule = engine.gl_schedule == "plain"   ? Schedule::plain
                     : engine.gl_schedule == "fused" ? Schedule::fused
                                                     : Schedule::by_renderer;
  options.skip_settled = engine.skip_settled;
  options.say = engine.say;
  return makeGlBackend(options);
}

#else

constexpr const char* kWithoutGl = "the gl backend is not in this build (it needs libepoxy and EGL)";

Result<std::unique_ptr<Backend>> openGl(const Engine&, bool) { return Error{kWithoutGl}; }

#endif

}  // namespace

Result<std::unique_ptr<Backend>> openEngine(const Engine& engine) {
  if (engine.on_gl) return openGl(engine, false);
  return makeNativeBackend({engine.thread_count, engine.kernels, engine.skip_settled});
}

Result<bool> runsOnGl(const std::string& backend, const std::string& gl_device, const Say& say) {
  if (backend == "native" || backend == "gl") return backend == "gl";
  if (backend != "auto") return Error{"backend '" + backend + "' is none of auto, gl, native"};
  Engine engine;
  engine.gl_device = gl_device;
  const auto opened = openGl(engine, true);
  say("backend auto: " + (opened ? (*opened)->name() : "native, since " + opened.error()));
  return bool(opened);
}

Result<double> copyBandwidth(const std::string& gl_device) {
#ifdef SPOOR_WITH_GL
  return measureCopyBandwidth(gl_device);
#else
  (void)gl_device;
  return Error{kWithoutGl};
#endif
}

}  // namespace spoor
