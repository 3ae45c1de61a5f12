// [craters] and [[crater]]: what a scene admits, and the craters that it times itself.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "server/import/crater_maker.h"
#include "server/import/scene_parts.h"
#include "server/import/units.h"
#include "shared/base/hash.h"

namespace spoor {
namespace {

double metresOf(std::int64_t units) { return double(units) / rules::kUnitsPerMetre; }

const double kReachM = metresOf(rules::kCraterReachLimit);
const Range kRadiusRange{0, kReachM, "m"};
const Range kCrestRange{0.0001, kReachM, "m"};
const Range kHeightRange{0, metresOf(rules::kCraterHeightLimit), "m"};
constexpr Range kPlaceRange{-2e5, 2e5, "m"};
constexpr Range kDistanceRange{0, 2e5, "m"};
constexpr Range kTimeRange{0, 1e6, "s"};
constexpr double kTickLimit = 1e9;
constexpr double kSeedLimit = 9e18;

void readLimits(TableReader& table, CraterLimits& limits) {
  limits.radius_q = toUnits(table.number("max_radius_m", kRadiusRange, 0));
  const double least_cell_m = std::max(0.0001, std::ceil(limits.radius_q / 16.0) / rules::kUnitsPerMetre);
  limits.hash_cell_q = toUnits(table.number("hash_cell_m", {least_cell_m, 1e5, "m"}, 75));
  limits.request_radius_q = toUnits(table.number("request_max_radius_m", kRadiusRange, 0));
  const bool may_ask = limits.request_radius_q > 0;
  for (const char* key : {"request_max_height_m", "request_distance_m", "requests_per_minute"})
    if (!may_ask && table.has(key)) table.wrong(key, "goes with request_max_radius_m, without which nobody may ask");
  limits.request_height_q =
      toUnits(table.number("request_max_height_m", kHeightRange, may_ask ? std::optional<double>() : 0));
  limits.request_distance_q = toUnits(table.number("request_distance_m", kDistanceRange, 0));
  limits.requests_per_minute = std::int32_t(table.integer("requests_per_minute", {0, 60000, "a minute"}, 30));
}

std::int32_t readTick(TableReader& table, const ScenePack& pack, std::vector<std::string>& notes) {
  if (table.has("at_s") == table.has("tick")) {
    table.wrong(table.has("tick") ? "tick" : "at_s", "give either at_s or tick");
    return 1;
  }
  if (table.has("tick")) return std::int32_t(table.integer("tick", {1, kTickLimit, "ticks"}));
  const double at_s = table.number("at_s", kTimeRange);
  const double exact = at_s * pack.ticks_per_second;
  const double tick = std::max(1.0, std::round(exact));
  if (tick > kTickLimit) table.wrong("at_s", fmt::format("{} s are more than 10^9 ticks", plainNumber(at_s)));
  if (at_s > 0 && std::abs(tick - exact) > 1e-6)
    notes.push_back(fmt::format("{}: {} s rounded to tick {}, {} s", table.keyPath("at_s"), plainNumber(at_s),
                                plainNumber(tick), plainNumber(tick / pack.ticks_per_second)));
  return std::int32_t(std::min(tick, kTickLimit));
}

void readPlace(TableReader& table, const ScenePack& pack, CraterGroup& group) {
  if (!table.has("at_m")) table.wrong("at_m", "missing");
  const bool from_centre = table.choice("origin", {"corner", "centre"}, "corner") == "centre";
  const std::vector<double> at = table.numbers("at_m", 2, kPlaceRange);
  const auto middle = [&](std::int32_t cells) { return from_centre ? std::int64_t(cells) * pack.cell_q / 2 : 0; };
  group.x_q = toUnits(at[0]) + middle(pack.width_cells);
  group.y_q = toUnits(at[1]) + middle(pack.height_cells);
}

/// One number, or in a carpet [least, most] too.
Span readSpan(TableReader& table, std::string_view key, const Range& range, bool is_carpet,
              std::optional<double> otherwise = {}) {
  if (is_carpet) return table.span(key, range, otherwise);
  const double value = table.number(key, range, otherwise);
  return {value, value};
}

DrawnFrom lengths(const Span& span) { return {toUnits(span.least), toUnits(span.most)}; }

std::int32_t strengthOf(double share) { return std::int32_t(std::min(std::llround(share * 65536), 65535LL)); }

void readShape(TableReader& table, bool is_carpet, CraterGroup& group) {
  group.crest_radius_q = lengths(readSpan(table, "r2_m", kCrestRange, is_carpet));
  group.inner_radius_q = lengths(readSpan(table, "r1_m", kRadiusRange, is_carpet));
  if (group.inner_radius_q.least > group.crest_radius_q.least)
    table.wrong("r1_m", fmt::format("{} m is more than r2_m, {} m", plainNumber(metresOf(group.inner_radius_q.least)),
                                    plainNumber(metresOf(group.crest_radius_q.least))));
  group.depth_q = lengths(readSpan(table, "depth_m", kHeightRange, is_carpet));
  group.balanced = table.flag("balanced", false);
  if (group.balanced && table.has("rim_m")) table.wrong("rim_m", "give either rim_m or balanced = true");
  if (!group.balanced && !table.has("rim_m")) table.wrong("rim_m", "missing; rim_m or balanced = true");
  if (!group.balanced) group.rim_height_q = lengths(readSpan(table, "rim_m", kHeightRange, is_carpet));
  const Span noise = readSpan(table, "noise", {0, 1, ""}, is_carpet, 0);
  group.noise_q16 = {strengthOf(noise.least), strengthOf(noise.most)};
}

std::int64_t ticksQ16(double time_s, const ScenePack& pack) {
  return std::llround(std::min(time_s * pack.ticks_per_second, kTickLimit) * 65536);
}

void readSalvo(TableReader& table, const ScenePack& pack, CraterGroup& group) {
  group.count = std::int32_t(table.integer("count", {1, double(kTickCratersLimit), "craters"}));
  group.apart_ticks_q16 = ticksQ16(table.number("every_s", kTimeRange), pack);
  group.ahead_q16 = 1 << 15;
  const std::vector<double> step = table.numbers("step_m", 2, kPlaceRange);
  group.step_x_q = toUnits(step[0]);
  group.step_y_q = toUnits(step[1]);
  group.disc_q = toUnits(table.number("spread_m", {0, 1e5, "m"}, 0));
}

void readCarpet(TableReader& table, const ScenePack& pack, CraterGroup& group) {
  group.count = std::int32_t(table.integer("count", {1, double(kCratersLimit), "craters"}));
  if (table.has("radius_m") == table.has("size_m"))
    table.wrong(table.has("size_m") ? "size_m" : "radius_m", "give either radius_m or size_m");
  if (table.has("radius_m")) {
    group.disc_q = toUnits(table.number("radius_m", {0.0001, 1e5, "m"}));
  } else {
    const std::vector<double> size = table.numbers("size_m", 2, {0, 2e5, "m"});
    group.width_q = toUnits(size[0]);
    group.height_q = toUnits(size[1]);
  }
  group.apart_ticks_q16 = ticksQ16(table.number("over_s", kTimeRange, 0), pack) / std::max(group.count, 1);
}

CraterGroup readGroup(TableReader& table, std::size_t index, const ScenePack& pack, std::vector<std::string>& notes) {
  const std::string kind = table.choice("kind", {"single", "salvo", "carpet"}, "single");
  CraterGroup group;
  group.first_tick = readTick(table, pack, notes);
  readPlace(table, pack, group);
  readShape(table, kind == "carpet", group);
  group.seed = mix64(pack.seed + mix64(index + 1));
  if (kind == "single") {
    group.noise_seed = std::int32_t(table.integer("noise_seed", {0, 65535, ""}, -1));
  } else {
    if (kind == "salvo") readSalvo(table, pack, group);
    if (kind == "carpet") readCarpet(table, pack, group);
    group.seed = std::uint64_t(table.integer("seed", {0, kSeedLimit, ""}, std::int64_t(group.seed >> 1)));
  }
  table.finish();
  return group;
}

/// Adds a group's craters to the pack. Those that lie off the map are left out, and said.
void addGroup(TableReader& table, const CraterGroup& group, bool has_limit, SceneDraft& draft) {
  ScenePack& pack = draft.scene.pack;
  if (pack.craters.size() + std::size_t(group.count) > kCratersLimit)
    return table.wrong("count", fmt::format("a session has at most {} craters", kCratersLimit));
  const std::vector<Crater> craters = makeCraters(group);
  std::int32_t added = 0, late = 0;
  ScenePack any = {};  // the same map, for craters of any size
  any.width_cells = pack.width_cells;
  any.height_cells = pack.height_cells;
  any.cell_q = pack.cell_q;
  any.crater_limits.radius_q = rules::kCraterReachLimit;
  for (const Crater& crater : craters) {
    const std::int32_t limit_q = has_limit ? pack.crater_limits.radius_q : rules::kCraterReachLimit;
    if (crater.outerRadius() > limit_q)
      return table.wrong(
          "r2_m", fmt::format("R3 = 2 r2_m - r1_m is {} m, {} {} m", plainNumber(metresOf(crater.outerRadius())),
                              has_limit ? "craters.max_radius_m is" : "at most", plainNumber(metresOf(limit_q))));
    if (!validateCrater(any, crater)) continue;
    late += crater.tick > pack.default_ticks ? 1 : 0;
    ++added;
    if (!has_limit)
      pack.crater_limits.radius_q = std::max(pack.crater_limits.radius_q, std::int32_t(crater.outerRadius()));
    pack.craters.push_back(crater);
  }
  if (added == 0) return table.wrong("at_m", "nothing of it lies on the map");
  if (added < group.count)
    draft.scene.notes.push_back(fmt::format("{}: {} of {} craters lie off the map and are left out", table.where(),
                                            group.count - added, group.count));
  if (late > 0)
    draft.scene.notes.push_back(fmt::format("{}: {} of {} craters come after the scene's {} ticks", table.where(), late,
                                            group.count, pack.default_ticks));
}

}  // namespace

void readCraterTables(TableReader& file, const SceneErrors& errors, SceneDraft& draft) {
  ScenePack& pack = draft.scene.pack;
  TableReader table = file.table("craters");
  const bool has_limit = table.has("max_radius_m");
  readLimits(table, pack.crater_limits);
  table.finish();
  if (errors.failed()) return;
  std::size_t index = 0;
  for (TableReader& crater : file.tables("crater")) {
    const CraterGroup group = readGroup(crater, index++, pack, draft.scene.notes);
    if (errors.failed()) return;
    addGroup(crater, group, has_limit, draft);
    if (errors.failed()) return;
  }
  std::ranges::stable_sort(pack.craters, {}, &Crater::tick);
  for (std::size_t i = 0; i < pack.craters.size(); ++i) pack.craters[i].id = std::uint32_t(i);
  const CraterLimits& limits = pack.crater_limits;
  if (limits.request_radius_q > limits.radius_q)
    table.wrong("request_max_radius_m",
                fmt::format("{} m is more than max_radius_m, {} m{}", plainNumber(metresOf(limits.request_radius_q)),
                            plainNumber(metresOf(limits.radius_q)),
                            has_limit ? "" : " (as large as the largest of [[crater]])"));
  if (std::int64_t(limits.hash_cell_q) * 16 < limits.radius_q)
    table.wrong("hash_cell_m",
                fmt::format("{} m is less than a sixteenth of max_radius_m, {} m",
                            plainNumber(metresOf(limits.hash_cell_q)), plainNumber(metresOf(limits.radius_q))));
}

}  // namespace spoor
