// OpenGL for computing: devices, limits, contexts that change threads, shader text. Skips where there is no OpenGL.
#include <epoxy/egl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <thread>

#include "shaders/host/gl_context.h"
#include "shaders/host/gl_limits.h"
#include "shaders/host/shader_loader.h"

namespace spoor {
namespace {

/// Skips, saying why, where there is no OpenGL at all.
class GlHost : public ::testing::Test {
 protected:
  void SetUp() override {
    auto opened = openHeadlessContext();
    if (!opened) GTEST_SKIP() << opened.error();
    context_ = std::move(*opened);
  }

  std::unique_ptr<HeadlessContext> context_;
};

/// Shader files of one test, in a folder that goes with it.
class Shaders : public GlHost {
 protected:
  void SetUp() override {
    GlHost::SetUp();
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::path(::testing::TempDir()) /
              ("spoor_gl_" + std::string(info->name()) + "_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override {
    if (!folder_.empty()) std::filesystem::remove_all(folder_);
  }

  std::string write(const std::string& name, const std::string& text) {
    const auto file = folder_ / name;
    std::ofstream(file, std::ios::binary) << text;
    return file.string();
  }

  /// A shader whose included file has its fault in line 3, after `first_line` of its own.
  std::string writeFaultyInclude(const std::string& first_line) {
    write("part.glsl", first_line + "\nint fine() { return 1; }\nint faulty() { return one two; }\n");
    return write("whole.comp",
                 "// A comment comes first.\n#version 450 core\nlayout(local_size_x = 1) in;\n"
                 "#include \"part.glsl\"\nvoid main() {}\n");
  }

  std::filesystem::path folder_;
};

std::string errorOf(const std::string& shader, const ShaderDefines& defines = {}) {
  try {
    makeProgram({shader}, defines);
  } catch (const std::runtime_error& problem) {
    return problem.what();
  }
  return "no error";
}

/// A message names a place as "FILE:LINE" or "FILE(LINE", as the driver likes.
bool names(const std::string& message, const std::string& file, int line) {
  for (const char* mark : {":", "("})
    for (const char* end : {"(", ")", ":"})
      if (message.find(file + mark + std::to_string(line) + end) != std::string::npos) return true;
  return false;
}

GlBuffer bufferOf(GLuint value) {
  GlBuffer buffer = makeBuffer();
  glNamedBufferStorage(buffer.name(), sizeof(value), &value, 0);
  return buffer;
}

GLuint valueIn(const GlBuffer& buffer) {
  GLuint value = 0;
  glGetNamedBufferSubData(buffer.name(), 0, sizeof(value), &value);
  return value;
}

TEST_F(GlHost, LimitsSufficeHere) {
  const auto limits = checkLimits(*context_);
  ASSERT_TRUE(limits) << limits.error();
  for (const std::string& line : describe(*limits)) std::printf("%s\n", line.c_str());
  EXPECT_EQ(limits->renderer, context_->renderer());
  EXPECT_EQ(limits->software, context_->software());
  EXPECT_TRUE(glStatus("checkLimits"));
  const Status lost = contextStatus();
  EXPECT_TRUE(lost) << lost.error();
}

TEST(GlLimits, ErrorNamesEveryLimitThatFallsShort) {
  GlLimits limits;
  limits.renderer = "a toy";
  limits.version_number = 45;
  limits.storage_block_bytes = (std::int64_t(1) << 27) - 1;
  limits.storage_bindings = 16;
  limits.compute_storage_blocks = 8;
  limits.shared_bytes = 32768;
  limits.group_invocations = 1024;
  limits.group_size_x = 1024;
  limits.group_count_x = 65535;
  const Status status = limitsStatus(limits);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error(),
            "OpenGL of a toy does not suffice: GL_MAX_SHADER_STORAGE_BLOCK_SIZE is 134217727, 134217728 is needed; "
            "GL_MAX_COMPUTE_SHADER_STORAGE_BLOCKS is 8, 14 is needed");
  limits.storage_block_bytes += 1;
  limits.compute_storage_blocks = 14;
  EXPECT_TRUE(limitsStatus(limits));
}

TEST_F(GlHost, ErrorsAreNamedAndForgotten) {
  glEnable(GL_ARRAY_BUFFER);
  const Status status = glStatus("a wrong call");
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error(), "OpenGL: GL_INVALID_ENUM after a wrong call");
  EXPECT_TRUE(glStatus("nothing"));
}

TEST_F(GlHost, UnknownDeviceListsWhatThereIs) {
  const auto devices = listHeadlessDevices();
  ASSERT_FALSE(devices.empty());
  EXPECT_TRUE(context_->isCurrent());
  for (const char* name : {"99", "", "00", "Surfaceless"}) {
    const auto opened = openHeadlessContext(name);
    ASSERT_FALSE(opened);
    EXPECT_EQ(opened.error().find("headless OpenGL: no device \"" + std::string(name) + "\"; want auto, "), 0u)
        << opened.error();
    for (const auto& device : devices) EXPECT_NE(opened.error().find(device), std::string::npos) << opened.error();
  }
  EXPECT_TRUE(context_->isCurrent());
}

TEST_F(GlHost, EveryListedDeviceOpensByItsNameOrSaysWhatItLacks) {
  for (const auto& line : listHeadlessDevices()) {
    std::printf("%s\n", line.c_str());
    const auto path = line.substr(0, line.find(':'));
    const auto opened = openHeadlessContext(path.substr(path.rfind(' ') + 1));
    if (opened) {
      EXPECT_EQ((*opened)->path(), path);
      EXPECT_TRUE((*opened)->isCurrent());
      EXPECT_NE(line.find((*opened)->renderer() + ", OpenGL "), std::string::npos);
    } else {
      EXPECT_NE(opened.error().find(line), std::string::npos) << opened.error();
    }
  }
}

TEST_F(GlHost, CurrentContextPutsBackTheEarlierOne) {
  auto second = openHeadlessContext();
  ASSERT_TRUE(second) << second.error();
  HeadlessContext& a = *context_;
  HeadlessContext& b = **second;
  ASSERT_TRUE(b.isCurrent());  // opening makes current
  {
    const CurrentContext outer(a);
    EXPECT_TRUE(outer.ok());
    EXPECT_TRUE(a.isCurrent());
    {
      const CurrentContext inner(b);
      EXPECT_TRUE(inner.ok());
      EXPECT_TRUE(b.isCurrent());
      const CurrentContext again(b);
      EXPECT_TRUE(again.ok());
    }
    EXPECT_TRUE(a.isCurrent());
  }
  EXPECT_TRUE(b.isCurrent());
}

TEST_F(GlHost, CurrentContextPutsBackNone) {
  context_->release();
  ASSERT_EQ(eglGetCurrentContext(), EGL_NO_CONTEXT);
  {
    const CurrentContext current(*context_);
    EXPECT_TRUE(current.ok());
    EXPECT_TRUE(context_->isCurrent());
  }
  EXPECT_EQ(eglGetCurrentContext(), EGL_NO_CONTEXT);
}

TEST_F(GlHost, ContextsDoNotSeeEachOthersObjects) {
  const GlBuffer of_a = bufferOf(7);
  auto second = openHeadlessContext();
  ASSERT_TRUE(second) << second.error();
  {
    const GlBuffer of_b = bufferOf(8);
    {
      const CurrentContext current(*context_);
      EXPECT_EQ(valueIn(of_a), 7u);
    }
    EXPECT_EQ(valueIn(of_b), 8u);
  }
  context_->makeCurrent();  // as of_a dies now
}

TEST_F(GlHost, AContextThatDiesLeavesTheCurrentOneCurrent) {
  { const auto second = openHeadlessContext(); }
  EXPECT_EQ(eglGetCurrentContext(), EGL_NO_CONTEXT);
  auto third = openHeadlessContext();
  ASSERT_TRUE(third) << third.error();
  ASSERT_TRUE(context_->makeCurrent());
  third->reset();
  EXPECT_TRUE(context_->isCurrent());
}

TEST_F(GlHost, AContextRunsOnTheThreadThatTakesIt) {
  GlBuffer buffer = bufferOf(1);
  bool taken_while_current_here = true, taken = false, left = false;
  GLuint seen = 0;
  std::thread([&] { taken_while_current_here = CurrentContext(*context_).ok(); }).join();
  EXPECT_FALSE(taken_while_current_here);
  EXPECT_TRUE(context_->isCurrent());
  context_->release();
  std::thread([&] {
    {
      const CurrentContext current(*context_);
      taken = current.ok();
      if (!taken) return;
      seen = valueIn(buffer);
      buffer = bufferOf(2);
    }
    left = eglGetCurrentContext() == EGL_NO_CONTEXT;
  }).join();
  EXPECT_TRUE(taken);
  EXPECT_TRUE(left);
  EXPECT_EQ(seen, 1u);
  ASSERT_TRUE(context_->makeCurrent());
  EXPECT_EQ(valueIn(buffer), 2u);
  EXPECT_TRUE(glStatus("two threads"));
}

TEST(ShaderText, ErrorsNameTheRealFile) {
  const auto text = loadShaderText(shaderFolder() / "render/picture.frag");
  ASSERT_TRUE(text) << text.error();
  ASSERT_GT(text->files.size(), 2u);
  const std::string log = namedLog("2:17(3): error: syntax\n1(4) : error C0000\n", text->files);
  EXPECT_NE(log.find(text->files[2] + ":17(3): error"), std::string::npos);
  EXPECT_NE(log.find(text->files[1] + "(4) : error"), std::string::npos);
  const auto missing = loadShaderText(shaderFolder() / "render/none.frag");
  ASSERT_FALSE(missing);
  EXPECT_NE(missing.error().find("none.frag"), std::string::npos);
}

TEST(ShaderText, DefinesNeedAVersionLine) {
  const auto file = shaderFolder() / "render/frame.h";
  EXPECT_TRUE(loadShaderText(file));
  const auto text = loadShaderText(file, {{"A", "1"}});
  ASSERT_FALSE(text);
  EXPECT_NE(text.error().find(file.string() + ": no #version line"), std::string::npos) << text.error();
}

TEST_F(Shaders, SyntaxErrorInAnIncludedFileNamesItsLine) {
  const std::string shader = writeFaultyInclude("// the part");
  const std::string error = errorOf(shader);
  EXPECT_TRUE(names(error, (folder_ / "part.glsl").string(), 3)) << error;
}

TEST_F(Shaders, DefinesMoveNoErrorsLine) {
  const std::string shader = writeFaultyInclude("int used[FIRST + SECOND];");
  std::string error = errorOf(shader, {{"FIRST", "2"}, {"SECOND", "FIRST"}});
  EXPECT_TRUE(names(error, (folder_ / "part.glsl").string(), 3)) << error;
  const std::string alone = write("alone.comp", "// One comment.\n#version 450 core\nA\nvoid main() {}\n");
  error = errorOf(alone, {{"A", "int one two;"}, {"B", ""}});
  EXPECT_TRUE(names(error, alone, 3)) << error;
}

TEST_F(Shaders, DefinesReachTheShader) {
  const std::string shader = write("set.comp",
                                   "#version 450 core\nlayout(local_size_x = SIZE) in;\n"
                                   "layout(std430, binding = 0) buffer Results { uint result; };\n"
                                   "#ifdef EMPTY\nvoid main() { result = SIZE * FACTOR; }\n#endif\n");
  const GlProgram program = makeProgram({shader}, {{"SIZE", "4"}, {"FACTOR", "(1 + 2)"}, {"EMPTY", ""}});
  const GlBuffer results = bufferOf(0);
  glUseProgram(program.name());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, results.name());
  glDispatchCompute(1, 1, 1);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  EXPECT_EQ(valueIn(results), 12u);
  checkGl("set.comp");
}

}  // namespace
}  // namespace spoor
