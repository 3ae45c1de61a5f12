#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "shared/world/pack.h"

namespace spoor {

/// A snowfall that somebody wishes for, in people's units.
struct SnowfallWish {
  std::array<double, 4> area_m{};  // x0, y0, x1, y1, from the world's south-west corner
  double rate_mm_per_hour = 0;
  double duration_s = 0;
  std::optional<std::uint32_t> seed = {};  // none: follows from the other numbers
  bool operator==(const SnowfallWish&) const = default;
};

/// The record: rounded to cells and ticks, a tick at least, and cut off at the world's borders. Safe on untrusted
/// values. Errors: nothing of it within the world, and those of validateSnowfall.
/// @param first_tick  >= 1
Result<Snowfall> resolveSnowfall(const ScenePack& pack, const SnowfallWish& wish, std::int32_t first_tick);

/// A wish for a tick, 1 or later.
struct TimedSnowfall {
  std::int32_t tick = 0;
  SnowfallWish wish;
};

/// Reads "X0,Y0,X1,Y1,MM_PER_HOUR,SECONDS[,SEED]", lengths in metres. Safe on untrusted text; whether it goes with a
/// scene is another question.
Result<SnowfallWish> parseSnowfall(std::string_view text);

/// Reads "TICK:X0,Y0,X1,Y1,MM_PER_HOUR,SECONDS[,SEED]". Safe on untrusted text.
Result<TimedSnowfall> parseTimedSnowfall(std::string_view text);

/// "(0, 0) to (25.6, 25.6) m, 36000 mm per hour, ticks 1 .. 600, seed 7".
std::string describeSnowfall(const ScenePack& pack, const Snowfall& snowfall);

}  // namespace spoor
