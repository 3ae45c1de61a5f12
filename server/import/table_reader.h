#pragma once

#include <toml++/toml.h>

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "server/import/path_maker.h"

namespace spoor {

/// The first thing found wrong in a scene file. Later ones are dropped: they often follow from it.
class SceneErrors {
 public:
  explicit SceneErrors(std::string file) : file_(std::move(file)) {}

  /// @param line  from 1; 0: unknown
  void add(std::uint32_t line, const std::string& what);
  bool failed() const { return !message_.empty(); }
  const std::string& message() const { return message_; }

 private:
  std::string file_, message_;
};

/// What a number may be, for the message: "0.5 .. 20 m".
struct Range {
  double lowest, highest;
  std::string_view unit;
};

/// What a value may be drawn from, or what it goes through; one number: both are the same.
struct Span {
  double least = 0, most = 0;
};

/// Reads one table of a scene file key by key. Whatever is wrong goes to the SceneErrors, with file, line and key, and
/// the default (or zero) is returned: check failed() after a table. A key that nobody read is an error of finish().
class TableReader {
 public:
  /// @param where  how messages name the table, "world" or "mesh[2]"; empty for the file itself
  TableReader(const toml::table& table, std::string where, SceneErrors& errors);

  bool has(std::string_view key) const { return table_.contains(key); }
  /// Without a default, a missing key is an error.
  double number(std::string_view key, const Range& range, std::optional<double> otherwise = {});
  std::int64_t integer(std::string_view key, const Range& range, std::optional<std::int64_t> otherwise = {});
  /// A number, or [least, most]. Without a default, a missing key is an error.
  Span span(std::string_view key, const Range& range, std::optional<double> otherwise = {});
  /// A number, or [first, last] in any order.
  Span sequence(std::string_view key, const Range& range, std::optional<double> otherwise = {});
  bool flag(std::string_view key, bool otherwise);
  std::string text(std::string_view key, std::optional<std::string> otherwise = {});
  /// A text that must be one of `choices`.
  std::string choice(std::string_view key, const std::vector<std::string>& choices,
                     std::optional<std::string> otherwise = {});
  /// An array of exactly `count` numbers; all zero where the key is missing.
  std::vector<double> numbers(std::string_view key, std::size_t count, const Range& range);
  /// An array of 1 .. kSmoothPointLimit pairs.
  std::vector<PointM> points(std::string_view key, const Range& range);
  /// The table under a key; an empty one where it is missing.
  TableReader table(std::string_view key);
  /// The tables under a key, [[key]]; none where it is missing.
  std::vector<TableReader> tables(std::string_view key);

  /// All keys, in the order of their letters.
  std::vector<std::string> keys() const;

  /// Reports a wrong value of a key.
  void wrong(std::string_view key, const std::string& why);
  /// Reports the first key that was not read.
  void finish();

  const std::string& where() const { return where_; }
  /// "world.cell_m"
  std::string keyPath(std::string_view key) const;

 private:
  const toml::node* find(std::string_view key);
  std::optional<double> numberOf(const toml::node& node, std::string_view key, const Range& range);
  Span pairOf(std::string_view key, const Range& range, std::optional<double> otherwise, const char* what);
  void missing(std::string_view key);

  const toml::table& table_;
  std::string where_;
  SceneErrors& errors_;
  std::set<std::string, std::less<>> read_;
};

}  // namespace spoor
