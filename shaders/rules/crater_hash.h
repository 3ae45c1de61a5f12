// The spatial hash of craters: square cells, kept in buckets. A crater is in every cell of the map that the square
// about it meets. Pozzer et al. 2014 build it by counting and a prefix sum; ours leaves room in each bucket, so that a
// new crater is put there without moving the others.
#ifndef SPOOR_RULES_CRATER_HASH_H
#define SPOOR_RULES_CRATER_HASH_H
#include "mix.h"

SPOOR_RULES_BEGIN

/// One place in a bucket.
struct CraterEntry {
  int record;  // index, and id, of the crater
  uint tag;    // of the cell, craterTag
};

/// @param mask  buckets - 1, which are a power of two
RULE int craterBucket(int cell_x, int cell_y, int mask) {
  return int(mix32(uint(cell_x) * 0x9e3779b1u + mix32(uint(cell_y) * 0x85ebca77u + 0x27220a95u))) & mask;
}

/// Tells apart the cells of a bucket. Cells with the same tag are so far apart that no crater reaches both.
RULE uint craterTag(int cell_x, int cell_y) { return (uint(cell_x) & 0xffffu) | (uint(cell_y) << 16); }

/// Places of a bucket that is built with `count` entries.
RULE int craterCapacity(int count) { return count + (count >> 1) + 6; }

/// First and last cell, along one axis, that a crater meets; none where first > last.
/// Ranges: those of a valid crater; centre + outer may be more than an int holds.
/// @param size  of the map
RULE int craterFirstCell(int centre, int outer, int side) { return maxInt(centre - outer, 0) / side; }
RULE int craterLastCell(int centre, int outer, int side, int size) {
  if (centre < -outer || centre - outer >= size) return -1;
  return (centre > size - 1 - outer ? size - 1 : centre + outer) / side;
}

SPOOR_RULES_END

#endif
