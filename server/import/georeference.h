#pragma once

#include <string>
#include <vector>

#include "shared/base/result.h"

namespace spoor {

/// How a raster's samples lie on the ground.
struct Georeference {
  double sample_x_m = 1;  // distance of columns
  double sample_y_m = 1;  // distance of rows
  bool north_first = true;
};

/// Reads a raster's grid. Degrees become metres at the middle latitude, on the ellipsoid that the file names, else on
/// WGS 84; each conversion and assumption leaves a note.
/// @param dataset   a GDALDatasetH
/// @param sample_m  > 0: this distance instead of the file's
/// Errors: a rotated or mirrored grid, a distance that is not a positive number.
Result<Georeference> readGeoreference(void* dataset, const std::string& file, double sample_m,
                                      std::vector<std::string>& notes);

}  // namespace spoor
