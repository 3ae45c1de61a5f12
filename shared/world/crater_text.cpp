#include "shared/world/crater_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <optional>

#include "shared/base/hash.h"
#include "shared/world/pack.h"

namespace spoor {
namespace {

constexpr std::size_t kFieldsLimit = 7;
constexpr std::size_t kFieldsLeast = 5;
constexpr std::array<const char*, kFieldsLimit> kFieldNames = {"X", "Y", "R1", "R2", "D5", "H4", "NOISE"};
constexpr double kMetresLimit = 210000;  // what 32 bits of 0.1 mm hold, and a little less

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

std::optional<double> numberIn(std::string_view text, double lowest, double highest) {
  double value = 0;
  const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end.ec != std::errc{} || end.ptr != text.data() + text.size()) return {};
  if (!(value >= lowest && value <= highest)) return {};
  return value;
}

/// Other numbers, another noise.
std::uint16_t drawnSeed(const Crater& crater) {
  std::uint64_t drawn = 0;
  for (const std::int32_t value : {crater.x_q, crater.y_q, crater.inner_radius_q, crater.crest_radius_q})
    drawn = mix64(drawn ^ std::uint32_t(value)) + 0x9e3779b97f4a7c15u;
  return std::uint16_t(drawn >> 48);
}

}  // namespace

Result<Crater> resolveCrater(const ScenePack& pack, const CraterWish& wish) {
  Crater crater = wish.crater;
  if (wish.balanced) crater.rim_height_q = 0;  // until it is known that the others can be
  if (Status status = validateCrater(pack, crater); !status) return Error{status.error()};
  if (!wish.balanced) return crater;
  crater.rim_height_q = balancedRimHeight(crater.inner_radius_q, crater.crest_radius_q, crater.depth_q);
  if (Status status = validateCrater(pack, crater); !status) return Error{status.error()};
  return crater;
}

Result<CraterWish> parseCrater(std::string_view text) {
  std::array<std::string_view, kFieldsLimit> fields;
  std::size_t count = 0;
  for (std::string_view rest = text;;) {
    const auto comma = rest.find(',');
    if (count == kFieldsLimit) return Error{quoted(text) + " has more than 7 fields"};
    fields[count++] = trimmed(rest.substr(0, comma));
    if (comma == std::string_view::npos) break;
    rest.remove_prefix(comma + 1);
  }
  if (count < kFieldsLeast) return Error{quoted(text) + " is not X,Y,R1,R2,D5[,H4|balanced][,NOISE]"};
  CraterWish wish;
  Crater& crater = wish.crater;
  wish.balanced = count < 6 || fields[5] == "balanced";
  const std::array<std::int32_t*, 6> lengths = {
      &crater.x_q, &crater.y_q, &crater.inner_radius_q, &crater.crest_radius_q, &crater.depth_q, &crater.rim_height_q};
  for (std::size_t i = 0; i < std::min<std::size_t>(count, lengths.size()); ++i) {
    if (i == 5 && wish.balanced) continue;
    const auto value = numberIn(fields[i], -kMetresLimit, kMetresLimit);
    if (!value) return Error{std::string(kFieldNames[i]) + ": " + quoted(fields[i]) + " is not a number of metres"};
    *lengths[i] = std::int32_t(std::llround(*value * rules::kUnitsPerMetre));
  }
  if (count == kFieldsLimit) {
    const auto noise = numberIn(fields[6], 0, 1);
    if (!noise) return Error{"NOISE: " + quoted(fields[6]) + " is not a number within 0 .. 1"};
    crater.noise_q16 = std::uint16_t(std::min<long long>(std::llround(*noise * 65536), 65535));
  }
  crater.noise_seed = drawnSeed(crater);
  return wish;
}

Result<TimedCrater> parseTimedCrater(std::string_view text) {
  TimedCrater timed;
  const auto end = std::from_chars(text.data(), text.data() + text.size(), timed.tick);
  if (end.ec != std::errc{} || end.ptr == text.data() + text.size() || *end.ptr != ':' || timed.tick < 1)
    return Error{"does not begin with a tick, 1 or later, and a colon"};
  auto wish = parseCrater(text.substr(std::size_t(end.ptr + 1 - text.data())));
  if (!wish) return Error{wish.error()};
  timed.wish = *wish;
  return timed;
}

std::string describeCrater(const Crater& crater) {
  std::string text = "(" + metresText(crater.x_q) + ", " + metresText(crater.y_q) + ") m, R1 " +
                     metresText(crater.inner_radius_q) + " m, R2 " + metresText(crater.crest_radius_q) + " m, D5 " +
                     metresText(crater.depth_q) + " m, H4 " + metresText(crater.rim_height_q) + " m";
  if (crater.noise_q16 == 0) return text;
  char noise[32];
  std::snprintf(noise, sizeof noise, ", noise %.3g", crater.noise_q16 / 65536.0);
  return text + noise;
}

}  // namespace spoor
