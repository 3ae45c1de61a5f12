#pragma once

#include <string>

#include "client/renderer.h"

namespace spoor {

/// Measures what drawing craters takes (Cossetin Neto et al. 2023, figure 6): up to 1000 of 5 to 20 m diameter in a
/// disc of 500 m, with hash cells of several sizes and without a hash. Prints a table. Needs a current context.
/// @param json_file  where the numbers go too; empty: nowhere
/// Errors: pictures of the same craters differ between sizes of the hash's cells; the file cannot be written.
[[nodiscard]] Status measureCraters(const RenderSettings& settings, const std::string& json_file);

}  // namespace spoor
