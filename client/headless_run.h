#pragma once

#include <string>

#include "client/crater_asker.h"
#include "client/renderer.h"
#include "client/session.h"

namespace spoor {

struct HeadlessOptions {
  int frame_count = 0;  // pictures of the follow camera, spread over the session
  std::string folder;   // where pictures go; made where missing
  RenderSettings render;
  std::vector<TimedCrater> craters;  // to be asked for
};

/// Follows a session to its end, then writes trails.png, follow.png, above.png and the frames. Prints each file, and
/// what became of each crater. Errors: the session's, a folder or file that cannot be written. Throws
/// std::runtime_error where OpenGL fails. Needs a current GL context.
[[nodiscard]] Status runHeadless(ClientSession& session, const HeadlessOptions& options);

}  // namespace spoor
