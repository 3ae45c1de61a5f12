#include "shaders/host/gl_limits.h"

#include <epoxy/gl.h>

#include <array>

namespace spoor {

namespace {

/// A limit, and the least of it that the compute pipeline runs with (of an alignment: the most).
struct Need {
  const char* name;
  std::int64_t found;
  std::int64_t needed;
  bool at_most = false;
  bool met() const { return at_most ? found <= needed : found >= needed; }
};

std::array<Need, 9> needs(const GlLimits& limits) {
  return {{{"ten times the OpenGL version", limits.version_number, 45},
           {"GL_MAX_SHADER_STORAGE_BLOCK_SIZE", limits.storage_block_bytes, std::int64_t(1) << 27},
           {"GL_MAX_SHADER_STORAGE_BUFFER_BINDINGS", limits.storage_bindings, 16},
           {"GL_MAX_COMPUTE_SHADER_STORAGE_BLOCKS", limits.compute_storage_blocks, 14},
           {"GL_MAX_COMPUTE_SHARED_MEMORY_SIZE", limits.shared_bytes, 32768},
           {"GL_MAX_COMPUTE_WORK_GROUP_INVOCATIONS", limits.group_invocations, 1024},
           {"GL_MAX_COMPUTE_WORK_GROUP_SIZE[0]", limits.group_size_x, 1024},
           {"GL_MAX_COMPUTE_WORK_GROUP_COUNT[0]", limits.group_count_x, 65535},
           {"GL_SHADER_STORAGE_BUFFER_OFFSET_ALIGNMENT", limits.table_alignment, 256, true}}};
}

int number(GLenum name) {
  GLint value = 0;
  glGetIntegerv(name, &value);
  return value;
}

int numberOfX(GLenum name) {
  GLint value = 0;
  glGetIntegeri_v(name, 0, &value);
  return value;
}

}  // namespace

Result<GlLimits> checkLimits(const GlContext& context) {
  GlLimits limits;
  limits.vendor = glText(GL_VENDOR);
  limits.renderer = context.renderer();
  limits.version = glText(GL_VERSION);
  limits.glsl = glText(GL_SHADING_LANGUAGE_VERSION);
  limits.version_number = number(GL_MAJOR_VERSION) * 10 + number(GL_MINOR_VERSION);
  GLint64 block_bytes = 0;
  glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &block_bytes);
  limits.storage_block_bytes = block_bytes;
  limits.storage_bindings = number(GL_MAX_SHADER_STORAGE_BUFFER_BINDINGS);
  limits.compute_storage_blocks = number(GL_MAX_COMPUTE_SHADER_STORAGE_BLOCKS);
  limits.shared_bytes = number(GL_MAX_COMPUTE_SHARED_MEMORY_SIZE);
  limits.group_invocations = number(GL_MAX_COMPUTE_WORK_GROUP_INVOCATIONS);
  limits.group_size_x = numberOfX(GL_MAX_COMPUTE_WORK_GROUP_SIZE);
  limits.group_count_x = numberOfX(GL_MAX_COMPUTE_WORK_GROUP_COUNT);
  limits.table_alignment = number(GL_SHADER_STORAGE_BUFFER_OFFSET_ALIGNMENT);
  limits.software = context.software();
  limits.reports_resets = number(GL_RESET_NOTIFICATION_STRATEGY) == GL_LOSE_CONTEXT_ON_RESET;
  if (const Status status = limitsStatus(limits); !status) return Error{status.error()};
  return limits;
}

Status limitsStatus(const GlLimits& limits) {
  std::string lacking;
  for (const Need& need : needs(limits))
    if (!need.met())
      lacking += std::string(lacking.empty() ? "" : "; ") + need.name + " is " + std::to_string(need.found) + ", " +
                 std::to_string(need.needed) + (need.at_most ? " at most" : "") + " is needed";
  if (lacking.empty()) return {};
  return Error{"OpenGL of " + limits.renderer + " does not suffice: " + lacking};
}

std::vector<std::string> describe(const GlLimits& limits) {
  std::vector<std::string> lines = {
      "renderer " + limits.renderer + " by " + limits.vendor + (limits.software ? " (software)" : " (hardware)"),
      "OpenGL " + limits.version + ", GLSL " + limits.glsl +
          (limits.reports_resets ? ", reports resets" : ", does not report resets")};
  for (const Need& need : needs(limits))
    lines.push_back(std::string(need.name) + " " + std::to_string(need.found) + " (" + std::to_string(need.needed) +
                    (need.at_most ? " at most)" : " needed)"));
  return lines;
}

}  // namespace spoor
