#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "shared/world/pack.h"

namespace spoor {

/// Whole numbers from which one is drawn; 0.1 mm where it is a length.
struct DrawnFrom {
  std::int32_t least = 0, most = 0;
};

/// What one [[crater]] table stands for: `count` craters, in integers. Of each, everything drawn is a hash of the seed
/// and of its index, so that the same file gives the same craters everywhere.
struct CraterGroup {
  std::int32_t count = 1;
  std::int32_t first_tick = 1;
  std::int64_t x_q = 0, y_q = 0;            // of the first
  std::int64_t step_x_q = 0, step_y_q = 0;  // from one to the next
  std::int32_t disc_q = 0;                  // offset of each: anywhere in a disc of this radius ..
  std::int32_t width_q = 0, height_q = 0;   // .. or in a rectangle of this size, centred
  std::int64_t apart_ticks_q16 = 0;         // from one to the next; count * apart below 2^63
  std::int32_t ahead_q16 = 0;               // added before rounding down to a tick
  DrawnFrom inner_radius_q, crest_radius_q, rim_height_q, depth_q, noise_q16;
  bool balanced = false;
  std::uint64_t seed = 0;
  std::int32_t noise_seed = -1;  // 0 .. 65535 of all of them; -1: drawn
};

/// A group's craters in order, without ids. One whose R1 is drawn above its R2 gets R2 for both. Those so far off that
/// 32 bits do not hold their centre are left out; the others need not be valid.
std::vector<Crater> makeCraters(const CraterGroup& group);

}  // namespace spoor
