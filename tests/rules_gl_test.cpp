// The rule headers are one text in two languages: GLSL on whatever OpenGL there is must give what C++ gives.
#include <gtest/gtest.h>

#include <cstdio>

#include "shaders/host/gl_context.h"
#include "shaders/host/shader_loader.h"
#include "tests/rules_probe.h"

namespace spoor {
namespace {

TEST(Rules, GlslGivesWhatCppGives) {
  auto context = openHeadlessContext();
  if (!context) GTEST_SKIP() << context.error();
  std::printf("renderer %s\n", (*context)->renderer().c_str());
  constexpr int kSeeds = 20000;
  const GlProgram program = makeProgram({"../tests/rules_probe.comp"});
  const GlBuffer results = makeBuffer();
  std::vector<std::int32_t> seen(std::size_t(kSeeds) * rules::kProbeCount);
  glNamedBufferStorage(results.name(), GLsizeiptr(seen.size() * sizeof(seen[0])), nullptr, GL_MAP_READ_BIT);
  glUseProgram(program.name());
  glUniform1i(0, kSeeds);
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, results.name());
  glDispatchCompute((kSeeds + 63) / 64, 1, 1);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  glGetNamedBufferSubData(results.name(), 0, GLsizeiptr(seen.size() * sizeof(seen[0])), seen.data());
  checkGl("rules_probe.comp");
  for (int seed = 0; seed < kSeeds; ++seed)
    for (int which = 0; which < rules::kProbeCount; ++which)
      ASSERT_EQ(seen[std::size_t(seed * rules::kProbeCount + which)], rules::probeRule(which, seed))
          << "rule " << which << ", seed " << seed;
}

}  // namespace
}  // namespace spoor
