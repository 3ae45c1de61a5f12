#include "server/import/raster_file.h"

#include <cpl_conv.h>

#include <algorithm>
#include <filesystem>

namespace spoor {

GdalQuiet::GdalQuiet() { CPLPushErrorHandlerEx(&GdalQuiet::keep, this); }
GdalQuiet::~GdalQuiet() { CPLPopErrorHandler(); }

void CPL_STDCALL GdalQuiet::keep(CPLErr level, CPLErrorNum, const char* text) {
  auto& self = *static_cast<GdalQuiet*>(CPLGetErrorHandlerUserData());
  if (level < CE_Failure || self.failed()) return;
  self.first_ = text;
  std::replace(self.first_.begin(), self.first_.end(), '\n', ' ');
}

Result<RasterFile> openRaster(const std::string& file, const GdalQuiet& quiet) {
  static const bool registered = (GDALAllRegister(), true);
  (void)registered;
  // Also keeps out names that GDAL would take for a web address or a database.
  if (!std::filesystem::is_regular_file(file)) return Error{file + ": no such file"};
  RasterFile dataset(
      GDALOpenEx(file.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR, nullptr, nullptr, nullptr));
  if (!dataset) return Error{file + ": not a raster that can be read: " + quiet.message()};
  if (GDALGetRasterCount(dataset.get()) < 1) return Error{file + ": holds no band of samples"};
  return dataset;
}

}  // namespace spoor
