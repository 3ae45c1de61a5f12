#include "server/import/georeference.h"

#include <fmt/format.h>
#include <gdal.h>
#include <ogr_srs_api.h>

#include <array>
#include <cmath>
#include <numbers>

#include "server/import/units.h"

namespace spoor {
namespace {

/// The shape of the planet.
struct Ellipsoid {
  double semi_major_m = 6378137.0;
  double flattening = 1 / 298.257223563;
};

/// Metres per radian of longitude and of latitude at a latitude.
struct RadianLength {
  double east_m, north_m;
};
RadianLength radianLength(const Ellipsoid& ellipsoid, double latitude) {
  const double eccentricity_squared = ellipsoid.flattening * (2 - ellipsoid.flattening);
  const double w = std::sqrt(1 - eccentricity_squared * std::sin(latitude) * std::sin(latitude));
  return {ellipsoid.semi_major_m / w * std::cos(latitude),
          ellipsoid.semi_major_m * (1 - eccentricity_squared) / (w * w * w)};
}

/// A grid without a coordinate system whose numbers can only be degrees: a fine step within the globe's longitudes and
/// latitudes (many .asc files of SRTM come so).
bool looksLikeDegrees(const std::array<double, 6>& t, int columns, int rows) {
  const auto within = [](double from, double step, int count, double limit) {
    return std::abs(from) <= limit && std::abs(from + step * count) <= limit;
  };
  return std::abs(t[1]) < 0.01 && std::abs(t[5]) < 0.01 && within(t[0], t[1], columns, 360) &&
         within(t[3], t[5], rows, 90);
}

/// Turns a grid's step from degrees (or what angle the file uses) into metres.
Status angleToMetres(OGRSpatialReferenceH system, const std::array<double, 6>& t, int rows, const std::string& file,
                     Georeference& grid, std::vector<std::string>& notes) {
  Ellipsoid ellipsoid;
  double radians_per_unit = std::numbers::pi / 180;
  if (system) {
    OGRErr error = OGRERR_NONE;
    const double semi_major_m = OSRGetSemiMajor(system, &error);
    const double inverse = OSRGetInvFlattening(system, nullptr);
    if (error == OGRERR_NONE && semi_major_m > 0) ellipsoid = {semi_major_m, inverse > 1 ? 1 / inverse : 0};
    if (const double angle = OSRGetAngularUnits(system, nullptr); angle > 0) radians_per_unit = angle;
  }
  const double latitude = (t[3] + t[5] * rows / 2) * radians_per_unit;
  if (!(std::abs(latitude) < std::numbers::pi / 2 * 0.999)) {
    return Error{fmt::format("{}: middle latitude {} degrees cannot be laid out in metres", file,
                             plainNumber(latitude * 180 / std::numbers::pi))};
  }
  const RadianLength length = radianLength(ellipsoid, latitude);
  grid.sample_x_m *= radians_per_unit * length.east_m;
  grid.sample_y_m *= radians_per_unit * length.north_m;
  const double degree = std::numbers::pi / 180;
  notes.push_back(
      fmt::format("{}: degrees converted to metres at latitude {:.4f}: {:.1f} m east and {:.1f} m north per "
                  "degree, samples {:.3f} x {:.3f} m{}",
                  file, latitude / degree, length.east_m * degree, length.north_m * degree, grid.sample_x_m,
                  grid.sample_y_m, system ? "" : " (the file names no coordinate system; WGS 84 taken)"));
  return {};
}

}  // namespace

Result<Georeference> readGeoreference(void* dataset, const std::string& file, double sample_m,
                                      std::vector<std::string>& notes) {
  std::array<double, 6> t{};
  const int columns = GDALGetRasterXSize(dataset);
  const int rows = GDALGetRasterYSize(dataset);
  const bool referenced = GDALGetGeoTransform(dataset, t.data()) == CE_None;
  Georeference grid;
  if (referenced) {
    if (t[2] != 0 || t[4] != 0) return Error{file + ": the grid is rotated; warp it to north-up first"};
    if (t[1] < 0) return Error{file + ": columns run from east to west; warp it to north-up first"};
    grid.north_first = t[5] < 0;
  }
  if (sample_m > 0) {
    grid.sample_x_m = grid.sample_y_m = sample_m;
    if (referenced)
      notes.push_back(
          fmt::format("{}: samples {} m apart as asked, not as the file says", file, plainNumber(sample_m)));
    return grid;
  }
  if (!referenced) {
    notes.push_back(file + ": no georeference: samples taken as 1 m apart");
    return grid;
  }
  grid.sample_x_m = t[1];
  grid.sample_y_m = std::abs(t[5]);
  const OGRSpatialReferenceH system = GDALGetSpatialRef(dataset);
  if (system ? OSRIsGeographic(system) != 0 : looksLikeDegrees(t, columns, rows)) {
    if (const Status status = angleToMetres(system, t, rows, file, grid, notes); !status) return Error{status.error()};
  } else if (system) {
    const double metres = OSRGetLinearUnits(system, nullptr);
    if (metres > 0 && std::abs(metres - 1) > 1e-9) {
      grid.sample_x_m *= metres;
      grid.sample_y_m *= metres;
      notes.push_back(fmt::format("{}: units of {} m converted to metres", file, plainNumber(metres)));
    }
  }
  const auto usable = [](double step_m) { return step_m >= 1e-4 && step_m <= 1e6; };
  if (!usable(grid.sample_x_m) || !usable(grid.sample_y_m)) {
    return Error{fmt::format("{}: samples {} x {} m apart are outside 0.0001 .. 1000000 m; sample_m overrides", file,
                             plainNumber(grid.sample_x_m), plainNumber(grid.sample_y_m))};
  }
  return grid;
}

}  // namespace spoor
