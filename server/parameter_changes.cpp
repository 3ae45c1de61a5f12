#include "server/parameter_changes.h"

#include <charconv>
#include <utility>

namespace spoor {

Result<std::vector<NamedValue>> parseAssignments(std::string_view text) {
  std::vector<NamedValue> values;
  for (;;) {
    const auto comma = text.find(',');
    const auto value = parseNamed(text.substr(0, comma));
    if (!value) return Error{value.error()};
    const NamedParameter& parameter = *value->parameter;
    if (!parameter.fixed_because.empty())
      return Error{std::string(parameter.name) +
                   ": cannot change in a session: " + std::string(parameter.fixed_because)};
    for (const NamedValue& other : values)
      if (other.parameter == &parameter && other.material == value->material)
        return Error{nameOf(*value) + ": given twice"};
    values.push_back(*value);
    if (comma == std::string_view::npos) return values;
    text.remove_prefix(comma + 1);
  }
}

Result<ParameterChange> parseChange(std::string_view text) {
  ParameterChange change;
  const auto end = std::from_chars(text.data(), text.data() + text.size(), change.tick);
  if (end.ec != std::errc{} || end.ptr == text.data() + text.size() || *end.ptr != ':' || change.tick < 1)
    return Error{"does not begin with a tick, 1 or later, and a colon"};
  auto values = parseAssignments(text.substr(std::size_t(end.ptr + 1 - text.data())));
  if (!values) return Error{values.error()};
  change.values = std::move(*values);
  return change;
}

}  // namespace spoor
