// [[snowfall]]: soil that falls on the world.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "server/import/scene_parts.h"
#include "server/import/units.h"
#include "server/snowfall_text.h"
#include "shaders/rules/limits.h"
#include "shared/base/hash.h"

namespace spoor {
namespace {

constexpr Range kPlaceRange{-2e5, 2e5, "m"};
constexpr Range kTimeRange{0, 1e6, "s"};

std::array<double, 4> readArea(TableReader& table, const ScenePack& pack) {
  const double cell_m = double(pack.cell_q) / rules::kUnitsPerMetre;
  const std::array<double, 2> size_m = {pack.width_cells * cell_m, pack.height_cells * cell_m};
  const bool from_centre = table.choice("origin", {"corner", "centre"}, "corner") == "centre";
  if (!table.has("area_m")) return {0, 0, size_m[0], size_m[1]};
  const std::vector<double> area = table.numbers("area_m", 4, kPlaceRange);
  std::array<double, 4> result;
  for (std::size_t i = 0; i < 4; ++i) result[i] = area[i] + (from_centre ? size_m[i % 2] / 2 : 0);
  return result;
}

/// What a wish lost on the way to cells.
void noteArea(TableReader& table, const ScenePack& pack, const SnowfallWish& wish, const Snowfall& snowfall,
              std::vector<std::string>& notes) {
  const double cell_m = double(pack.cell_q) / rules::kUnitsPerMetre;
  const std::array<std::int32_t, 4> cells = {snowfall.area.x0, snowfall.area.y0, snowfall.area.x1, snowfall.area.y1};
  bool differs = false;
  for (std::size_t i = 0; i < 4; ++i) differs = differs || std::abs(cells[i] * cell_m - wish.area_m[i]) > 1e-6;
  if (differs)
    notes.push_back(fmt::format("{}: taken as the cells of the world from ({}, {}) to ({}, {}) m",
                                table.keyPath("area_m"), plainNumber(cells[0] * cell_m), plainNumber(cells[1] * cell_m),
                                plainNumber(cells[2] * cell_m), plainNumber(cells[3] * cell_m)));
}

/// The last tick that is over by a time.
double ticksBy(TableReader& table, const char* key, double at_s, const ScenePack& pack,
               std::vector<std::string>& notes) {
  const double exact = at_s * pack.ticks_per_second;
  const double ticks = std::round(exact);
  if (std::abs(ticks - exact) > 1e-6)
    notes.push_back(fmt::format("{}: {} s rounded to {} ticks, {} s", table.keyPath(key), plainNumber(at_s),
                                plainNumber(ticks), plainNumber(ticks / pack.ticks_per_second)));
  return ticks;
}

void readSnowfall(TableReader& table, const SceneErrors& errors, SceneDraft& draft) {
  ScenePack& pack = draft.scene.pack;
  std::vector<std::string>& notes = draft.scene.notes;
  SnowfallWish wish;
  wish.area_m = readArea(table, pack);
  wish.rate_mm_per_hour = table.number("rate_mm_per_hour", {1e-9, 1e12, "mm per hour"});
  const double scene_s = double(pack.default_ticks) / pack.ticks_per_second;
  const double start = ticksBy(table, "start_s", table.number("start_s", kTimeRange, 0), pack, notes);
  const double end = ticksBy(table, "end_s", table.number("end_s", {0, 1e7, "s"}, scene_s), pack, notes);
  if (end <= start)
    table.wrong("end_s", table.has("end_s") ? "is not after start_s" : "missing; the scene ends before start_s");
  wish.seed = std::uint32_t(table.integer("seed", {0, 4294967295.0, ""},
                                          std::int64_t(mix64(pack.seed + mix64(pack.snowfalls.size() + 77)) >> 32)));
  table.finish();
  if (errors.failed()) return;
  wish.duration_s = (end - start) / pack.ticks_per_second;
  const auto snowfall = resolveSnowfall(pack, wish, std::int32_t(start) + 1);
  if (!snowfall) {
    const std::string& why = snowfall.error();
    return table.wrong(why.starts_with("area") ? "area_m" : "rate_mm_per_hour", why);
  }
  noteArea(table, pack, wish, *snowfall, notes);
  pack.snowfalls.push_back(*snowfall);
}

}  // namespace

void readSnowfallTables(TableReader& file, const SceneErrors& errors, SceneDraft& draft) {
  std::vector<TableReader> tables = file.tables("snowfall");
  if (tables.size() > kSnowfallsLimit)
    file.wrong("snowfall", fmt::format("{} tables, the limit is {}", tables.size(), kSnowfallsLimit));
  for (TableReader& table : tables)
    if (!errors.failed()) readSnowfall(table, errors, draft);
}

}  // namespace spoor
