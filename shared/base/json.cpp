#include "shared/base/json.h"

#include <cmath>
#include <cstdio>

namespace spoor {
namespace {

std::string quoted(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      result += '\\';
      result += c;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      char code[8];
      std::snprintf(code, sizeof code, "\\u%04x", c);
      result += code;
    } else {
      result += c;
    }
  }
  return result + '"';
}

}  // namespace

void JsonWriter::begin(std::string_view key) {
  if (!closers_.empty()) {
    text_ += first_ ? "\n" : ",\n";
    text_.append(closers_.size() * 2, ' ');
    if (!key.empty()) text_ += quoted(key) + ": ";
  }
  first_ = false;
}

void JsonWriter::beginObject(std::string_view key) {
  begin(key);
  text_ += '{';
  closers_ += '}';
  first_ = true;
}

void JsonWriter::beginArray(std::string_view key) {
  begin(key);
  text_ += '[';
  closers_ += ']';
  first_ = true;
}

void JsonWriter::end() {
  const char closer = closers_.back();
  closers_.pop_back();
  if (!first_) {
    text_ += '\n';
    text_.append(closers_.size() * 2, ' ');
  }
  text_ += closer;
  first_ = false;
  if (closers_.empty()) text_ += '\n';
}

void JsonWriter::value(std::string_view key, std::string_view text) {
  begin(key);
  text_ += quoted(text);
}

void JsonWriter::value(std::string_view key, std::int64_t number) {
  begin(key);
  text_ += std::to_string(number);
}

void JsonWriter::value(std::string_view key, double number) {
  begin(key);
  char digits[32];
  std::snprintf(digits, sizeof digits, "%.6g", number);
  text_ += std::isfinite(number) ? digits : "null";
}

void JsonWriter::value(std::string_view key, bool flag) {
  begin(key);
  text_ += flag ? "true" : "false";
}

void JsonWriter::hash(std::string_view key, std::uint64_t value) {
  begin(key);
  text_ += quoted(hexText(value));
}

Status JsonWriter::writeFile(const std::string& path) const {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (file == nullptr) return Error{"cannot write " + path};
  const bool written = std::fwrite(text_.data(), 1, text_.size(), file) == text_.size();
  if (std::fclose(file) != 0 || !written) return Error{"cannot write all of " + path};
  return {};
}

std::string hexText(std::uint64_t value) {
  char digits[20];
  std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(value));
  return digits;
}

}  // namespace spoor
