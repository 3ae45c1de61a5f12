#include "shared/base/thread_pool.h"

namespace spoor {
namespace {

constexpr int kSpins = 2000;  // a few microseconds: the pause between two stages of a tick

template <typename T>
T waitForChange(const std::atomic<T>& value, T old) {
  for (int i = 0; i < kSpins; ++i) {
    if (const T now = value.load(std::memory_order_acquire); now != old) return now;
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
  }
  value.wait(old, std::memory_order_acquire);
  return value.load(std::memory_order_acquire);
}

}  // namespace

ThreadPool::ThreadPool(int thread_count) {
  for (int i = 1; i < thread_count; ++i) threads_.emplace_back([this, i] { serve(i); });
}

ThreadPool::~ThreadPool() {
  stop_ = true;
  generation_.fetch_add(1, std::memory_order_release);
  generation_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void ThreadPool::run(int count, void* context) {
  context_ = context;
  count_ = count;
  next_index_.store(0, std::memory_order_relaxed);
  working_.store(int(threads_.size()), std::memory_order_relaxed);
  generation_.fetch_add(1, std::memory_order_release);
  generation_.notify_all();
  work(0);
  for (int left = working_.load(std::memory_order_acquire); left > 0;) left = waitForChange(working_, left);
}

void ThreadPool::serve(int thread) {
  std::uint32_t seen = 0;
  for (;;) {
    seen = waitForChange(generation_, seen);
    if (stop_) return;
    work(thread);
    if (working_.fetch_sub(1, std::memory_order_acq_rel) == 1) working_.notify_one();
  }
}

void ThreadPool::work(int thread) {
  for (;;) {
    const int index = next_index_.fetch_add(1, std::memory_order_relaxed);
    if (index >= count_) return;
    call_(context_, index, thread);
  }
}

}  // namespace spoor
