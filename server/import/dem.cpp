#include "server/import/dem.h"

#include <fmt/format.h>
#include <gdal.h>
#include <ogr_srs_api.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "server/import/fill_missing.h"
#include "server/import/georeference.h"
#include "server/import/raster_file.h"
#include "server/import/units.h"
#include "shaders/rules/limits.h"
#include "shared/world/pack.h"

namespace spoor {
namespace {

/// A pack also has a head and meshes: leave them a MiB in sixteen.
constexpr std::int64_t kSampleLimit = std::int64_t(kPackBytesLimit / sizeof(std::int32_t) / 16 * 15);
constexpr int kSideLimit = 1 << 20;        // samples along a side (validatePack)
constexpr double kGroundLimitQ = 1 << 29;  // of a base height (validatePack)

/// How a value of the file becomes a height.
struct ValueRule {
  double factor = 1;  // metres per value
  double offset_m = 0;
  std::array<std::optional<double>, 2> nodata;  // the file's and the request's
  bool missing(double value) const {
    return !std::isfinite(value) || (nodata[0] && value == *nodata[0]) || (nodata[1] && value == *nodata[1]);
  }
  /// Values that mark missing data nearly everywhere, in a file that does not say what does. Filling them unasked could
  /// be wrong (a deep sea), and so could cliffs of 32 km.
  bool suspicious(double value) const {
    return !nodata[0] && !nodata[1] && (value == -32768 || value == -32767 || value == -9999);
  }
};

/// A range of samples of the file, in its own order.
struct Window {
  int column = 0, row = 0;
  int column_count = 0, row_count = 0;
};

Error demError(const DemRequest& request, const std::string& why) { return {request.file + ": " + why}; }

/// Metres per unit of a band's heights, by the names that GDAL gives units.
double metresPerUnit(const std::string& unit) {
  if (unit == "ft" || unit == "foot" || unit == "feet") return 0.3048;
  if (unit == "US survey foot" || unit == "sfoot" || unit == "us-ft") return 1200.0 / 3937.0;
  if (unit == "km" || unit == "kilometre") return 1000;
  if (unit == "cm" || unit == "centimetre") return 0.01;
  if (unit == "mm" || unit == "millimetre") return 0.001;
  return 1;
}

/// Heights of an image whose grey values say nothing about metres.
void greyRange(const DemRequest& request, double largest, double longer_side_m, ValueRule& rule,
               std::vector<std::string>& notes) {
  const double lowest_m = request.lowest_m.value_or(0);
  const double highest_m = request.highest_m.value_or(longer_side_m / 10);
  rule.factor = (highest_m - lowest_m) / largest;
  rule.offset_m = lowest_m;
  if (request.lowest_m) return;
  notes.push_back(
      fmt::format("{}: an image: black to white taken as 0 .. {} m, a tenth of its longer side; lowest_m and "
                  "highest_m of a scene say otherwise",
                  request.file, plainNumber(highest_m)));
}

Result<ValueRule> valueRule(const DemRequest& request, GDALRasterBandH band, double longer_side_m,
                            std::vector<std::string>& notes) {
  ValueRule rule;
  int has_nodata = 0;
  const double nodata = GDALGetRasterNoDataValue(band, &has_nodata);
  if (has_nodata) rule.nodata[0] = nodata;
  rule.nodata[1] = request.nodata;
  const GDALDataType type = GDALGetRasterDataType(band);
  if (GDALDataTypeIsComplex(type)) return demError(request, "holds complex numbers, not heights");
  const bool grey = type == GDT_Byte || type == GDT_UInt16;
  if (request.lowest_m && !grey) {
    return demError(request, fmt::format("lowest_m and highest_m are for images of 8 or 16 bits, this raster holds {}",
                                         GDALGetDataTypeName(type)));
  }
  std::array<double, 6> unused{};
  const bool referenced = GDALGetGeoTransform(GDALGetBandDataset(band), unused.data()) == CE_None;
  if (request.lowest_m || (grey && !referenced)) {
    greyRange(request, type == GDT_Byte ? 255 : 65535, longer_side_m, rule, notes);
  } else {
    const double scale = GDALGetRasterScale(band, nullptr);
    const double offset = GDALGetRasterOffset(band, nullptr);
    const char* unit_name = GDALGetRasterUnitType(band);
    const std::string unit = unit_name ? unit_name : "";
    rule.factor = scale * metresPerUnit(unit);
    rule.offset_m = offset * metresPerUnit(unit);
    if (metresPerUnit(unit) != 1)
      notes.push_back(fmt::format("{}: heights in {} converted to metres", request.file, unit));
    if (scale != 1 || offset != 0) {
      notes.push_back(fmt::format("{}: heights are value * {} + {}, as the file says", request.file, plainNumber(scale),
                                  plainNumber(offset)));
    }
  }
  rule.factor *= request.vertical_scale;
  rule.offset_m *= request.vertical_scale;
  if (!std::isfinite(rule.factor) || !std::isfinite(rule.offset_m))
    return demError(request, "height scale is not finite");
  return rule;
}

/// Samples along one axis, [begin, end), that cover `size_m` from `from_m` on; a size of 0 reaches to the end.
struct SampleRange {
  int begin = 0, end = 0;
};
SampleRange sampleRange(double from_m, double size_m, double sample_m, int count) {
  SampleRange range{0, count};
  range.begin = int(std::clamp(std::floor(from_m / sample_m + 1e-9), 0.0, double(count)));
  if (size_m > 0) {
    range.end = int(std::clamp(std::ceil((from_m + size_m) / sample_m - 1e-9), 0.0, double(count)));
  }
  return range;
}

Result<Window> chooseWindow(const DemRequest& request, const Georeference& grid, int columns, int rows,
                            std::vector<std::string>& notes) {
  const SampleRange x = sampleRange(request.west_m, request.size_x_m, grid.sample_x_m, columns);
  const SampleRange y = sampleRange(request.south_m, request.size_y_m, grid.sample_y_m, rows);
  Window window{x.begin, grid.north_first ? rows - y.end : y.begin, x.end - x.begin, y.end - y.begin};
  if (window.column_count < 2 || window.row_count < 2) {
    return demError(request,
                    fmt::format("{} x {} samples in the part asked for (of {} x {}); 2 x 2 are the least",
                                std::max(0, window.column_count), std::max(0, window.row_count), columns, rows));
  }
  if (window.column_count > kSideLimit || window.row_count > kSideLimit ||
      std::int64_t(window.column_count) * window.row_count > kSampleLimit) {
    return demError(request, fmt::format("{} x {} samples are more than a pack holds ({}); ask for a part of it, or a "
                                         "coarser raster",
                                         window.column_count, window.row_count, kSampleLimit));
  }
  const double west_m = x.begin * grid.sample_x_m;
  const double south_m = y.begin * grid.sample_y_m;
  if (std::abs(west_m - request.west_m) > 1e-3 || std::abs(south_m - request.south_m) > 1e-3) {
    notes.push_back(fmt::format("{}: corner moved to the sample at ({}, {}) m", request.file, plainNumber(west_m),
                                plainNumber(south_m)));
  }
  return window;
}

/// GDAL's readers of text grids find a row by reading all before it, again for each that fails: on a file cut short
/// that takes for ever unless rows are asked for one after the other from the first.
bool isTextGrid(GDALRasterBandH band) {
  const std::string driver = GDALGetDriverShortName(GDALGetDatasetDriver(GDALGetBandDataset(band)));
  return driver == "AAIGrid" || driver == "GRASSASCIIGrid" || driver == "ISG";
}

/// Turns a row of values into heights from `at` on.
Status convertRow(const DemRequest& request, const ValueRule& rule, const std::vector<double>& values, int first_column,
                  int row, std::size_t at, Dem& dem, std::vector<std::uint8_t>& missing) {
  const auto where = [&](std::size_t i) {
    return fmt::format("column {}, row {}", first_column + std::int64_t(i), row);
  };
  for (std::size_t i = 0; i < values.size(); ++i) {
    missing[at + i] = rule.missing(values[i]) ? 1 : 0;
    if (missing[at + i]) continue;
    if (rule.suspicious(values[i])) {
      return demError(request,
                      fmt::format("value {} at {}: unfinished? It usually marks missing data, but the file does not "
                                  "say so; nodata = {} in a scene's [base] fills it",
                                  values[i], where(i), values[i]));
    }
    const double height_m = values[i] * rule.factor + rule.offset_m;
    if (!(std::abs(height_m) * rules::kUnitsPerMetre <= kGroundLimitQ)) {
      return demError(request,
                      fmt::format("height {} m at {} is beyond +-{:.0f} m; if it marks missing data, say so with "
                                  "nodata in a scene's [base]",
                                  plainNumber(height_m), where(i), kGroundLimitQ / rules::kUnitsPerMetre));
    }
    dem.height_q[at + i] = toUnits(height_m);
  }
  return {};
}

/// Reads the window, turned so that the south comes first. `missing` gets 1 for each sample without data.
Status readHeights(const DemRequest& request, GDALRasterBandH band, const Window& window, bool north_first,
                   const ValueRule& rule, const GdalQuiet& quiet, Dem& dem, std::vector<std::uint8_t>& missing) {
  const std::size_t columns = std::size_t(window.column_count);
  dem.height_q.assign(columns * window.row_count, 0);
  missing.assign(dem.height_q.size(), 0);
  std::vector<double> values(columns);
  for (int row = isTextGrid(band) ? 0 : window.row; row < window.row + window.row_count; ++row) {
    const CPLErr result = GDALRasterIO(band, GF_Read, window.column, row, window.column_count, 1, values.data(),
                                       window.column_count, 1, GDT_Float64, 0, 0);
    if (result != CE_None || quiet.failed()) {
      return demError(request,
                      fmt::format("row {} cannot be read, the file is damaged or cut short: {}", row, quiet.message()));
    }
    const int from_first = row - window.row;
    if (from_first < 0) continue;
    const std::size_t to_row = std::size_t(north_first ? window.row_count - 1 - from_first : from_first);
    const Status status = convertRow(request, rule, values, window.column, row, to_row * columns, dem, missing);
    if (!status) return status;
  }
  return {};
}

}  // namespace

Result<Dem> readDem(const DemRequest& request, std::vector<std::string>& notes) {
  const GdalQuiet quiet;
  const Result<RasterFile> dataset = openRaster(request.file, quiet);
  if (!dataset) return Error{dataset.error()};
  const int columns = GDALGetRasterXSize(dataset->get());
  const int rows = GDALGetRasterYSize(dataset->get());
  const Result<Georeference> grid = readGeoreference(dataset->get(), request.file, request.sample_m, notes);
  if (!grid) return Error{grid.error()};
  const GDALRasterBandH band = GDALGetRasterBand(dataset->get(), 1);
  if (const int count = GDALGetRasterCount(dataset->get()); count > 1) {
    notes.push_back(fmt::format("{}: the first of {} bands is taken", request.file, count));
  }
  const Result<ValueRule> rule =
      valueRule(request, band, std::max(columns * grid->sample_x_m, rows * grid->sample_y_m), notes);
  if (!rule) return Error{rule.error()};
  const Result<Window> window = chooseWindow(request, *grid, columns, rows, notes);
  if (!window) return Error{window.error()};

  Dem dem{window->column_count, window->row_count, grid->sample_x_m, grid->sample_y_m, {}};
  std::vector<std::uint8_t> missing;
  const Status read = readHeights(request, band, *window, grid->north_first, *rule, quiet, dem, missing);
  if (!read) return Error{read.error()};
  const std::int64_t missing_count = std::count(missing.begin(), missing.end(), 1);
  if (missing_count == std::int64_t(missing.size())) return demError(request, "no sample holds data (all nodata)");
  if (missing_count > 0) {
    fillMissing(dem.height_q, missing, dem.column_count);
    notes.push_back(fmt::format("{}: {} of {} samples hold no data: filled from their nearest valid neighbours",
                                request.file, missing_count, missing.size()));
  }
  return dem;
}

}  // namespace spoor
