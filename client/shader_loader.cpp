#include "client/shader_loader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <regex>
#include <sstream>
#include <stdexcept>

namespace spoor {

namespace fs = std::filesystem;

namespace {

constexpr int kIncludeDepthLimit = 16;
constexpr std::size_t kTextBytesLimit = std::size_t(4) << 20;

Result<std::string> readText(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return Error{fmt::format("shader {}: cannot be read", file.string())};
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

Status append(ShaderText& out, const fs::path& file, int depth) {
  static const std::regex kInclude(R"re(^\s*#\s*include\s*"([^"]+)".*)re");
  static const std::regex kSystemInclude(R"re(^\s*#\s*include\s*<.*)re");
  auto text = readText(file);
  if (!text) return Error{text.error()};
  const auto known = std::find(out.files.begin(), out.files.end(), file.string());
  const auto number = known - out.files.begin();
  if (known == out.files.end()) out.files.push_back(file.string());
  if (depth > 0) out.text += fmt::format("#line 1 {}\n", number);
  std::istringstream lines(*text);
  std::string line;
  for (int line_number = 1; std::getline(lines, line); ++line_number) {
    std::smatch match;
    if (std::regex_match(line, match, kInclude)) {
      if (depth == kIncludeDepthLimit)
        return Error{fmt::format("shader {}:{}: includes nested deeper than {}", file.string(), line_number,
                                 kIncludeDepthLimit)};
      const fs::path wanted = (file.parent_path() / match[1].str()).lexically_normal();
      if (const Status status = append(out, wanted, depth + 1); !status)
        return Error{fmt::format("{} (included by {}:{})", status.error(), file.string(), line_number)};
      out.text += fmt::format("#line {} {}\n", line_number + 1, number);
    } else {
      out.text += std::regex_match(line, kSystemInclude) ? "\n" : line + "\n";
    }
    if (out.text.size() > kTextBytesLimit)
      return Error{fmt::format("shader {}: longer than {} bytes with its includes", file.string(), kTextBytesLimit)};
  }
  return {};
}

GLenum stageOf(const std::string& name) {
  const auto suffix = fs::path(name).extension().string();
  if (suffix == ".vert") return GL_VERTEX_SHADER;
  if (suffix == ".tesc") return GL_TESS_CONTROL_SHADER;
  if (suffix == ".tese") return GL_TESS_EVALUATION_SHADER;
  if (suffix == ".frag") return GL_FRAGMENT_SHADER;
  if (suffix == ".comp") return GL_COMPUTE_SHADER;
  throw std::runtime_error(fmt::format("shader {}: \"{}\" names no stage", name, suffix));
}

std::string firstLine(const std::string& text) {
  const auto begin = text.find_first_not_of(" \n\r\t");
  if (begin == std::string::npos) return "the driver gave no log";
  return text.substr(begin, text.find('\n', begin) - begin);
}

GlShader compile(const std::string& name) {
  const auto text = loadShaderText(shaderFolder() / name);
  if (!text) throw std::runtime_error(text.error());
  GlShader shader(glCreateShader(stageOf(name)));
  const char* source = text->text.c_str();
  glShaderSource(shader.name(), 1, &source, nullptr);
  glCompileShader(shader.name());
  GLint compiled = 0;
  glGetShaderiv(shader.name(), GL_COMPILE_STATUS, &compiled);
  if (compiled == GL_FALSE) {
    std::string log(4096, '\0');
    GLsizei length = 0;
    glGetShaderInfoLog(shader.name(), GLsizei(log.size()), &length, log.data());
    log.resize(std::size_t(length));
    throw std::runtime_error(fmt::format("shader {}: {}", name, firstLine(namedLog(log, text->files))));
  }
  return shader;
}

}  // namespace

fs::path shaderFolder() {
  const char* chosen = std::getenv("SPOOR_SHADERS");
  return chosen != nullptr && *chosen != '\0' ? fs::path(chosen) : fs::path(SPOOR_SHADER_DIR);
}

Result<ShaderText> loadShaderText(const fs::path& file) {
  ShaderText out;
  if (const Status status = append(out, file, 0); !status) return Error{status.error()};
  return out;
}

std::string namedLog(const std::string& log, const std::vector<std::string>& files) {
  static const std::regex kPlace(R"re(^(ERROR: |WARNING: )?(\d+)([:(])(\d+))re");
  std::istringstream lines(log);
  std::string line, out;
  while (std::getline(lines, line)) {
    std::smatch match;
    if (std::regex_search(line, match, kPlace) && match[2].length() < 6) {
      const auto index = std::size_t(std::stoi(match[2].str()));
      if (index < files.size())
        line = fmt::format("{}{}{}{}{}", match[1].str(), files[index], match[3].str(), match[4].str(),
                           match.suffix().str());
    }
    out += line + "\n";
  }
  return out;
}

GlProgram makeProgram(const std::vector<std::string>& stages) {
  GlProgram program(glCreateProgram());
  std::string names;
  for (const auto& stage : stages) {
    const GlShader shader = compile(stage);
    glAttachShader(program.name(), shader.name());
    names += (names.empty() ? "" : ", ") + stage;
  }
  glLinkProgram(program.name());
  GLint linked = 0;
  glGetProgramiv(program.name(), GL_LINK_STATUS, &linked);
  if (linked == GL_FALSE) {
    std::string log(4096, '\0');
    GLsizei length = 0;
    glGetProgramInfoLog(program.name(), GLsizei(log.size()), &length, log.data());
    log.resize(std::size_t(length));
    throw std::runtime_error(fmt::format("shaders {}: {}", names, firstLine(log)));
  }
  return program;
}

}  // namespace spoor
