#include "shaders/host/stage_clock.h"

namespace spoor {

void StageClock::begin() {
  ended_.clear();
  marks_ms_.clear();
  mark();
}

void StageClock::end(Stage stage) {
  ended_.push_back(stage);
  mark();
}

void StageClock::mark() {
  const std::size_t index = ended_.size();
  if (!by_queries_) {
    glFinish();
    const auto now = std::chrono::steady_clock::now().time_since_epoch();
    marks_ms_.push_back(std::chrono::duration<double, std::milli>(now).count());
    return;
  }
  if (index == queries_.size()) {
    queries_.emplace_back();
    glCreateQueries(GL_TIMESTAMP, 1, &queries_.back());
  }
  glQueryCounter(queries_[index], GL_TIMESTAMP);
}

void StageClock::addTo(StageTimes& times) const {
  const auto at_ms = [&](std::size_t index) {
    if (!by_queries_) return marks_ms_[index];
    GLuint64 at_ns = 0;
    glGetQueryObjectui64v(queries_[index], GL_QUERY_RESULT, &at_ns);
    return double(at_ns) / 1e6;
  };
  for (std::size_t i = 0; i < ended_.size(); ++i) times[int(ended_[i])] += at_ms(i + 1) - at_ms(i);
}

}  // namespace spoor
