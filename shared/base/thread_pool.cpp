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
  unfinished_.store(count, std::memory_order_relaxed);
  const std::uint32_t generation = generation_.load(std::memory_order_relaxed) + 1;
  ticket_.store(std::uint64_t(generation) << 32 | std::uint32_t(count), std::memory_order_release);
  generation_.store(generation, std::memory_order_release);
  generation_.notify_all();
  work(0);
  for (int left = unfinished_.load(std::memory_order_acquire); left > 0;) left = waitForChange(unfinished_, left);
}

void ThreadPool::serve(int thread) {
  std::uint32_t seen = 0;
  for (;;) {
    seen = waitForChange(generation_, seen);
    if (stop_) return;
    work(thread);
  }
}

void ThreadPool::work(int thread) {
  std::uint64_t ticket = ticket_.load(std::memory_order_acquire);
  while (std::uint32_t(ticket) > 0) {
    if (!ticket_.compare_exchange_weak(ticket, ticket - 1, std::memory_order_acq_rel, std::memory_order_acquire))
      continue;
    call_(context_, count_ - int(std::uint32_t(ticket)), thread);
    if (unfinished_.fetch_sub(1, std::memory_order_acq_rel) == 1) unfinished_.notify_one();
    ticket = ticket_.load(std::memory_order_acquire);
  }
}

}  // namespace spoor
