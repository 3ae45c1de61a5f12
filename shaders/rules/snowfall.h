// Snowfall: what has fallen on a cell by a tick, without the ticks between.
//
// Layer after layer of one unit falls; of the layer that is falling a cell has its unit already or not yet, each layer
// in another random order. So the sum over cells grows evenly, and what fell on a cell is within a unit of the mean.
// Source: the seed post's "step of accumulation that randomly add some snow across the texture", in closed form.
#ifndef SPOOR_RULES_SNOWFALL_H
#define SPOOR_RULES_SNOWFALL_H
#include "mix.h"

SPOOR_RULES_BEGIN

RULE_CONST kSnowBeat = 16;  // ticks from one to the next at which a tile takes what fell; a power of two

/// Depth of a snowfall on the mean: layers that are down, and the share of the next one in 2^-32.
struct SnowDepth {
  int layers;
  uint share;
};

/// Has a cell its unit of the layer that is falling?
RULE int snowFlake(uint seed, int x, int y, SnowDepth depth) {
  uint order = mix32(uint(x) * 0x9e3779b1u + mix32(uint(y) * 0x85ebca77u + mix32(uint(depth.layers) + seed)));
  return order < depth.share ? 1 : 0;
}

/// What fell on a cell in all, height units.
RULE int snowOn(uint seed, int x, int y, SnowDepth depth) { return depth.layers + snowFlake(seed, x, y, depth); }

/// Height of a cell on which `fallen` comes down. What lies below the undisturbed ground, as a trail does, takes up to
/// twice as much, and what stands out of it as much less, until both are level with it: wind fills hollows and blows
/// ridges bare. Any division of the time into parts gives the same.
/// @param level  of the undisturbed ground, the base and what had fallen on it before
/// Ranges: height and level within +-kHeightLimit; fallen 0..2^29 + 64.
RULE int snowGround(int height, int level, int fallen) {
  return height + minInt(fallen + clampInt(level - height, -fallen, fallen), kHeightLimit - height);
}

SPOOR_RULES_END
#endif
