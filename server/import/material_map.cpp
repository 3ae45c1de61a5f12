// [materials]: which material lies where.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

#include "server/import/material_image.h"
#include "server/import/scene_parts.h"
#include "server/import/units.h"
#include "shaders/rules/limits.h"

namespace spoor {
namespace {

constexpr double kTwo32 = 4294967296.0;
constexpr double kSamplesPerCellLimit = 64;  // validateMaterials
constexpr Range kHeightRange{-1e5, 1e5, "m"};
constexpr Range kSlopeRange{0, 90, "degrees"};

/// The number of the material that a key names.
std::uint8_t readMaterial(TableReader& table, std::string_view key, const ScenePack& pack) {
  const std::string name = table.text(key);
  const auto found = std::ranges::find(pack.materials, name, &Material::name);
  if (found != pack.materials.end()) return std::uint8_t(found - pack.materials.begin());
  table.wrong(key, "no [[material]] is named '" + name + "'");
  return 0;
}

std::vector<LegendEntry> readLegend(TableReader& table, const ScenePack& pack) {
  std::vector<LegendEntry> legend;
  for (const std::string& key : table.keys()) {
    LegendEntry entry;
    entry.colour = parseColour(key);
    if (!entry.colour) {
      const auto end = std::from_chars(key.data(), key.data() + key.size(), entry.value);
      if (end.ec != std::errc{} || end.ptr != key.data() + key.size() || !std::isfinite(entry.value))
        table.wrong(key, "must be a colour, \"#rrggbb\", or a value of the image");
    }
    entry.material = readMaterial(table, key, pack);
    if (!legend.empty() && legend.front().colour.has_value() != entry.colour.has_value())
      table.wrong(key, "give either colours or values");
    legend.push_back(entry);
  }
  return legend;
}

void readImage(TableReader& table, const SceneErrors& errors, SceneDraft& draft) {
  ScenePack& pack = draft.scene.pack;
  MaterialImageRequest request;
  request.file = filePath(draft, table.text("image"));
  TableReader legend = table.table("legend");
  request.legend = readLegend(legend, pack);
  if (request.legend.empty()) table.wrong("legend", "missing, or empty; colours or values, and whose they are");
  if (table.has("otherwise")) request.otherwise = readMaterial(table, "otherwise", pack);
  const bool has_pixel = table.has("pixel_m");
  const double pixel_m = table.number("pixel_m", {1e-4, 1e6, "m"}, 1);
  if (errors.failed()) return;
  Result<MaterialSamples> samples = readMaterialImage(request);
  if (!samples) return table.wrong("image", samples.error());
  const double cell_m = double(pack.cell_q) / rules::kUnitsPerMetre;
  const double per_cell_x = has_pixel ? cell_m / pixel_m : double(samples->column_count) / pack.width_cells;
  const double per_cell_y = has_pixel ? cell_m / pixel_m : double(samples->row_count) / pack.height_cells;
  if (std::max(per_cell_x, per_cell_y) > kSamplesPerCellLimit)
    return table.wrong(has_pixel ? "pixel_m" : "image",
                       fmt::format("{} x {} samples are more than {} per cell of {} m", samples->column_count,
                                   samples->row_count, kSamplesPerCellLimit, plainNumber(cell_m)));
  if (has_pixel && (samples->column_count * pixel_m < pack.width_cells * cell_m - cell_m ||
                    samples->row_count * pixel_m < pack.height_cells * cell_m - cell_m))
    draft.scene.notes.push_back(fmt::format("{}: the world reaches beyond its {} x {} m; its border continues",
                                            request.file, plainNumber(samples->column_count * pixel_m),
                                            plainNumber(samples->row_count * pixel_m)));
  pack.material_map.kind = MaterialMapKind::image;
  MaterialImage& image = pack.material_map.image;
  image.column_count = samples->column_count;
  image.row_count = samples->row_count;
  image.step_x_q32 = std::max(std::llround(per_cell_x * kTwo32), 1LL);
  image.step_y_q32 = std::max(std::llround(per_cell_y * kTwo32), 1LL);
  image.material = std::move(samples->material);
}

/// Rises over a cell, so that rules that meet at an angle leave no gap: one rounding for both sides.
std::int32_t slopeBound(double slope_deg, std::int32_t cell_q) {
  const double rise_q = std::tan(slope_deg * std::numbers::pi / 180) * cell_q;
  return slope_deg >= 90 || rise_q > rules::kHeightLimit ? INT32_MAX : std::int32_t(std::llround(rise_q));
}

MaterialRule readRule(TableReader& table, const ScenePack& pack) {
  MaterialRule rule{};
  rule.material = readMaterial(table, "material", pack);
  const auto height = [&](const char* key, std::int32_t otherwise_q) {
    return table.has(key) ? toUnits(table.number(key, kHeightRange)) : otherwise_q;
  };
  rule.lowest_q = height("lowest_m", -rules::kHeightLimit);
  rule.highest_q = height("highest_m", rules::kHeightLimit);
  if (rule.lowest_q > rule.highest_q) table.wrong("highest_m", "is below lowest_m");
  const double gentlest_deg = table.number("gentlest_deg", kSlopeRange, 0);
  const double steepest_deg = table.number("steepest_deg", kSlopeRange, 90);
  if (gentlest_deg > steepest_deg) table.wrong("steepest_deg", "is less than gentlest_deg");
  rule.gentlest_q = slopeBound(gentlest_deg, pack.cell_q);
  rule.steepest_q = slopeBound(steepest_deg, pack.cell_q);
  table.finish();
  return rule;
}

}  // namespace

void readMaterialMap(TableReader& file, const SceneErrors& errors, SceneDraft& draft) {
  if (errors.failed() || !file.has("materials")) return;
  TableReader table = file.table("materials");
  std::vector<TableReader> rules = table.tables("rule");
  if (table.has("image") && !rules.empty()) table.wrong("rule", "give either image or [[materials.rule]] tables");
  if (!table.has("image") && rules.empty())
    table.wrong("image", "missing; an image with its legend, or [[materials.rule]] tables");
  if (table.has("image")) readImage(table, errors, draft);
  for (TableReader& rule : rules) {
    draft.scene.pack.material_map.kind = MaterialMapKind::rules;
    draft.scene.pack.material_map.rules.push_back(readRule(rule, draft.scene.pack));
  }
  table.finish();
}

}  // namespace spoor
