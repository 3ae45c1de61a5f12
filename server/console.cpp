#include "server/console.h"

#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <stdexcept>

namespace spoor {

Console::Console(int input, ChangeQueue& queue, CraterQueue& craters, SnowfallQueue& snowfalls,
                 std::function<void(const std::string&)> say)
    : input_(input), queue_(queue), craters_(craters), snowfalls_(snowfalls), say_(std::move(say)) {
  if (::pipe(stop_) != 0) throw std::runtime_error("the console cannot open a pipe");
  thread_ = std::thread([this] { serve(); });
}

Console::~Console() {
  const char byte = 0;
  while (::write(stop_[1], &byte, 1) < 0 && errno == EINTR) {
  }
  thread_.join();
  ::close(stop_[0]);
  ::close(stop_[1]);
}

void Console::serve() {
  std::string line;
  bool too_long = false;
  for (;;) {
    pollfd ready[2] = {{input_, POLLIN, 0}, {stop_[0], POLLIN, 0}};
    if (::poll(ready, 2, -1) < 0) {
      if (errno == EINTR) continue;
      return say_("console: cannot be read any more");
    }
    if (ready[1].revents != 0) return;
    char bytes[1024];
    const auto count = ::read(input_, bytes, sizeof bytes);
    if (count < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (count <= 0) {  // the end: what stands there without a line's end counts too
      onLine(line, too_long);
      return say_("console: the input has ended");
    }
    for (const char byte : std::string_view(bytes, std::size_t(count))) {
      if (byte != '\n') {
        too_long = too_long || line.size() >= kLineLimit;
        if (!too_long) line += byte;
        continue;
      }
      onLine(line, too_long);
      line.clear();
      too_long = false;
    }
  }
}

void Console::onLine(const std::string& line, bool too_long) {
  if (too_long) return say_("console: a line of more than " + std::to_string(kLineLimit) + " bytes; nothing changes");
  if (line.find_first_not_of(" \t\r") == std::string::npos) return;
  constexpr std::string_view kCraterWord = "crater ", kSnowWord = "snow ";
  const std::string_view text = std::string_view(line).substr(line.find_first_not_of(" \t\r"));
  if (text.starts_with(kCraterWord)) return onCrater(text.substr(kCraterWord.size()));
  if (text.starts_with(kSnowWord)) return onSnowfall(text.substr(kSnowWord.size()));
  auto values = parseAssignments(line);
  if (!values) return say_("console: " + values.error() + "; nothing changes");
  if (!queue_.push({0, std::move(*values)}))
    say_("console: " + std::to_string(ChangeQueue::kLimit) + " changes wait for a tick already; nothing changes");
}

void Console::onCrater(std::string_view text) {
  const auto wish = parseCrater(text);
  if (!wish) return say_("console: crater: " + wish.error() + "; there is none");
  if (!craters_.push(*wish))
    say_("console: " + std::to_string(CraterQueue::kLimit) + " craters wait for a tick already; there is none");
}

void Console::onSnowfall(std::string_view text) {
  const auto wish = parseSnowfall(text);
  if (!wish) return say_("console: snow: " + wish.error() + "; there is none");
  if (!snowfalls_.push(*wish))
    say_("console: " + std::to_string(SnowfallQueue::kLimit) + " snowfalls wait for a tick already; there is none");
}

}  // namespace spoor
