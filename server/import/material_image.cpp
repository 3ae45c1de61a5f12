#include "server/import/material_image.h"

#include <fmt/format.h>

#include <algorithm>

#include "server/import/raster_file.h"
#include "server/import/units.h"

namespace spoor {
namespace {

using Colour = std::array<std::uint8_t, 3>;

/// Reads a raster row by row.
class RowReader {
 public:
  RowReader(GDALDatasetH dataset, bool of_colours)
      : columns_(GDALGetRasterXSize(dataset)), first_(GDALGetRasterBand(dataset, 1)), of_colours_(of_colours) {
    bands_ = {first_};
    if (!of_colours) return;
    palette_ = GDALGetRasterColorTable(first_);
    if (palette_ == nullptr && GDALGetRasterCount(dataset) >= 3)
      bands_ = {first_, GDALGetRasterBand(dataset, 2), GDALGetRasterBand(dataset, 3)};
  }

  bool holdsColours() const {
    return std::ranges::all_of(bands_, [](GDALRasterBandH band) { return GDALGetRasterDataType(band) == GDT_Byte; });
  }

  bool read(int row) {
    values_.resize(bands_.size() * std::size_t(columns_));
    for (std::size_t i = 0; i < bands_.size(); ++i)
      if (GDALRasterIO(bands_[i], GF_Read, 0, row, columns_, 1, values_.data() + i * std::size_t(columns_), columns_, 1,
                       GDT_Float64, 0, 0) != CE_None)
        return false;
    return true;
  }

  double value(int column) const { return values_[std::size_t(column)]; }

  Colour colour(int column) const {
    if (palette_ != nullptr) {
      GDALColorEntry entry{};
      GDALGetColorEntryAsRGB(palette_, int(value(column)), &entry);
      return {std::uint8_t(entry.c1), std::uint8_t(entry.c2), std::uint8_t(entry.c3)};
    }
    Colour colour;
    for (std::size_t i = 0; i < 3; ++i)
      colour[i] = std::uint8_t(values_[(bands_.size() == 3 ? i : 0) * std::size_t(columns_) + std::size_t(column)]);
    return colour;
  }

  bool names(const LegendEntry& entry, int column) const {
    return of_colours_ ? entry.colour == colour(column) : entry.value == value(column);
  }

  std::string text(int column) const {
    if (!of_colours_) return "value " + plainNumber(value(column));
    const Colour seen = colour(column);
    return fmt::format("colour #{:02x}{:02x}{:02x}", seen[0], seen[1], seen[2]);
  }

 private:
  int columns_;
  GDALRasterBandH first_;
  std::vector<GDALRasterBandH> bands_;
  GDALColorTableH palette_ = nullptr;
  bool of_colours_;
  std::vector<double> values_;  // of a row, band after band
};

}  // namespace

Result<MaterialSamples> readMaterialImage(const MaterialImageRequest& request) {
  const auto wrong = [&](const std::string& why) { return Error{request.file + ": " + why}; };
  const GdalQuiet quiet;
  const Result<RasterFile> file = openRaster(request.file, quiet);
  if (!file) return Error{file.error()};
  MaterialSamples samples;
  samples.column_count = GDALGetRasterXSize(file->get());
  samples.row_count = GDALGetRasterYSize(file->get());
  const std::int64_t count = std::int64_t(samples.column_count) * samples.row_count;
  if (std::max(samples.column_count, samples.row_count) > 1 << 20 || count > kMaterialSamplesLimit)
    return wrong(fmt::format("{} x {} samples, the limit is {}", samples.column_count, samples.row_count,
                             kMaterialSamplesLimit));
  std::array<double, 6> transform{};
  const bool south_first = GDALGetGeoTransform(file->get(), transform.data()) == CE_None && transform[5] > 0;
  const bool of_colours =
      std::ranges::any_of(request.legend, [](const auto& entry) { return entry.colour.has_value(); });
  RowReader reader(file->get(), of_colours);
  if (of_colours && !reader.holdsColours()) return wrong("holds no colours of 8 bits; a legend of values goes with it");
  samples.material.resize(std::size_t(count));
  for (int row = 0; row < samples.row_count; ++row) {
    if (!reader.read(row) || quiet.failed())
      return wrong(fmt::format("row {} cannot be read, the file is damaged or cut short: {}", row, quiet.message()));
    const int to_row = south_first ? row : samples.row_count - 1 - row;
    for (int column = 0; column < samples.column_count; ++column) {
      const auto found =
          std::ranges::find_if(request.legend, [&](const LegendEntry& entry) { return reader.names(entry, column); });
      if (found == request.legend.end() && !request.otherwise)
        return wrong(fmt::format("{} at column {}, row {} is not in the legend; otherwise = \"NAME\" takes what is not",
                                 reader.text(column), column, row));
      samples.material[std::size_t(to_row) * std::size_t(samples.column_count) + std::size_t(column)] =
          found == request.legend.end() ? *request.otherwise : found->material;
    }
  }
  return samples;
}

}  // namespace spoor
