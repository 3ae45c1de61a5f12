#include "shaders/host/shader_loader.h"

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
  if (!stream) return Error{"shader " + file.string() + ": cannot be read"};
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

std::string place(const fs::path& file, int line_number) { return file.string() + ":" + std::to_string(line_number); }

/// Says what line of which file comes next.
std::string lineDirective(int line_number, std::ptrdiff_t file_number) {
  return "#line " + std::to_string(line_number) + " " + std::to_string(file_number) + "\n";
}

Status append(ShaderText& out, const fs::path& file, int depth, const std::string& after_version) {
  static const std::regex kVersion(R"re(^\s*#\s*version\b.*)re");
  static const std::regex kInclude(R"re(^\s*#\s*include\s*"([^"]+)".*)re");
  static const std::regex kSystemInclude(R"re(^\s*#\s*include\s*<.*)re");
  auto text = readText(file);
  if (!text) return Error{text.error()};
  const auto known = std::find(out.files.begin(), out.files.end(), file.string());
  const auto number = known - out.files.begin();
  if (known == out.files.end()) out.files.push_back(file.string());
  if (depth > 0) out.text += lineDirective(1, number);
  bool defined = after_version.empty();
  std::istringstream lines(*text);
  std::string line;
  for (int line_number = 1; std::getline(lines, line); ++line_number) {
    std::smatch match;
    if (std::regex_match(line, match, kInclude)) {
      if (depth == kIncludeDepthLimit)
        return Error{"shader " + place(file, line_number) + ": includes nested deeper than " +
                     std::to_string(kIncludeDepthLimit)};
      const fs::path wanted = (file.parent_path() / match[1].str()).lexically_normal();
      if (const Status status = append(out, wanted, depth + 1, {}); !status)
        return Error{status.error() + " (included by " + place(file, line_number) + ")"};
      out.text += lineDirective(line_number + 1, number);
    } else {
      out.text += std::regex_match(line, kSystemInclude) ? "\n" : line + "\n";
      if (!defined && std::regex_match(line, kVersion)) {
        out.text += after_version + lineDirective(line_number + 1, number);
        defined = true;
      }
    }
    if (out.text.size() > kTextBytesLimit)
      return Error{"shader " + file.string() + ": longer than " + std::to_string(kTextBytesLimit) +
                   " bytes with its includes"};
  }
  if (!defined) return Error{"shader " + file.string() + ": no #version line for its defines to follow"};
  return {};
}

GLenum stageOf(const std::string& name) {
  const auto suffix = fs::path(name).extension().string();
  if (suffix == ".vert") return GL_VERTEX_SHADER;
  if (suffix == ".tesc") return GL_TESS_CONTROL_SHADER;
  if (suffix == ".tese") return GL_TESS_EVALUATION_SHADER;
  if (suffix == ".frag") return GL_FRAGMENT_SHADER;
  if (suffix == ".comp") return GL_COMPUTE_SHADER;
  throw std::runtime_error("shader " + name + ": \"" + suffix + "\" names no stage");
}

/// The first line of a log that tells of an error, else its first line.
std::string firstError(const std::string& log) {
  static const std::regex kError(R"re(\berror\b)re", std::regex::icase);
  std::istringstream lines(log);
  std::string line, first;
  while (std::getline(lines, line)) {
    if (std::regex_search(line, kError)) return line;
    if (first.empty() && line.find_first_not_of(" \r\t") != std::string::npos) first = line;
  }
  return first.empty() ? "the driver gave no log" : first;
}

GlShader compile(const std::string& name, const ShaderText& text) {
  GlShader shader(glCreateShader(stageOf(name)));
  const char* source = text.text.c_str();
  glShaderSource(shader.name(), 1, &source, nullptr);
  glCompileShader(shader.name());
  GLint compiled = 0;
  glGetShaderiv(shader.name(), GL_COMPILE_STATUS, &compiled);
  if (compiled == GL_FALSE) {
    std::string log(4096, '\0');
    GLsizei length = 0;
    glGetShaderInfoLog(shader.name(), GLsizei(log.size()), &length, log.data());
    log.resize(std::size_t(length));
    throw std::runtime_error("shader " + name + ": " + firstError(namedLog(log, text.files)));
  }
  return shader;
}

}  // namespace

fs::path shaderFolder() {
  const char* chosen = std::getenv("SPOOR_SHADERS");
  return chosen != nullptr && *chosen != '\0' ? fs::path(chosen) : fs::path(SPOOR_SHADER_DIR);
}

Result<ShaderText> loadShaderText(const fs::path& file, const ShaderDefines& defines) {
  std::string lines;
  for (const auto& [name, value] : defines) lines += "#define " + name + " " + value + "\n";
  ShaderText out;
  if (const Status status = append(out, file, 0, lines); !status) return Error{status.error()};
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
        line = match[1].str() + files[index] + match[3].str() + match[4].str() + match.suffix().str();
    }
    out += line + "\n";
  }
  return out;
}

GlProgram makeProgram(const std::vector<std::string>& stages, const ShaderDefines& defines) {
  GlProgram program(glCreateProgram());
  std::string names;
  std::vector<std::string> files;  // of the only stage: where there are more, a number in the log may be any one's
  for (const auto& stage : stages) {
    const auto text = loadShaderText(shaderFolder() / stage, defines);
    if (!text) throw std::runtime_error(text.error());
    const GlShader shader = compile(stage, *text);
    if (stages.size() == 1) files = text->files;
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
    throw std::runtime_error("shaders " + names + ": " + firstError(namedLog(log, files)));
  }
  return program;
}

}  // namespace spoor
