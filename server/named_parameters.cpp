#include "server/named_parameters.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>

#include "shaders/rules/limits.h"
#include "shared/base/fixed.h"

namespace spoor {
namespace {

constexpr std::int32_t kLengthMost = 1 << 29;  // 0.1 mm, as validateParameters has it

std::string numberText(double value) {
  char text[64];
  std::snprintf(text, sizeof text, "%.7g", value);
  return text;
}

/// A share 0 .. 1 in 2^-16. What is above 0 stays so: 0 often means something else than very little.
std::int32_t toQ16(double share) {
  const auto rounded = std::int32_t(std::llround(share * kOneQ16));
  return share > 0 ? std::max(rounded, 1) : 0;
}

std::optional<double> fromQ16(std::int32_t share) { return double(share) / kOneQ16; }

double metresOf(std::int32_t units) { return double(units) / rules::kUnitsPerMetre; }

/// Table 5.1 of the thesis, and what its program does where Spoor has a choice.
Status applyPreset(double value, std::int32_t, NamedSettings& settings) {
  constexpr Displacement displacements[] = {Displacement::iterative, Displacement::direct, Displacement::spread};
  constexpr SlopeRule slopes[] = {SlopeRule::interleaved, SlopeRule::scatter, SlopeRule::scatter};
  Parameters& p = settings.parameters;
  p.displacement = displacements[int(value)];
  p.slopes = slopes[int(value)];
  p.nearest = NearestSearch::jump_flooding;
  p.metric = Metric::euclidean;
  p.compaction_limit_q16 = 0;
  p.capacity_rounds = 1;
  p.obstacle_threshold_q = 1000;
  return {};
}

Status applyNearest(double value, std::int32_t, NamedSettings& settings) {
  NearestSearch& nearest = settings.parameters.nearest;
  if (value == 0)
    nearest = NearestSearch::exact;
  else if (nearest == NearestSearch::exact)  // a variant that is chosen already stays
    nearest = NearestSearch::jump_flooding;
  return {};
}

Status applyVariant(double value, std::int32_t, NamedSettings& settings) {
  NearestSearch& nearest = settings.parameters.nearest;
  if (nearest == NearestSearch::exact) return Error{"goes with nearest = jump_flooding, and nearest is exact"};
  nearest = NearestSearch(int(NearestSearch::jump_flooding) + int(value));
  return {};
}

std::optional<double> readVariant(const NamedSettings& settings, std::int32_t) {
  const NearestSearch nearest = settings.parameters.nearest;
  if (nearest == NearestSearch::exact) return {};
  return double(int(nearest) - int(NearestSearch::jump_flooding));
}

Status applySlope(double value, std::int32_t cell_q, NamedSettings& settings) {
  settings.parameters.slope_threshold_q = slopeThreshold(value, cell_q);
  settings.parameters.diagonal_threshold_q = diagonalThreshold(settings.parameters.slope_threshold_q);
  return {};
}

/// In the middle of the angles that give the threshold.
std::optional<double> readSlope(const NamedSettings& settings, std::int32_t cell_q) {
  const std::int32_t threshold = settings.parameters.slope_threshold_q;
  if (threshold == kNeverSteep) return std::numbers::pi / 2 / metresOf(cell_q) * (1 + 1e-12);
  if (threshold == 0) return 0;
  return std::atan((double(threshold) + 0.5) / rules::kUnitsPerMetre) / metresOf(cell_q);
}

Status applyMargin(double value, std::int32_t cell_q, NamedSettings& settings) {
  // A hair is taken off so that 0.3 m, just over 3 in floats, are three cells of 0.1 m.
  const double cells = std::ceil(value * rules::kUnitsPerMetre / cell_q - 1e-9);
  if (cells > kActiveMarginLimit)
    return Error{numberText(value) + " m are " + numberText(cells) + " cells, the limit is " +
                 std::to_string(kActiveMarginLimit)};
  settings.parameters.active_margin_cells = std::int32_t(cells);
  return {};
}

Status applyFrustum(double value, std::int32_t, NamedSettings& settings) {
  const auto rounded = std::int32_t(std::llround(value * rules::kUnitsPerMetre));
  settings.parameters.frustum_height_q = value > 0 ? std::max(rounded, 1) : 0;
  return {};
}

constexpr std::string_view kWorldIsFixed = "it shapes the world, which is the same for all of a session";
constexpr std::string_view kDrawingIsFixed =
    "it is of the terrain as clients draw it, which they read once, from the pack";

// A parameter that is one field of Parameters or NamedSettings.
#define SPOOR_FIELD(field)                                                     \
  [](double value, std::int32_t, NamedSettings& settings) {                    \
    settings.field = std::remove_reference_t<decltype(settings.field)>(value); \
    return Status();                                                           \
  },                                                                           \
      [](const NamedSettings& settings, std::int32_t) { return std::optional<double>(double(settings.field)); }
#define SPOOR_SHARE(field)                                  \
  [](double value, std::int32_t, NamedSettings& settings) { \
    settings.field = toQ16(value);                          \
    return Status();                                        \
  },                                                        \
      [](const NamedSettings& settings, std::int32_t) { return fromQ16(settings.field); }

std::vector<NamedParameter> makeList() {
  using enum NamedKind;
  const auto choiceOf = [](std::vector<std::string> names) { return names; };
  return {
      // Short names first: what comes after overrides them.
      {"preset", choice, 0, 2, "", choiceOf({"thesis-iterative", "thesis-ssbo", "thesis-ssbo-multiple"}), "",
       applyPreset, nullptr},
      {"terrainSize", number, 0.0001, 208000, "m", {}, kWorldIsFixed, SPOOR_FIELD(terrain_size_m)},
      {"heightmapSize", integer, 1, double(kWorldCellsLimit), "cells", {}, kWorldIsFixed, SPOOR_FIELD(heightmap_size)},
      {"numVerticesPerRow", integer, 0, 4096, "patches", {}, kDrawingIsFixed, SPOOR_FIELD(patches_per_row)},
      {"numIterationsBlurNormals", integer, 0, 16, "", {}, kDrawingIsFixed, SPOOR_FIELD(normal_blur_passes)},
      {"compression", number, 0, 1, "", {}, "", SPOOR_SHARE(parameters.compression_q16)},
      {"roughness", number, 0, 1, "", {}, "", SPOOR_SHARE(parameters.roughness_q16)},
      {"slopeThreshold", number, 0, 20000, "radians per metre", {}, "", applySlope, readSlope},
      {"numIterationsDisplaceMaterialToContour",
       integer,
       0,
       kIterationsLimit,
       "",
       {},
       "",
       SPOOR_FIELD(parameters.displace_iterations)},
      {"numIterationsEvenOutSlopes", integer, 0, kIterationsLimit, "", {}, "", SPOOR_FIELD(parameters.sweeps_per_tick)},
      {"penetrationDivider",
       integer,
       1,
       kLengthMost,
       "units of 0.1 mm",
       {},
       "",
       SPOOR_FIELD(parameters.penetration_divider_q)},
      {"obstacleThreshold",
       integer,
       0,
       kLengthMost,
       "units of 0.1 mm",
       {},
       "",
       SPOOR_FIELD(parameters.obstacle_threshold_q)},
      {"frustumHeight",
       number,
       0,
       53000,
       "m",
       {},
       "",
       applyFrustum,
       [](const NamedSettings& settings, std::int32_t) {
         return std::optional<double>(metresOf(settings.parameters.frustum_height_q));
       }},
      {"activeAreas", flag, 0, 1, "", {}, "", SPOOR_FIELD(parameters.active_areas)},
      {"activeAreaMargin",
       number,
       0,
       400000,
       "m",
       {},
       "",
       applyMargin,
       [](const NamedSettings& settings, std::int32_t cell_q) {
         return std::optional<double>(settings.parameters.active_margin_cells * metresOf(cell_q));
       }},
      {"displacement", choice, 0, 2, "", choiceOf({"direct", "iterative", "spread"}), "",
       SPOOR_FIELD(parameters.displacement)},
      {"nearest", choice, 0, 1, "", choiceOf({"exact", "jump_flooding"}), "", applyNearest,
       [](const NamedSettings& settings, std::int32_t) {
         return std::optional<double>(settings.parameters.nearest == NearestSearch::exact ? 0 : 1);
       }},
      {"jumpFloodingVariant", choice, 0, 4, "", choiceOf({"JFA", "JFA+1", "JFA+2", "1+JFA", "JFA^2"}), "", applyVariant,
       readVariant},
      {"metric", choice, 0, 2, "", choiceOf({"euclidean", "manhattan", "chebyshev"}), "",
       SPOOR_FIELD(parameters.metric)},
      {"slopes", choice, 0, 3, "", choiceOf({"exchange", "flux", "interleaved", "scatter"}), "",
       SPOOR_FIELD(parameters.slopes)},
      {"compactionLimit", number, 0, 1, "", {}, "", SPOOR_SHARE(parameters.compaction_limit_q16)},
      {"spreadCells", integer, 1, kSpreadCellsLimit, "cells", {}, "", SPOOR_FIELD(parameters.spread_cells)},
      {"capacityRounds", integer, 1, kCapacityRoundsLimit, "", {}, "", SPOOR_FIELD(parameters.capacity_rounds)},
  };
}

#undef SPOOR_FIELD
#undef SPOOR_SHARE

/// The fewest decimals that give the same settings again.
std::string shortestText(const NamedParameter& parameter, double about, std::int32_t cell_q,
                         const NamedSettings& settings) {
  char text[400] = "";
  for (int places = 0; places <= 17; ++places) {
    std::snprintf(text, sizeof text, "%.*f", places, about);
    const double value = std::strtod(text, nullptr);
    NamedSettings again = settings;
    if (!parameter.apply(value, cell_q, again)) continue;
    const auto back = parameter.read(again, cell_q);
    if (back && *back == about) break;
  }
  return text;
}

std::string valueText(const NamedParameter& parameter, std::int32_t cell_q, const NamedSettings& settings) {
  const std::optional<double> value = parameter.read(settings, cell_q);
  if (!value) return "-";
  if (parameter.kind == NamedKind::choice) return parameter.choices[std::size_t(*value)];
  if (parameter.kind == NamedKind::flag) return *value != 0 ? "true" : "false";
  if (parameter.kind == NamedKind::integer) return std::to_string(std::int64_t(*value));
  const Parameters& p = settings.parameters;
  if (parameter.apply == applySlope && p.slope_threshold_q == kNeverSteep) return "(no slope is too steep)";
  std::string text = shortestText(parameter, *value, cell_q, settings);
  if (parameter.apply != applySlope) return text;
  text += " (" + numberText(metresOf(p.slope_threshold_q)) + " m rest";
  if (p.diagonal_threshold_q != diagonalThreshold(p.slope_threshold_q))
    text += ", diagonally " + numberText(metresOf(p.diagonal_threshold_q)) + " m";
  return text + ")";
}

/// May a running session change it?
bool isOfTicks(const NamedParameter& parameter) { return parameter.fixed_because.empty() && parameter.read != nullptr; }

NamedSettings settingsOf(const Parameters& parameters) {
  NamedSettings settings;
  settings.parameters = parameters;
  return settings;
}

template <typename T>
std::optional<T> wholeNumber(std::string_view text) {
  T value{};
  const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end.ec != std::errc{} || end.ptr != text.data() + text.size()) return {};
  return value;
}

std::optional<double> parseValue(const NamedParameter& parameter, std::string_view text) {
  if (parameter.kind == NamedKind::flag) {
    if (text == "true" || text == "false") return text == "true" ? 1 : 0;
    return {};
  }
  if (parameter.kind == NamedKind::choice) {
    const auto found = std::ranges::find(parameter.choices, text);
    if (found == parameter.choices.end()) return {};
    return double(found - parameter.choices.begin());
  }
  std::optional<double> value;
  if (parameter.kind == NamedKind::number) value = wholeNumber<double>(text);
  if (parameter.kind == NamedKind::integer)
    if (const auto whole = wholeNumber<std::int64_t>(text)) value = double(*whole);
  if (value && !(*value >= parameter.lowest && *value <= parameter.highest)) return {};
  return value;
}

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

/// For a message: text from outside, printable and not too long.
std::string quoted(std::string_view text) {
  std::string result(text.substr(0, 60));
  for (char& c : result)
    if (c < ' ' || c > '~') c = '?';
  return "'" + result + (text.size() > 60 ? "...'" : "'");
}

}  // namespace

std::span<const NamedParameter> namedParameters() {
  static const std::vector<NamedParameter> list = makeList();
  return list;
}

const NamedParameter* findNamed(std::string_view name) {
  const auto found = std::ranges::find(namedParameters(), name, &NamedParameter::name);
  return found == namedParameters().end() ? nullptr : &*found;
}

std::string rangeText(const NamedParameter& parameter) {
  if (parameter.kind == NamedKind::flag) return "true, false";
  std::string text;
  if (parameter.kind == NamedKind::choice) {
    for (const std::string& name : parameter.choices) text += (text.empty() ? "" : ", ") + name;
    return text;
  }
  const auto bound = [](double value) {
    return value == std::floor(value) ? std::to_string(std::int64_t(value)) : numberText(value);
  };
  return bound(parameter.lowest) + " .. " + bound(parameter.highest) + (parameter.unit.empty() ? "" : " ") +
         std::string(parameter.unit);
}

Result<NamedValue> parseNamed(std::string_view assignment) {
  const auto equals = assignment.find('=');
  if (equals == std::string_view::npos) return Error{quoted(trimmed(assignment)) + " is not NAME=VALUE"};
  const std::string_view name = trimmed(assignment.substr(0, equals));
  std::string_view value = trimmed(assignment.substr(equals + 1));
  const NamedParameter* parameter = findNamed(name);
  if (parameter == nullptr) return Error{quoted(name) + " is no parameter (scenes/README.md, [thesis])"};
  if (value.size() >= 2 && value.front() == '"' && value.back() == '"') value = value.substr(1, value.size() - 2);
  const auto parsed = parseValue(*parameter, value);
  if (!parsed) {
    const char* kind = parameter->kind == NamedKind::number    ? "a number within "
                       : parameter->kind == NamedKind::integer ? "a whole number within "
                                                               : "one of ";
    return Error{std::string(name) + ": " + quoted(value) + " is not " + kind + rangeText(*parameter)};
  }
  return NamedValue{parameter, *parsed};
}

std::optional<NamedError> applyNamed(std::span<const NamedValue> values, std::int32_t cell_q, NamedSettings& settings,
                                     std::vector<std::string>& notes) {
  NamedSettings result = settings;
  std::vector<std::string> new_notes;
  for (const NamedParameter& parameter : namedParameters()) {
    const auto isThis = [&](const NamedValue& value) { return value.parameter == &parameter; };
    const auto found = std::ranges::find_if(values, isThis);
    if (found == values.end()) continue;
    if (std::ranges::count_if(values, isThis) > 1) return NamedError{&parameter, "given twice"};
    if (Status status = parameter.apply(found->value, cell_q, result); !status)
      return NamedError{&parameter, status.error()};
    if (parameter.apply == applySlope && result.parameters.slope_threshold_q == kNeverSteep)
      new_notes.push_back("slopeThreshold: " + numberText(found->value) + " per metre over cells of " +
                          numberText(metresOf(cell_q)) + " m is as good as upright: no slope is ever too steep");
  }
  settings = result;
  notes.insert(notes.end(), new_notes.begin(), new_notes.end());
  return {};
}

Result<Parameters> changeParameters(const ScenePack& pack, const Parameters& from, std::span<const NamedValue> values,
                                    std::vector<std::string>& notes) {
  for (const NamedValue& value : values)
    if (!value.parameter->fixed_because.empty())
      return Error{std::string(value.parameter->name) +
                   ": cannot change in a session: " + std::string(value.parameter->fixed_because)};
  NamedSettings settings = settingsOf(from);
  if (const auto error = applyNamed(values, pack.cell_q, settings, notes))
    return Error{std::string(error->parameter->name) + ": " + error->why};
  if (Status status = validateParameters(pack, settings.parameters); !status) return Error{status.error()};
  return settings.parameters;
}

std::vector<std::string> describeParameters(const Parameters& parameters, std::int32_t cell_q) {
  std::vector<std::string> lines;
  for (const NamedParameter& parameter : namedParameters())
    if (isOfTicks(parameter))
      lines.push_back(std::string(parameter.name) + " " + valueText(parameter, cell_q, settingsOf(parameters)));
  return lines;
}

std::string describeChange(const Parameters& from, const Parameters& to, std::int32_t cell_q) {
  std::string text;
  for (const NamedParameter& parameter : namedParameters()) {
    if (!isOfTicks(parameter)) continue;
    const std::string before = valueText(parameter, cell_q, settingsOf(from));
    const std::string after = valueText(parameter, cell_q, settingsOf(to));
    if (before == after) continue;
    text += (text.empty() ? "" : ", ") + std::string(parameter.name) + " " + before + " -> " + after;
  }
  return text;
}

std::int32_t slopeThreshold(double per_metre, std::int32_t cell_q) {
  using Extended = long double;
  constexpr Extended units = rules::kUnitsPerMetre;
  const Extended angle = Extended(per_metre) * cell_q / units;
  if (angle >= std::numbers::pi_v<Extended> / 2) return kNeverSteep;
  const Extended candidate = std::floor(std::tan(angle) * units);
  if (!(candidate < Extended(kLengthMost))) return kNeverSteep;
  const Extended steepest = angle * (1 + 4 * Extended(std::numeric_limits<double>::epsilon()));
  const auto rests = [&](std::int32_t difference_q) { return std::atan(difference_q / units) <= steepest; };
  auto threshold = std::int32_t(candidate);
  while (threshold > 0 && !rests(threshold)) --threshold;
  while (threshold < kLengthMost && rests(threshold + 1)) ++threshold;
  return threshold;
}

std::int32_t diagonalThreshold(std::int32_t slope_threshold_q) {
  if (slope_threshold_q == kNeverSteep) return kNeverSteep;
  const std::uint32_t diagonal = isqrt(2 * std::uint64_t(slope_threshold_q) * std::uint64_t(slope_threshold_q));
  return diagonal > std::uint32_t(kLengthMost) ? kNeverSteep : std::int32_t(diagonal);
}

}  // namespace spoor
