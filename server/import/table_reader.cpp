#include "server/import/table_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "server/import/units.h"

namespace spoor {
namespace {

const toml::table kEmptyTable;

std::string typeName(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table:
      return "a table";
    case toml::node_type::array:
      return "an array";
    case toml::node_type::string:
      return "a text";
    case toml::node_type::integer:
      return "an integer";
    case toml::node_type::floating_point:
      return "a number";
    case toml::node_type::boolean:
      return "true or false";
    default:
      return "a date or time";
  }
}

std::string rangeText(const Range& range) {
  return fmt::format("{} .. {}{}{}", plainNumber(range.lowest), plainNumber(range.highest),
                     range.unit.empty() ? "" : " ", range.unit);
}

}  // namespace

void SceneErrors::add(std::uint32_t line, const std::string& what) {
  if (failed()) return;
  message_ = line > 0 ? fmt::format("{}:{}: {}", file_, line, what) : fmt::format("{}: {}", file_, what);
}

TableReader::TableReader(const toml::table& table, std::string where, SceneErrors& errors)
    : table_(table), where_(std::move(where)), errors_(errors) {}

double TableReader::number(std::string_view key, const Range& range, std::optional<double> otherwise) {
  const toml::node* node = find(key);
  if (!node && !otherwise) missing(key);
  if (!node) return otherwise.value_or(0);
  return numberOf(*node, key, range).value_or(otherwise.value_or(0));
}

std::int64_t TableReader::integer(std::string_view key, const Range& range, std::optional<std::int64_t> otherwise) {
  const toml::node* node = find(key);
  if (!node && !otherwise) missing(key);
  if (!node) return otherwise.value_or(0);
  if (!node->is_integer()) {
    wrong(key, fmt::format("must be an integer within {}, not {}", rangeText(range), typeName(*node)));
    return otherwise.value_or(0);
  }
  const std::int64_t value = node->as_integer()->get();
  if (double(value) >= range.lowest && double(value) <= range.highest) return value;
  wrong(key, fmt::format("{} is not within {}", value, rangeText(range)));
  return otherwise.value_or(0);
}

Span TableReader::span(std::string_view key, const Range& range, std::optional<double> otherwise) {
  const Span pair = pairOf(key, range, otherwise, "[least, most]");
  if (pair.least > pair.most)
    wrong(key, fmt::format("{} is more than {}", plainNumber(pair.least), plainNumber(pair.most)));
  return pair;
}

Span TableReader::sequence(std::string_view key, const Range& range, std::optional<double> otherwise) {
  return pairOf(key, range, otherwise, "[first, last]");
}

Span TableReader::pairOf(std::string_view key, const Range& range, std::optional<double> otherwise, const char* what) {
  const toml::node* node = find(key);
  if (!node || !node->is_array()) {
    const double value = number(key, range, otherwise);
    return {value, value};
  }
  const toml::array& pair = *node->as_array();
  if (pair.size() != 2) {
    wrong(key, fmt::format("must be a number or {}", what));
    return {};
  }
  const auto first = numberOf(pair[0], key, range), second = numberOf(pair[1], key, range);
  if (!first || !second) return {};
  return {*first, *second};
}

bool TableReader::flag(std::string_view key, bool otherwise) {
  const toml::node* node = find(key);
  if (!node) return otherwise;
  if (node->is_boolean()) return node->as_boolean()->get();
  wrong(key, "must be true or false, not " + typeName(*node));
  return otherwise;
}

std::string TableReader::text(std::string_view key, std::optional<std::string> otherwise) {
  const toml::node* node = find(key);
  if (!node && !otherwise) missing(key);
  if (!node) return otherwise.value_or("");
  if (node->is_string()) return node->as_string()->get();
  wrong(key, "must be a text in quotes, not " + typeName(*node));
  return otherwise.value_or("");
}

std::string TableReader::choice(std::string_view key, const std::vector<std::string>& choices,
                                std::optional<std::string> otherwise) {
  const std::string value = text(key, otherwise);
  const bool known = std::find(choices.begin(), choices.end(), value) != choices.end();
  if (!known && value != otherwise.value_or(""))
    wrong(key, fmt::format("'{}' is none of: {}", value, fmt::join(choices, ", ")));
  return known ? value : otherwise.value_or("");
}

std::vector<double> TableReader::numbers(std::string_view key, std::size_t count, const Range& range) {
  std::vector<double> values(count, 0.0);
  const toml::node* node = find(key);
  if (!node) return values;
  const toml::array* array = node->as_array();
  if (!array || array->size() != count) {
    wrong(key, fmt::format("must be an array of {} numbers", count));
    return values;
  }
  for (std::size_t i = 0; i < count; ++i) values[i] = numberOf((*array)[i], key, range).value_or(0);
  return values;
}

std::vector<PointM> TableReader::points(std::string_view key, const Range& range) {
  const toml::node* node = find(key);
  const toml::array* array = node ? node->as_array() : nullptr;
  if (!array || array->empty() || array->size() > kSmoothPointLimit) {
    if (node)
      wrong(key, fmt::format("must be an array of 1 .. {} points [x, y]", kSmoothPointLimit));
    else
      missing(key);
    return {};
  }
  std::vector<PointM> points;
  for (std::size_t i = 0; i < array->size(); ++i) {
    const toml::array* pair = (*array)[i].as_array();
    if (!pair || pair->size() != 2) {
      wrong(key, fmt::format("point {} must be [x, y]", i + 1));
      return {};
    }
    points.push_back({numberOf((*pair)[0], key, range).value_or(0), numberOf((*pair)[1], key, range).value_or(0)});
  }
  return points;
}

TableReader TableReader::table(std::string_view key) {
  const toml::node* node = find(key);
  if (node && !node->is_table())
    wrong(key, fmt::format("must be a table, [{}], not {}", keyPath(key), typeName(*node)));
  return {node && node->is_table() ? *node->as_table() : kEmptyTable, keyPath(key), errors_};
}

std::vector<TableReader> TableReader::tables(std::string_view key) {
  std::vector<TableReader> result;
  const toml::node* node = find(key);
  if (!node) return result;
  const toml::array* array = node->as_array();
  if (!array || !array->is_homogeneous(toml::node_type::table)) {
    wrong(key, fmt::format("must be a list of tables, [[{}]]", keyPath(key)));
    return result;
  }
  for (std::size_t i = 0; i < array->size(); ++i) {
    result.emplace_back(*(*array)[i].as_table(), fmt::format("{}[{}]", keyPath(key), i), errors_);
  }
  return result;
}

std::vector<std::string> TableReader::keys() const {
  std::vector<std::string> result;
  for (const auto& [key, node] : table_) result.emplace_back(key.str());
  return result;
}

void TableReader::wrong(std::string_view key, const std::string& why) {
  const toml::node* node = table_.get(key);
  const std::uint32_t line = std::uint32_t(node ? node->source().begin.line : table_.source().begin.line);
  errors_.add(line, fmt::format("{}: {}", keyPath(key), why));
}

void TableReader::finish() {
  for (const auto& [key, node] : table_) {
    if (read_.count(key.str()) > 0) continue;
    errors_.add(std::uint32_t(key.source().begin.line), keyPath(key.str()) + ": unknown key");
  }
}

const toml::node* TableReader::find(std::string_view key) {
  read_.emplace(key);
  return table_.get(key);
}

std::optional<double> TableReader::numberOf(const toml::node& node, std::string_view key, const Range& range) {
  if (!node.is_number()) {
    wrong(key, fmt::format("must be a number within {}, not {}", rangeText(range), typeName(node)));
    return {};
  }
  const double value = node.is_integer() ? double(node.as_integer()->get()) : node.as_floating_point()->get();
  if (value >= range.lowest && value <= range.highest) return value;
  wrong(key, fmt::format("{} is not within {}", plainNumber(value), rangeText(range)));
  return {};
}

std::string TableReader::keyPath(std::string_view key) const {
  return where_.empty() ? std::string(key) : fmt::format("{}.{}", where_, key);
}

void TableReader::missing(std::string_view key) { wrong(key, "missing"); }

}  // namespace spoor
