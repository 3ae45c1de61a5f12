// Hash of one cell: two independent 32-bit lanes, so that both languages run it at full width. Sums of the lanes as
// 64-bit values are the tile hashes: order-free and incremental.
#ifndef SPOOR_RULES_MIX_H
#define SPOOR_RULES_MIX_H
#include "limits.h"

SPOOR_RULES_BEGIN

/// A bijection of 32 bits with full avalanche (two multiply-xorshift rounds).
RULE uint mix32(uint v) {
  v ^= v >> 16;
  v *= 0x7feb352du;
  v ^= v >> 15;
  v *= 0x846ca68bu;
  v ^= v >> 16;
  return v;
}

/// Where a cell lies and which plane it is, ready to be combined with its value. Unsigned: wraps.
RULE uint cellKey(int x, int y, int plane) {
  return mix32(uint(x) * 0x9e3779b1u + mix32(uint(y) * 0x85ebca77u + uint(plane)));
}

/// The low and high lane of a cell's hash. Added up over cells as (high << 32) + low with 64-bit wrap-around. In planes
/// other than height only cells that are not 0 count, so that a plane nobody made hashes like one that is 0 everywhere.
RULE uint cellMixLow(uint key, int value) { return mix32(key ^ uint(value)); }
RULE uint cellMixHigh(uint key, int value) { return mix32((key + 0x632be5abu) ^ (uint(value) * 0x2c1b3c6du)); }

SPOOR_RULES_END
#endif
