#include "server/import/pack_maker.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "server/import/units.h"
#include "server/named_parameters.h"
#include "shaders/rules/limits.h"

namespace spoor {
namespace {

constexpr double kSamplesPerCellLimit = 64;  // validatePack
constexpr double kTwo32 = 4294967296.0;

/// Share of side neighbours among a DEM's samples whose slope is above the threshold of each of the pack's materials.
double steepShare(const ScenePack& pack, const Dem& dem) {
  const double slope =
      double(std::ranges::max(pack.parameters.materials, {}, &MaterialRules::slope_threshold_q).slope_threshold_q) /
      pack.cell_q;
  const double rest_x_q = slope * dem.sample_x_m * rules::kUnitsPerMetre;
  const double rest_y_q = slope * dem.sample_y_m * rules::kUnitsPerMetre;
  std::int64_t steep_count = 0;
  const std::size_t columns = std::size_t(dem.column_count);
  for (std::size_t at = 0; at < dem.height_q.size(); ++at) {
    if (at % columns + 1 < columns) steep_count += std::abs(double(dem.height_q[at + 1]) - dem.height_q[at]) > rest_x_q;
    if (at + columns < dem.height_q.size())
      steep_count += std::abs(double(dem.height_q[at + columns]) - dem.height_q[at]) > rest_y_q;
  }
  return double(steep_count) / (2.0 * double(dem.height_q.size()));
}

}  // namespace

void setReposeAngle(ScenePack& pack, double repose_deg, std::vector<std::string>& notes) {
  if (setRepose(repose_deg, pack.cell_q, pack.parameters.materials[0]))
    notes.push_back(
        fmt::format("soil.repose_deg: {} degrees are less than 0.1 mm per cell: slope threshold rounded up to "
                    "0.1 mm",
                    plainNumber(repose_deg)));
}

Status setWorldSize(ScenePack& pack, double width_m, double height_m) {
  const double cell_m = double(pack.cell_q) / rules::kUnitsPerMetre;
  // Leaves room for bodies at its edge within 32 bits (validatePack).
  const double limit_m = double(0x7fffffff - (1 << 26)) / rules::kUnitsPerMetre;
  const double limit_cells = std::min(double(kWorldCellsLimit), std::floor(limit_m / cell_m));
  const double width_cells = std::round(width_m / cell_m);
  const double height_cells = std::round(height_m / cell_m);
  const auto fits = [&](double cells) { return cells >= 1 && cells <= limit_cells; };
  if (!fits(width_cells) || !fits(height_cells)) {
    return Error{fmt::format(
        "{} x {} m are {:.0f} x {:.0f} cells of {} m; a world has 1 .. {:.0f} of these along a side",
        plainNumber(width_m), plainNumber(height_m), width_cells, height_cells, plainNumber(cell_m), limit_cells)};
  }
  pack.width_cells = std::int32_t(width_cells);
  pack.height_cells = std::int32_t(height_cells);
  return {};
}

Status setGround(ScenePack& pack, Dem dem, const std::string& file, std::vector<std::string>& notes) {
  const double cell_m = double(pack.cell_q) / rules::kUnitsPerMetre;
  const double per_cell_x = cell_m / dem.sample_x_m;
  const double per_cell_y = cell_m / dem.sample_y_m;
  if (std::max(per_cell_x, per_cell_y) > kSamplesPerCellLimit || std::min(per_cell_x, per_cell_y) * kTwo32 < 1) {
    return Error{fmt::format(
        "{}: samples {} x {} m apart do not go with cells of {} m: more than {} samples per cell, or "
        "more than 2^32 cells per sample",
        file, plainNumber(dem.sample_x_m), plainNumber(dem.sample_y_m), plainNumber(cell_m), kSamplesPerCellLimit)};
  }
  notes.push_back(fmt::format("{}: {} x {} samples {} x {} m apart resampled to cells of {} m (bicubic, on demand)",
                              file, dem.column_count, dem.row_count, plainNumber(dem.sample_x_m),
                              plainNumber(dem.sample_y_m), plainNumber(cell_m)));
  const double beyond_x_m = pack.width_cells * cell_m - dem.widthM();
  const double beyond_y_m = pack.height_cells * cell_m - dem.heightM();
  if (beyond_x_m > cell_m || beyond_y_m > cell_m) {
    notes.push_back(fmt::format("{}: the world reaches {} m east and {} m north beyond it; its border heights continue",
                                file, plainNumber(std::max(0.0, beyond_x_m)), plainNumber(std::max(0.0, beyond_y_m))));
  }
  if (const double share = steepShare(pack, dem); share > 0) {
    notes.push_back(
        fmt::format("{}: {:.2g} % of its slopes are steeper than the angle of repose; soil there will slide once "
                    "it is reached",
                    file, share * 100));
  }
  pack.base_kind = BaseKind::samples;
  pack.samples.column_count = dem.column_count;
  pack.samples.row_count = dem.row_count;
  pack.samples.step_x_q32 = std::llround(per_cell_x * kTwo32);
  pack.samples.step_y_q32 = std::llround(per_cell_y * kTwo32);
  pack.samples.height_q = std::move(dem.height_q);
  return {};
}

Status checkPack(const ScenePack& pack) {
  if (Status status = validatePack(pack); !status) return status;
  std::size_t bytes = pack.samples.height_q.size() * sizeof(std::int32_t) + (1 << 16);
  bytes += pack.material_map.image.material.size();
  for (const Mesh& mesh : pack.meshes) {
    bytes += mesh.vertices.size() * 12 + mesh.triangles.size() * 12 + mesh.edges.size() * 8 + mesh.name.size() + 16;
  }
  for (const Path& path : pack.paths) bytes += path.waypoints.size() * sizeof(Waypoint) + 16;
  for (const Body& body : pack.bodies) bytes += sizeof(Body) + body.name.size();
  if (bytes > kPackBytesLimit) {
    return Error{
        fmt::format("pack: {} MiB, more than {}; fewer samples or triangles help", bytes >> 20, kPackBytesLimit >> 20)};
  }
  return {};
}

}  // namespace spoor
