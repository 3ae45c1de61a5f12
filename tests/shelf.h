#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace spoor::test {

/// Things that are costly to make and can be used again, by name. Any thread.
/// Meant to live as long as the process, and never to be destroyed: the driver's own exit handlers may run first.
template <typename T>
class Shelf {
 public:
  /// nullptr where none is left.
  std::unique_ptr<T> take(const std::string& name) {
    const std::lock_guard lock(mutex_);
    auto& stack = things_[name];
    if (stack.empty()) return nullptr;
    std::unique_ptr<T> thing = std::move(stack.back());
    stack.pop_back();
    return thing;
  }
  void putBack(const std::string& name, std::unique_ptr<T> thing) {
    const std::lock_guard lock(mutex_);
    things_[name].push_back(std::move(thing));
  }

 private:
  std::mutex mutex_;
  std::map<std::string, std::vector<std::unique_ptr<T>>> things_;
};

}  // namespace spoor::test
