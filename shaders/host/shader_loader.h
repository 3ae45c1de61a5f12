#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "shaders/host/gl_objects.h"
#include "shared/base/result.h"

namespace spoor {

/// The folder that holds render/, rules/ and sim/: SPOOR_SHADERS from the environment, else the one set at build time.
std::filesystem::path shaderFolder();

/// A shader with its includes put in. #line directives count files; `files[i]` is the name of number i.
struct ShaderText {
  std::string text;
  std::vector<std::string> files;
};

/// Names and values, each to become a line `#define NAME VALUE` after a shader's #version line.
using ShaderDefines = std::vector<std::pair<std::string, std::string>>;

/// Reads a file and resolves every `#include "..."`, relative to the file that names it. Lines `#include <...>` are for
/// C++ and are blanked. Errors name file and line: a missing file, includes nested too deep; defines, but no #version.
Result<ShaderText> loadShaderText(const std::filesystem::path& file, const ShaderDefines& defines = {});

/// Puts file names in place of the numbers in a driver's log ("3:12(7): error" or "3(12) : error").
std::string namedLog(const std::string& log, const std::vector<std::string>& files);

/// Compiles and links the stages, given as paths below shaderFolder(); the suffix names the stage. Every
/// stage gets the defines. Throws std::runtime_error with the first error of the driver's log, file and line named.
GlProgram makeProgram(const std::vector<std::string>& stages, const ShaderDefines& defines = {});

}  // namespace spoor
