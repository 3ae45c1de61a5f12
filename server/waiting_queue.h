#pragma once

#include <cstddef>
#include <mutex>
#include <utility>
#include <vector>

namespace spoor {

/// Things on their way from a thread that makes them to the tick loop, which never waits for it.
template <typename T>
class WaitingQueue {
 public:
  static constexpr std::size_t kLimit = 1024;

  /// False: there are kLimit already.
  [[nodiscard]] bool push(T thing) {
    const std::lock_guard lock(mutex_);
    if (things_.size() >= kLimit) return false;
    things_.push_back(std::move(thing));
    return true;
  }
  /// Takes what has come, or nothing where push() is at work this very moment: then it comes with the next tick.
  std::vector<T> tryTake() {
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock.owns_lock()) return {};
    return std::exchange(things_, {});
  }

 private:
  std::mutex mutex_;
  std::vector<T> things_;
};

}  // namespace spoor
