#pragma once

#include <cstdint>
#include <string>

#include "client/renderer.h"
#include "shared/base/options.h"

namespace spoor {

/// What the command lines of all programs that draw have in common.
struct PictureArguments {
  std::string size = "1280x720";
  std::string ground = "scene";
  std::int64_t blur_normals = -1;
};

void addPictureOptions(Options& options, PictureArguments& arguments);

/// The defaults of RenderSettings with what was asked for. The error names the option.
Result<RenderSettings> pictureSettings(const PictureArguments& arguments);

}  // namespace spoor
