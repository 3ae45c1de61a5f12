#pragma once

#include "client/crater_asker.h"
#include "client/gl_window.h"
#include "client/renderer.h"
#include "client/session.h"

namespace spoor {

/// Shows a session in a window until that is closed; after the session's end, its last state.
/// Keys: W A S D and E Q move, Shift is faster, the mouse turns while its right button is held, F follows a body or
/// flies free, Tab takes the next body, B asks for a crater where the middle of the view meets the ground, as large as
/// the scene lets clients ask for, Escape closes. Prints what became of each crater.
/// Errors: the session's. Throws std::runtime_error where OpenGL fails.
[[nodiscard]] Status runInWindow(ClientSession& session, const WindowContext& context, const RenderSettings& settings,
                                 CraterAsker asker);

}  // namespace spoor
