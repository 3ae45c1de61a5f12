#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "shared/base/result.h"

namespace spoor {

/// Which part of which raster, and how to read it.
struct DemRequest {
  std::string file;
  double vertical_scale = 1;        // heights are multiplied by this
  std::optional<double> nodata;     // value of the file that marks a missing sample, besides the file's own mark
  double sample_m = 0;              // distance of samples; 0: as the file says, or 1 m where it says nothing
  std::optional<double> lowest_m;   // height of value 0 and of the largest value of an 8- or 16-bit raster;
  std::optional<double> highest_m;  // both or none; none: values are heights
  double west_m = 0;                // part to read: its south-west corner, from the raster's
  double south_m = 0;
  double size_x_m = 0;  // and its size; 0: to the raster's end
  double size_y_m = 0;
};

/// Samples of a raster's first band: heights on a regular grid, first row in the south, first column in the west.
struct Dem {
  std::int32_t column_count = 0;  // >= 2
  std::int32_t row_count = 0;     // >= 2
  double sample_x_m = 0;          // distance of columns, and of rows
  double sample_y_m = 0;
  std::vector<std::int32_t> height_q;  // [row_count * column_count], 0.1 mm

  // Each sample stands for the ground around it.
  double widthM() const { return column_count * sample_x_m; }
  double heightM() const { return row_count * sample_y_m; }
};

/// Reads a raster through GDAL. Degrees become metres at the raster's middle latitude, foreign units metres, and
/// samples without data take the mean of their nearest valid neighbours; each leaves a note. Errors: a file that GDAL
/// cannot open or read to its end, a rotated grid, no valid sample, fewer than 2 x 2 samples, more than a pack can
/// hold, a height beyond +-53 km.
Result<Dem> readDem(const DemRequest& request, std::vector<std::string>& notes);

}  // namespace spoor
