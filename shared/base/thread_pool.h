#pragma once

#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>

namespace spoor {

/// A fixed set of threads for short parallel loops. Which thread runs which index is left to chance: what a loop
/// computes must not depend on it.
class ThreadPool {
 public:
  /// `thread_count` >= 1 includes the caller.
  explicit ThreadPool(int thread_count);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  int threadCount() const { return int(threads_.size()) + 1; }

  /// Calls body(index, thread) for index 0 .. count - 1, thread 0 .. threadCount() - 1; returns when all are done.
  template <typename Body>
  void forEach(int count, Body&& body) {
    if (count <= 0) return;
    if (count == 1 || threads_.empty()) {
      for (int i = 0; i < count; ++i) body(i, 0);
      return;
    }
    call_ = [](void* context, int index, int thread) {
      (*static_cast<std::remove_reference_t<Body>*>(context))(index, thread);
    };
    run(count, &body);
  }

 private:
  void run(int count, void* context);
  void serve(int thread);
  void work(int thread);

  // A loop ends when its indices are done, not when every thread has noticed it: on a busy machine a thread may sleep
  // through a loop and nobody waits for it. It reads the loop's fields only after it has claimed an index, which keeps
  // the loop alive until that index is done.
  std::vector<std::thread> threads_;
  void (*call_)(void*, int, int) = nullptr;
  void* context_ = nullptr;
  int count_ = 0;
  std::atomic<std::uint64_t> ticket_{0};      // high half: number of the loop; low half: indices not yet claimed
  std::atomic<int> unfinished_{0};            // indices of this loop not yet done
  std::atomic<std::uint32_t> generation_{0};  // one up for each loop
  std::atomic<bool> stop_{false};
};

}  // namespace spoor
