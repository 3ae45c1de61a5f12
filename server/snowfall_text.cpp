#include "server/snowfall_text.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>

#include "server/plain_number.h"
#include "shaders/rules/limits.h"
#include "shared/base/hash.h"

namespace spoor {
namespace {

constexpr double kMetresLimit = 210000;
constexpr double kRateLimit = 1e12;     // mm per hour; beyond all that a tick may bring
constexpr double kDurationLimit = 1e8;  // s; beyond what 2^30 ticks last at 60 Hz
constexpr double kUnitsPerMillimetre = 10;
constexpr double kSecondsPerHour = 3600;
constexpr double kTwo32 = 4294967296.0;

struct Field {
  const char* name;
  double lowest, highest;
  const char* unit;
};
constexpr std::array<Field, 6> kFields = {{{"X0", -kMetresLimit, kMetresLimit, "m"},
                                           {"Y0", -kMetresLimit, kMetresLimit, "m"},
                                           {"X1", -kMetresLimit, kMetresLimit, "m"},
                                           {"Y1", -kMetresLimit, kMetresLimit, "m"},
                                           {"MM_PER_HOUR", 0, kRateLimit, "mm per hour"},
                                           {"SECONDS", 0, kDurationLimit, "s"}}};

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

/// For a message: text from outside, printable and not too long.
std::string quoted(std::string_view text) {
  std::string result(text.substr(0, 40));
  std::ranges::replace_if(
      result, [](char c) { return c < ' ' || c > '~'; }, '?');
  return "'" + result + (text.size() > 40 ? "...'" : "'");
}

template <typename T>
std::optional<T> numberOf(std::string_view text) {
  T value{};
  const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end.ec != std::errc{} || end.ptr != text.data() + text.size()) return {};
  return value;
}

/// Other numbers, another snow.
std::uint32_t drawnSeed(const SnowfallWish& wish, std::int32_t first_tick) {
  std::uint64_t drawn = std::uint64_t(first_tick);
  for (const double value : {wish.area_m[0], wish.area_m[1], wish.area_m[2], wish.area_m[3], wish.rate_mm_per_hour})
    drawn = mix64(drawn ^ std::bit_cast<std::uint64_t>(value)) + 0x9e3779b97f4a7c15u;
  return std::uint32_t(drawn >> 32);
}

}  // namespace

Result<Snowfall> resolveSnowfall(const ScenePack& pack, const SnowfallWish& wish, std::int32_t first_tick) {
  const auto cellsOf = [&](double at_m, std::int32_t cells) {
    const double at = std::round(at_m * rules::kUnitsPerMetre / pack.cell_q);
    return std::int32_t(std::clamp(std::isnan(at) ? 0 : at, 0.0, double(cells)));
  };
  Snowfall snowfall;
  snowfall.area = {cellsOf(wish.area_m[0], pack.width_cells), cellsOf(wish.area_m[1], pack.height_cells),
                   cellsOf(wish.area_m[2], pack.width_cells), cellsOf(wish.area_m[3], pack.height_cells)};
  if (snowfall.area.empty()) return Error{"area: it holds no cell of the world"};
  const double per_tick = wish.rate_mm_per_hour * kUnitsPerMillimetre / kSecondsPerHour / pack.ticks_per_second;
  if (!(wish.rate_mm_per_hour > 0) || !(per_tick * kTwo32 <= double(kSnowRateLimit)))
    return Error{
        "rate: " + plainNumber(wish.rate_mm_per_hour) + " mm per hour are not more than 0 and at most " +
        plainNumber(double(kSnowRateLimit) / kTwo32 / kUnitsPerMillimetre * kSecondsPerHour * pack.ticks_per_second)};
  snowfall.rate_q32 = std::max(std::llround(per_tick * kTwo32), 1LL);
  const double ticks = std::max(std::round(wish.duration_s * pack.ticks_per_second), 1.0);
  if (!(wish.duration_s >= 0) || first_tick + ticks - 1 > double(1 << 30))
    return Error{"duration: " + plainNumber(wish.duration_s) + " s are not within 0 .. 2^30 ticks"};
  snowfall.first_tick = first_tick;
  snowfall.last_tick = first_tick + std::int32_t(ticks) - 1;
  snowfall.seed = wish.seed.value_or(drawnSeed(wish, first_tick));
  if (Status status = validateSnowfall(pack, snowfall); !status) return Error{status.error()};
  return snowfall;
}

Result<SnowfallWish> parseSnowfall(std::string_view text) {
  std::array<std::string_view, kFields.size() + 1> fields;
  std::size_t count = 0;
  for (std::string_view rest = text;;) {
    const auto comma = rest.find(',');
    if (count == fields.size()) return Error{quoted(text) + " has more than 7 fields"};
    fields[count++] = trimmed(rest.substr(0, comma));
    if (comma == std::string_view::npos) break;
    rest.remove_prefix(comma + 1);
  }
  if (count < kFields.size()) return Error{quoted(text) + " is not X0,Y0,X1,Y1,MM_PER_HOUR,SECONDS[,SEED]"};
  SnowfallWish wish;
  const std::array<double*, kFields.size()> values = {&wish.area_m[0], &wish.area_m[1],        &wish.area_m[2],
                                                      &wish.area_m[3], &wish.rate_mm_per_hour, &wish.duration_s};
  for (std::size_t i = 0; i < kFields.size(); ++i) {
    const Field& field = kFields[i];
    const auto value = numberOf<double>(fields[i]);
    if (!value || !(*value >= field.lowest && *value <= field.highest))
      return Error{std::string(field.name) + ": " + quoted(fields[i]) + " is not a number within " +
                   plainNumber(field.lowest) + " .. " + plainNumber(field.highest) + " " + field.unit};
    *values[i] = *value;
  }
  if (count == fields.size()) {
    wish.seed = numberOf<std::uint32_t>(fields.back());
    if (!wish.seed) return Error{"SEED: " + quoted(fields.back()) + " is not a whole number within 0 .. 4294967295"};
  }
  return wish;
}

Result<TimedSnowfall> parseTimedSnowfall(std::string_view text) {
  TimedSnowfall timed;
  const auto end = std::from_chars(text.data(), text.data() + text.size(), timed.tick);
  if (end.ec != std::errc{} || end.ptr == text.data() + text.size() || *end.ptr != ':' || timed.tick < 1)
    return Error{"does not begin with a tick, 1 or later, and a colon"};
  auto wish = parseSnowfall(text.substr(std::size_t(end.ptr + 1 - text.data())));
  if (!wish) return Error{wish.error()};
  timed.wish = *wish;
  return timed;
}

std::string describeSnowfall(const ScenePack& pack, const Snowfall& snowfall) {
  const auto metres = [&](std::int32_t cells) {
    return plainNumber(double(cells) * pack.cell_q / rules::kUnitsPerMetre);
  };
  const double rate =
      double(snowfall.rate_q32) / kTwo32 / kUnitsPerMillimetre * kSecondsPerHour * pack.ticks_per_second;
  const CellBox& area = snowfall.area;
  return "(" + metres(area.x0) + ", " + metres(area.y0) + ") to (" + metres(area.x1) + ", " + metres(area.y1) +
         ") m, " + plainNumber(rate) + " mm per hour, ticks " + std::to_string(snowfall.first_tick) + " .. " +
         std::to_string(snowfall.last_tick) + ", seed " + std::to_string(snowfall.seed);
}

}  // namespace spoor
