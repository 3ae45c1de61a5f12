#pragma once

#include "shaders/host/gl_backend.h"
#include "tests/backends.h"

namespace spoor::test {

/// How a gl case's backend is made.
inline GlOptions glOptionsOf(const BackendCase& backend_case) {
  GlOptions options;
  options.thread_count = 1;
  options.shape.group = backend_case.group;
  options.shape.reversed = backend_case.reversed;
  options.schedule = backend_case.fused ? GlOptions::Schedule::fused : GlOptions::Schedule::plain;
  options.skip_settled = backend_case.skip_settled;
  return options;
}

}  // namespace spoor::test
