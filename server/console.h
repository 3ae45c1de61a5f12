#pragma once

#include <functional>
#include <string>
#include <thread>

#include "server/crater_feed.h"
#include "server/parameter_changes.h"
#include "server/snowfall_feed.h"

namespace spoor {

/// Reads lines "[MATERIAL.]NAME=VALUE[,...]", "crater X,Y,R1,R2,D5[,H4|balanced][,NOISE]" and
/// "snow X0,Y0,X1,Y1,MM_PER_HOUR,SECONDS[,SEED]" from a file descriptor on a thread of its own, for as long as it lives
/// or until the input ends (which it says), and queues them. Safe on untrusted input: a bad line is said and changes
/// nothing.
class Console {
 public:
  static constexpr std::size_t kLineLimit = 4096;  // bytes; a longer line is a bad one

  /// @param input    stays open, and the caller's; 0 is standard input
  /// @param queue    outlives this
  /// @param craters  outlives this
  /// @param snowfalls  outlives this
  /// @param say      called from the console's thread
  Console(int input, ChangeQueue& queue, CraterQueue& craters, SnowfallQueue& snowfalls,
          std::function<void(const std::string&)> say);
  ~Console();
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

 private:
  void serve();
  void onLine(const std::string& line, bool too_long);
  void onCrater(std::string_view text);
  void onSnowfall(std::string_view text);

  int input_;
  int stop_[2];  // a pipe: what is written to the second end wakes the thread, to leave
  ChangeQueue& queue_;
  CraterQueue& craters_;
  SnowfallQueue& snowfalls_;
  std::function<void(const std::string&)> say_;
  std::thread thread_;
};

}  // namespace spoor
