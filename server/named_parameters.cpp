#include "server/named_parameters.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "server/plain_number.h"
#include "shaders/rules/limits.h"

namespace spoor {
namespace {

constexpr std::string_view kSlopeName = "slopeThreshold";

double metresOf(std::int32_t units) { return double(units) / rules::kUnitsPerMetre; }

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
  const bool is_slope = parameter.name == kSlopeName;
  if (is_slope && p.materials[0].slope_threshold_q == kNeverSteep) return "(no slope is too steep)";
  std::string text = shortestText(parameter, *value, cell_q, settings);
  if (!is_slope) return text;
  text += " (" + plainNumber(metresOf(p.materials[0].slope_threshold_q)) + " m rest";
  if (p.materials[0].diagonal_threshold_q != diagonalThreshold(p.materials[0].slope_threshold_q))
    text += ", diagonally " + plainNumber(metresOf(p.materials[0].diagonal_threshold_q)) + " m";
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
  return plainNumber(parameter.lowest) + " .. " + plainNumber(parameter.highest) + (parameter.unit.empty() ? "" : " ") +
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
    if (parameter.name == kSlopeName && result.parameters.materials[0].slope_threshold_q == kNeverSteep)
      new_notes.push_back("slopeThreshold: " + plainNumber(found->value) + " per metre over cells of " +
                          plainNumber(metresOf(cell_q)) + " m is as good as upright: no slope is ever too steep");
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

}  // namespace spoor
