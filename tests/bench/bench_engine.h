#pragma once

#include <functional>
#include <memory>
#include <string>

#include "shared/sim/backend.h"

namespace spoor {

using Say = std::function<void(const std::string&)>;

/// What a run computes with.
struct Engine {
  bool on_gl = false;
  bool skip_settled = true;          // false: every sweep visits every pair
  int thread_count = 0;              // 0: one for each processor
  const Kernels* kernels = nullptr;  // native; nullptr: the fastest
  std::string gl_device = "auto";    // gl
  std::string gl_schedule = "auto";  // gl; "auto", "plain" or "fused"
  int gl_group = 0;                  // gl; lanes of a group: 64, 128 or 256; 0: as the backend likes
  Say say = [](const std::string&) {};
};

/// Errors: gl is not in this build, or not to be had.
Result<std::unique_ptr<Backend>> openEngine(const Engine& engine);

/// Whether a backend by this name is gl; "auto" is where there is a hardware renderer, and says what it took.
/// Errors: a name that is none of auto, gl, native.
Result<bool> runsOnGl(const std::string& backend, const std::string& gl_device, const Say& say);

/// Speed at which the device copies within its memory, 10^9 bytes read and written per second.
/// Errors: gl is not in this build, or not to be had.
Result<double> copyBandwidth(const std::string& gl_device);

}  // namespace spoor
