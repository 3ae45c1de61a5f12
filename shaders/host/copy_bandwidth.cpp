#include "shaders/host/copy_bandwidth.h"

#include <array>
#include <chrono>
#include <cstdint>
#include <thread>
#include <vector>

#include "shaders/host/gl_buffer.h"
#include "shaders/host/gl_context.h"
#include "shared/base/statistics.h"

namespace spoor {
namespace {

// Larger than any cache that it could stay in.
constexpr std::int64_t kHardwareBytes = std::int64_t(256) << 20;
constexpr std::int64_t kSoftwareBytes = std::int64_t(64) << 20;
constexpr int kRoundCount = 9;
constexpr double kLeastRound_s = 0.05;  // next to which starting and waiting do not count
constexpr int kCopiesLimit = 4096;      // of a round

Result<double> copySeconds(const std::array<GlBuffer, 2>& buffers, std::int64_t bytes, int copy_count) {
  GlFence done;
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < copy_count; ++i)
    glCopyNamedBufferSubData(buffers[std::size_t(i & 1)].name(), buffers[std::size_t(1 - (i & 1))].name(), 0, 0, bytes);
  done.place();
  if (Status status = done.wait("copies"); !status) return Error{status.error()};
  const double taken_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (Status status = glStatus("copying a buffer"); !status) return Error{status.error()};
  return taken_s;
}

Result<double> measure(const std::string& device) {
  const auto context = openHeadlessContext(device);
  if (!context) return Error{context.error()};
  const std::int64_t bytes = (*context)->software() ? kSoftwareBytes : kHardwareBytes;
  const std::array<GlBuffer, 2> buffers{makeBuffer(), makeBuffer()};
  for (const GlBuffer& buffer : buffers) {
    glNamedBufferStorage(buffer.name(), bytes, nullptr, 0);
    // Memory that was never written may be no memory yet.
    glClearNamedBufferData(buffer.name(), GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
  }
  if (Status status = glStatus("making two buffers of " + std::to_string(bytes) + " bytes"); !status)
    return Error{status.error()};
  int copy_count = 1;
  for (;;) {  // the first rounds are warm-up, too
    const auto taken_s = copySeconds(buffers, bytes, copy_count);
    if (!taken_s) return Error{taken_s.error()};
    if (*taken_s >= kLeastRound_s || copy_count >= kCopiesLimit) break;
    copy_count *= 2;
  }
  std::vector<double> rates;
  for (int round = 0; round < kRoundCount; ++round) {
    const auto taken_s = copySeconds(buffers, bytes, copy_count);
    if (!taken_s) return Error{taken_s.error()};
    rates.push_back(2 * double(bytes) * copy_count / *taken_s / 1e9);
  }
  return percentile(rates, 0.5);
}

}  // namespace

Result<double> measureCopyBandwidth(const std::string& device) {
  // A context is current on the thread that opens it; on a thread of its own, what is current here stays so.
  Result<double> result = Error{};
  std::thread([&] { result = measure(device); }).join();
  return result;
}

}  // namespace spoor
