#pragma once

#include <array>
#include <chrono>

namespace spoor {

/// The stages of a tick (DESIGN.md), by the names they have everywhere.
enum class Stage { commands, craters, active, depth, penetration, nearest, displace, relax, hash, delta, publish };
inline constexpr int kStageCount = 11;
inline constexpr std::array<const char*, kStageCount> kStageNames = {"commands",    "craters", "active",   "depth",
                                                                     "penetration", "nearest", "displace", "relax",
                                                                     "hash",        "delta",   "publish"};

using StageTimes = std::array<double, kStageCount>;  // ms

/// Adds the time from its making to its end to one stage. Profiling only; never read by the simulation.
class StageTimer {
 public:
  StageTimer(StageTimes& times, Stage stage) : target_(&times[int(stage)]), start_(std::chrono::steady_clock::now()) {}
  ~StageTimer() {
    *target_ += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
  }
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

 private:
  double* target_;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace spoor
