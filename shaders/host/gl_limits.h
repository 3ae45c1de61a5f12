#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "shaders/host/gl_context.h"

namespace spoor {

/// What a context can do, as far as the compute pipeline relies on it.
struct GlLimits {
  std::string vendor, renderer, version, glsl;
  int version_number = 0;                ///< 10 * major + minor: 45 for OpenGL 4.5
  std::int64_t storage_block_bytes = 0;  ///< GL_MAX_SHADER_STORAGE_BLOCK_SIZE
  int storage_bindings = 0;              ///< GL_MAX_SHADER_STORAGE_BUFFER_BINDINGS
  int compute_storage_blocks = 0;        ///< GL_MAX_COMPUTE_SHADER_STORAGE_BLOCKS
  int shared_bytes = 0;                  ///< GL_MAX_COMPUTE_SHARED_MEMORY_SIZE
  int group_invocations = 0;             ///< GL_MAX_COMPUTE_WORK_GROUP_INVOCATIONS
  int group_size_x = 0;                  ///< GL_MAX_COMPUTE_WORK_GROUP_SIZE, x
  int group_count_x = 0;                 ///< GL_MAX_COMPUTE_WORK_GROUP_COUNT, x
  int table_alignment = 0;               ///< GL_SHADER_STORAGE_BUFFER_OFFSET_ALIGNMENT
  bool software = false;
  bool reports_resets = false;  ///< whether contextStatus() can tell of a lost context
};

/// Asks for the limits of a context, which must be current on this thread, and checks them with limitsStatus().
Result<GlLimits> checkLimits(const GlContext& context);

/// Errors: every limit that is lower than the compute pipeline needs, with what was found and what is needed.
Status limitsStatus(const GlLimits& limits);

/// Lines for printing.
std::vector<std::string> describe(const GlLimits& limits);

}  // namespace spoor
