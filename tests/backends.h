#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "shared/sim/backend.h"

namespace spoor::test {

/// A backend with one of its schedules. None of it may change one bit, so every stage and scene is tested on all.
struct BackendCase {
  std::string name;  // of letters and digits, for tests' names
  bool gl = false;
  bool skip_settled = true;
  // native:
  int thread_count = 1;
  bool baseline_kernels = false;
  // gl:
  int group = 64;  // lanes
  bool reversed = false;
  bool fused = false;
  /// Software renderers take ten times as long for fused sweeps: tests give such a case less to do.
  bool slow() const { return fused; }
};
inline void PrintTo(const BackendCase& backend_case, std::ostream* out) { *out << backend_case.name; }

/// Native ones first. Those of gl are listed wherever they are in the build, if they can run or not: see lackOf.
std::vector<BackendCase> backendCases();
std::vector<BackendCase> nativeCases();
std::vector<BackendCase> glCases();

/// What this machine lacks to run a case at all, as no OpenGL; empty where nothing.
const std::string& lackOf(const BackendCase& backend_case);

/// A backend for one new Simulation (whose constructor makes it forget). Those of gl are costly to make, so they go
/// back on a shelf when they are destroyed, and the next Simulation takes them from there.
/// Throws std::runtime_error where it cannot be made, as when a shader does not compile.
std::unique_ptr<Backend> borrowBackend(const BackendCase& backend_case);

/// A test that runs on each of some cases, and says why where it skips one.
class OnEveryBackend : public ::testing::TestWithParam<BackendCase> {
 protected:
  void SetUp() override {
    if (const std::string& lack = lackOf(GetParam()); !lack.empty()) GTEST_SKIP() << lack;
  }
};

inline std::string caseName(const ::testing::TestParamInfo<BackendCase>& info) { return info.param.name; }

}  // namespace spoor::test

#define SPOOR_ON_EVERY_BACKEND(suite) INSTANTIATE_TEST_SUITE_P(On, suite, ::testing::ValuesIn(backendCases()), caseName)
