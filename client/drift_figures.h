#pragma once

#include <functional>
#include <memory>
#include <string>

#include "client/renderer.h"
#include "shared/sim/backend.h"

namespace spoor {

/// Makes a backend anew.
using BackendMaker = std::function<Result<std::unique_ptr<Backend>>()>;

/// Draws tracks in mud, pebbles and sand and across their borders, snow that fills tracks, and a body that grows.
/// @param write  takes each picture as it lies in the renderer, and its name
[[nodiscard]] Status drawDrift(const RenderSettings& settings, const BackendMaker& backend,
                               const std::function<Status(const Renderer&, const std::string&)>& write);

}  // namespace spoor
