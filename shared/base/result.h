#pragma once

#include <optional>
#include <string>
#include <utility>

namespace spoor {

/// What a check of outside bytes (file, wire, command line) found wrong: which thing, what, and why, in one line.
struct Error {
  std::string message;
};

/// A value, or the error that kept it from being made. For outside bytes only; a caller's mistake asserts instead.
template <typename T>
class [[nodiscard]] Result {
 public:
  Result(T value) : value_(std::move(value)) {}
  Result(Error error) : message_(std::move(error.message)) {}

  explicit operator bool() const { return value_.has_value(); }
  T& operator*() { return *value_; }
  const T& operator*() const { return *value_; }
  T* operator->() { return &*value_; }
  const T* operator->() const { return &*value_; }
  /// The message; only where there is no value.
  const std::string& error() const { return message_; }

 private:
  std::optional<T> value_;
  std::string message_;
};

/// Success, or the error: a Result without a value.
class [[nodiscard]] Status {
 public:
  Status() = default;
  Status(Error error) : message_(std::move(error.message)) {}

  explicit operator bool() const { return !message_.has_value(); }
  const std::string& error() const { return *message_; }

 private:
  std::optional<std::string> message_;
};

}  // namespace spoor
