#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace spoor {

static_assert(std::endian::native == std::endian::little, "files, wire and hashes are little-endian byte for byte");

/// Appends little-endian values: the canonical bytes of packs, sessions, deltas and hashes.
class ByteWriter {
 public:
  template <std::integral T>
  void put(T value) {
    const auto at = bytes.size();
    bytes.resize(at + sizeof(T));
    std::memcpy(bytes.data() + at, &value, sizeof(T));
  }
  void putBytes(std::span<const std::uint8_t> data) { bytes.insert(bytes.end(), data.begin(), data.end()); }
  template <std::integral T>
  void putAll(std::span<const T> values) {
    putBytes({reinterpret_cast<const std::uint8_t*>(values.data()), values.size_bytes()});
  }
  /// Length in 32 bits, then the text.
  void putText(std::string_view text) {
    put(std::uint32_t(text.size()));
    putBytes({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  }

  std::vector<std::uint8_t> bytes;
};

/// Reads what ByteWriter wrote. Safe on untrusted bytes: a read past the end yields zero and sets failed(), and counts
/// are compared with what is left before anything is allocated.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::uint8_t> data) : data_(data) {}

  template <std::integral T>
  T get() {
    T value{};
    if (data_.size() < sizeof(T)) return fail(), value;
    std::memcpy(&value, data_.data(), sizeof(T));
    data_ = data_.subspan(sizeof(T));
    return value;
  }
  std::span<const std::uint8_t> getBytes(std::size_t count) {
    if (data_.size() < count) return fail(), std::span<const std::uint8_t>{};
    const auto result = data_.first(count);
    data_ = data_.subspan(count);
    return result;
  }
  template <std::integral T>
  std::vector<T> getAll(std::size_t count) {
    if (count > data_.size() / sizeof(T)) return fail(), std::vector<T>{};
    std::vector<T> values(count);
    if (count > 0) std::memcpy(values.data(), getBytes(count * sizeof(T)).data(), count * sizeof(T));
    return values;
  }
  std::string getText() {
    const auto text = getBytes(get<std::uint32_t>());
    return {reinterpret_cast<const char*>(text.data()), text.size()};
  }

  /// True once a read went past the end.
  bool failed() const { return failed_; }
  /// Bytes not yet read; trailing bytes are for the caller to reject.
  std::size_t left() const { return data_.size(); }

 private:
  void fail() {
    failed_ = true;
    data_ = {};
  }

  std::span<const std::uint8_t> data_;
  bool failed_ = false;
};

}  // namespace spoor
