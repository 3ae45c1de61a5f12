#pragma once

#include "client/gl_window.h"
#include "client/renderer.h"
#include "client/session.h"

namespace spoor {

/// Shows a session in a window until that is closed; after the session's end, its last state.
/// Keys: W A S D and E Q move, Shift is faster, the mouse turns while its right button is held, F follows a body or
/// flies free, Tab takes the next body, Escape closes.
/// Errors: the session's. Throws std::runtime_error where OpenGL fails.
[[nodiscard]] Status runInWindow(ClientSession& session, const WindowContext& context, const RenderSettings& settings);

}  // namespace spoor
