#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "shared/base/result.h"

namespace spoor {

/// Writes one JSON document, indented, in the order of the calls. Commas and quoting are its job; nesting the caller's.
class JsonWriter {
 public:
  void beginObject(std::string_view key = {});
  void beginArray(std::string_view key = {});
  void end();
  void value(std::string_view key, std::string_view text);
  void value(std::string_view key, const char* text) { value(key, std::string_view(text)); }
  void value(std::string_view key, std::int64_t number);
  void value(std::string_view key, double number);
  void value(std::string_view key, bool flag);
  /// A 64-bit hash as 16 hexadecimal digits in quotes: JSON numbers keep only 53 bits.
  void hash(std::string_view key, std::uint64_t value);

  const std::string& text() const { return text_; }
  [[nodiscard]] Status writeFile(const std::string& path) const;

 private:
  void begin(std::string_view key);
  std::string text_;
  std::string closers_;
  bool first_ = true;
};

/// 16 hexadecimal digits.
std::string hexText(std::uint64_t value);

}  // namespace spoor
