#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "shared/world/crater.h"

namespace spoor {

/// A crater that somebody wishes for: a record without tick and id, whose rim may be left to the rule.
struct CraterWish {
  Crater crater;
  bool balanced = false;  // H4 is to be balancedRimHeight; the record's own does not count
  bool operator==(const CraterWish&) const = default;
};

/// The record, its rim solved where that was wished for. Safe on untrusted values. Errors: those of validateCrater.
Result<Crater> resolveCrater(const ScenePack& pack, const CraterWish& wish);

/// A wish for a tick, 1 or later.
struct TimedCrater {
  std::int32_t tick = 0;
  CraterWish wish;
};

/// Reads "X,Y,R1,R2,D5[,H4|balanced][,NOISE]": metres, and the noise's strength, 0 .. 1; without H4 it is balanced. The
/// noise's seed follows from the other numbers. Safe on untrusted text; whether a scene admits it is another question.
Result<CraterWish> parseCrater(std::string_view text);

/// Reads "TICK:X,Y,R1,R2,D5[,H4|balanced][,NOISE]". Safe on untrusted text.
Result<TimedCrater> parseTimedCrater(std::string_view text);

/// "(25, 17.5) m, R1 1 m, R2 2 m, D5 0.5 m, H4 0.2 m, noise 0.3", the last where there is any.
std::string describeCrater(const Crater& crater);

}  // namespace spoor
