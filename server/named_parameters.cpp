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
constexpr std::string_view kReposeName = "angleOfRepose";

double metresOf(std::int32_t units) { return double(units) / rules::kUnitsPerMetre; }

/// The fewest decimals that give the same number again. again(value): what is read back after writing one, if anything.
template <typename Again>
std::string shortestText(double about, Again again) {
  char text[400] = "";
  for (int places = 0; places <= 17; ++places) {
    std::snprintf(text, sizeof text, "%.*f", places, about);
    const std::optional<double> back = again(std::strtod(text, nullptr));
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
  return shortestText(*value, [&](double written) -> std::optional<double> {
    NamedSettings again = settings;
    if (!parameter.apply(written, cell_q, again)) return {};
    return parameter.read(again, cell_q);
  });
}

std::string materialText(const NamedParameter& parameter, std::int32_t cell_q, const MaterialRules& rules) {
  const bool is_slope = parameter.name == kSlopeName;
  if (is_slope && rules.slope_threshold_q == kNeverSteep) return "(no slope is too steep)";
  std::string text = shortestText(parameter.read_of(rules, cell_q), [&](double written) -> std::optional<double> {
    MaterialRules again = rules;
    parameter.apply_to(written, cell_q, again);
    return parameter.read_of(again, cell_q);
  });
  if (!is_slope) return text;
  char degrees[32];
  std::snprintf(degrees, sizeof degrees, "%.3g", double(rules.repose_q16) * 90 / kOneQ16);
  text += " (" + plainNumber(metresOf(rules.slope_threshold_q)) + " m rest, " + degrees + " degrees";
  if (rules.diagonal_threshold_q != diagonalThreshold(rules.slope_threshold_q))
    text += ", diagonally " + plainNumber(metresOf(rules.diagonal_threshold_q)) + " m";
  return text + ")";
}

/// A parameter's values: one, or of each material.
std::vector<std::string> valueTexts(const NamedParameter& parameter, const ScenePack& pack,
                                    const Parameters& parameters) {
  if (!parameter.isOfMaterial()) {
    NamedSettings settings;
    settings.parameters = parameters;
    return {valueText(parameter, pack.cell_q, settings)};
  }
  std::vector<std::string> texts;
  for (const MaterialRules& rules : parameters.materials) texts.push_back(materialText(parameter, pack.cell_q, rules));
  return texts;
}

bool allEqual(const std::vector<std::string>& texts) {
  return std::ranges::all_of(texts, [&](const std::string& text) { return text == texts.front(); });
}

std::string nameOf(const ScenePack& pack, std::size_t material, std::string_view name) {
  return pack.materials[material].name + "." + std::string(name);
}

/// May a running session change it?
bool isOfTicks(const NamedParameter& parameter) { return parameter.fixed_because.empty() && !parameter.isShortName(); }

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

/// Reports what a value makes of the settings, where that is not what one may think.
void noteValue(const NamedValue& value, std::int32_t cell_q, const MaterialRules& rules,
               std::vector<std::string>& notes) {
  const std::string over = plainNumber(value.value) + (value.parameter->name == kSlopeName ? " per metre" : " degrees");
  if (value.parameter->name == kSlopeName && rules.slope_threshold_q == kNeverSteep)
    notes.push_back(nameOf(value) + ": " + over + " over cells of " + plainNumber(metresOf(cell_q)) +
                    " m is as good as upright: no slope is ever too steep");
  MaterialRules again;
  if (value.parameter->name == kReposeName && setRepose(value.value, cell_q, again))
    notes.push_back(nameOf(value) + ": " + over +
                    " are less than 0.1 mm per cell: slope threshold rounded up to 0.1 mm");
}

/// Writes one value to the settings; the error says why not.
Status applyOne(const NamedValue& value, std::int32_t cell_q, NamedSettings& settings,
                std::vector<std::string>& notes) {
  const NamedParameter& parameter = *value.parameter;
  if (!parameter.isOfMaterial()) return parameter.apply(value.value, cell_q, settings);
  const auto found = std::ranges::find(settings.materials, value.material);
  if (!value.material.empty() && found == settings.materials.end()) {
    std::string names;
    for (const std::string& name : settings.materials) names += (names.empty() ? "" : ", ") + name;
    return Error{"no material is named " + quoted(value.material) + "; there are: " + names};
  }
  std::vector<MaterialRules>& all = settings.parameters.materials;
  const std::size_t one = std::size_t(found - settings.materials.begin());
  for (std::size_t i = 0; i < all.size(); ++i)
    if (value.material.empty() || i == one) parameter.apply_to(value.value, cell_q, all[i]);
  noteValue(value, cell_q, all[value.material.empty() ? 0 : one], notes);
  return {};
}

/// Why two values of one list do not go together; empty: they do.
std::string_view clashOf(const NamedValue& value, const NamedValue& other) {
  if (value.material != other.material) return {};
  if (value.parameter == other.parameter) return "given twice";
  if (value.parameter->name == kReposeName && other.parameter->name == kSlopeName)
    return "slopeThreshold is given too and says the same; give one of the two";
  return {};
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

bool isMaterialName(std::string_view name) {
  constexpr std::size_t limit = 64;  // validateMaterials
  const auto fits = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  };
  return !name.empty() && name.size() <= limit && std::ranges::all_of(name, fits);
}

std::string nameOf(const NamedValue& value) {
  return (value.material.empty() ? "" : value.material + ".") + std::string(value.parameter->name);
}

Result<NamedValue> parseNamed(std::string_view assignment) {
  const auto equals = assignment.find('=');
  if (equals == std::string_view::npos) return Error{quoted(trimmed(assignment)) + " is not NAME=VALUE"};
  const std::string_view whole_name = trimmed(assignment.substr(0, equals));
  const auto dot = whole_name.rfind('.');
  const bool of_one = dot != std::string_view::npos;
  const std::string_view name = of_one ? whole_name.substr(dot + 1) : whole_name;
  std::string_view value = trimmed(assignment.substr(equals + 1));
  const NamedParameter* parameter = findNamed(name);
  if (parameter == nullptr) return Error{quoted(whole_name) + " is no parameter (scenes/README.md, [thesis])"};
  if (of_one && !isMaterialName(whole_name.substr(0, dot))) return Error{quoted(whole_name) + " names no material"};
  if (of_one && !parameter->isOfMaterial()) return Error{quoted(whole_name) + " is no parameter of a material"};
  if (value.size() >= 2 && value.front() == '"' && value.back() == '"') value = value.substr(1, value.size() - 2);
  const auto parsed = parseValue(*parameter, value);
  if (!parsed) {
    const char* kind = parameter->kind == NamedKind::number    ? "a number within "
                       : parameter->kind == NamedKind::integer ? "a whole number within "
                                                               : "one of ";
    return Error{std::string(name) + ": " + quoted(value) + " is not " + kind + rangeText(*parameter)};
  }
  return NamedValue{parameter, *parsed, std::string(of_one ? whole_name.substr(0, dot) : "")};
}

std::optional<NamedError> applyNamed(std::span<const NamedValue> values, std::int32_t cell_q, NamedSettings& settings,
                                     std::vector<std::string>& notes) {
  NamedSettings result = settings;
  std::vector<std::string> new_notes;
  for (const bool of_one : {false, true})
    for (const NamedParameter& parameter : namedParameters())
      for (const NamedValue& value : values) {
        if (value.parameter != &parameter || value.material.empty() == of_one) continue;
        for (const NamedValue& other : values)
          if (const auto why = &other == &value ? "" : clashOf(value, other); !why.empty())
            return NamedError{&parameter, nameOf(value), std::string(why)};
        if (Status status = applyOne(value, cell_q, result, new_notes); !status)
          return NamedError{&parameter, nameOf(value), status.error()};
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
  NamedSettings settings;
  settings.parameters = from;
  settings.materials.clear();
  for (const Material& material : pack.materials) settings.materials.push_back(material.name);
  if (const auto error = applyNamed(values, pack.cell_q, settings, notes))
    return Error{error->name + ": " + error->why};
  if (Status status = validateParameters(pack, settings.parameters); !status) return Error{status.error()};
  return settings.parameters;
}

std::vector<std::string> describeParameters(const ScenePack& pack, const Parameters& parameters) {
  std::vector<std::string> lines;
  for (const NamedParameter& parameter : namedParameters()) {
    if (!isOfTicks(parameter)) continue;
    const auto texts = valueTexts(parameter, pack, parameters);
    const bool one_line = allEqual(texts);
    for (std::size_t i = 0; i < (one_line ? 1 : texts.size()); ++i)
      lines.push_back((one_line ? std::string(parameter.name) : nameOf(pack, i, parameter.name)) + " " + texts[i]);
  }
  return lines;
}

std::string describeChange(const ScenePack& pack, const Parameters& from, const Parameters& to) {
  std::string text;
  for (const NamedParameter& parameter : namedParameters()) {
    if (!isOfTicks(parameter)) continue;
    const auto before = valueTexts(parameter, pack, from), after = valueTexts(parameter, pack, to);
    const bool one_line = allEqual(before) && allEqual(after);
    for (std::size_t i = 0; i < (one_line ? 1 : after.size()); ++i) {
      if (before[i] == after[i]) continue;
      text += (text.empty() ? "" : ", ") + (one_line ? std::string(parameter.name) : nameOf(pack, i, parameter.name)) +
              " " + before[i] + " -> " + after[i];
    }
  }
  return text;
}

}  // namespace spoor
