#pragma once

#include <functional>
#include <memory>
#include <string>

#include "shaders/host/gl_stages.h"
#include "shared/sim/backend.h"

namespace spoor {

struct GlOptions {
  std::string device = "auto";  // openHeadlessContext
  bool hardware_only = false;   // refuse a software renderer
  int thread_count = 0;         // for making tiles live; 0: one for each processor
  GroupShape shape;
  enum class Schedule { by_renderer, plain, fused } schedule = Schedule::by_renderer;
  bool skip_settled = true;                          // false: every sweep visits every pair (for measuring)
  int pool_tiles = 1 << 16;                          // live tiles kept on the device at most, where there is room
  std::function<void(const std::string&)> say = {};  // what should be known: the renderer, a full pool
};

/// The backend `gl`: stages 2 and 4 to 9 in compute shaders. Live tiles stay on the device, and craters, from the first
/// on that changes one; what comes back is a result of 56 bytes for each active tile and the changed cells.
/// Errors: no context, a limit that is too low, a shader that does not compile (with file and line).
Result<std::unique_ptr<Backend>> makeGlBackend(const GlOptions& options = {});

}  // namespace spoor
