#pragma once

#include <string>

#include "client/renderer.h"
#include "shaders/host/make_backend.h"

namespace spoor {

/// Prints what a frame takes, tessellation and a sweep of drift over the whole grid included, by the grid's size and the
/// tessellation factor, and the sweep alone, beside table 1 of Gilardi et al. Fails where a picture is empty, or where
/// the two backends, if both run here, end on different hashes.
/// @param json_file  not empty: where the numbers go, too
[[nodiscard]] Status measureDrift(const RenderSettings& settings, const BackendChoice& choice,
                                  const std::string& json_file);

}  // namespace spoor
