#pragma once

#include <chrono>
#include <utility>
#include <vector>

#include "shaders/host/gl_objects.h"
#include "shared/sim/stage.h"

namespace spoor {

/// Times stages on the device. Hardware: by time stamps in its queue, which hold nothing up. Software: by finishing
/// after each stage, since there time stamps are taken when work is queued.
class StageClock {
 public:
  explicit StageClock(bool by_queries) : by_queries_(by_queries) {}
  ~StageClock() {
    if (!queries_.empty()) glDeleteQueries(GLsizei(queries_.size()), queries_.data());
  }
  StageClock(const StageClock&) = delete;
  StageClock& operator=(const StageClock&) = delete;

  /// A tick's first stage begins.
  void begin();
  /// A stage ends and the next one begins.
  void end(Stage stage);
  /// Adds what has been timed since begin(). The device must be past the last end().
  void addTo(StageTimes& times) const;

 private:
  void mark();

  bool by_queries_;
  std::vector<GLuint> queries_;
  std::vector<double> marks_ms_;
  std::vector<Stage> ended_;
};

}  // namespace spoor
