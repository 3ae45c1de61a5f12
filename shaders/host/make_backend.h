#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "shared/sim/backend.h"

namespace spoor {

/// What a program lets its user choose.
struct BackendChoice {
  std::string name = "auto";  // "gl", "native", or "auto": gl on a hardware renderer, native on a software one or none
  std::string gl_device = "auto";
  int thread_count = 0;  // 0: one for each processor
};

/// The chosen backend. `say` is told what "auto" took and why, and what gl found.
/// Errors: a name that is none of these; gl asked for and not to be had, or not in this build.
Result<std::unique_ptr<Backend>> makeBackend(const BackendChoice& choice,
                                             const std::function<void(const std::string&)>& say);

/// A line for each device that gl can be asked to run on, or what it lacks.
std::vector<std::string> listDevices();

}  // namespace spoor
