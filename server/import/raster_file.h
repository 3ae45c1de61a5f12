#pragma once

#include <cpl_error.h>
#include <gdal.h>

#include <memory>
#include <string>

#include "shared/base/result.h"

namespace spoor {

/// Keeps GDAL from writing to stderr and remembers the first thing that it said went wrong.
class GdalQuiet {
 public:
  GdalQuiet();
  ~GdalQuiet();
  GdalQuiet(const GdalQuiet&) = delete;
  GdalQuiet& operator=(const GdalQuiet&) = delete;

  /// In one line.
  std::string message() const { return first_.empty() ? "no reason given" : first_; }
  bool failed() const { return !first_.empty(); }

 private:
  static void CPL_STDCALL keep(CPLErr level, CPLErrorNum number, const char* text);
  std::string first_;
};

struct CloseRaster {
  void operator()(GDALDatasetH dataset) const { GDALClose(dataset); }
};
using RasterFile = std::unique_ptr<void, CloseRaster>;

/// Opens a raster with a band or more. Errors: no such file, none that GDAL reads.
Result<RasterFile> openRaster(const std::string& file, const GdalQuiet& quiet);

}  // namespace spoor
