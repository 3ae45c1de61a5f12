// The head of a device's crater table: what rules/crater_hash.h needs besides the buffers.
#ifndef SPOOR_SIM_CRATER_TABLE_H
#define SPOOR_SIM_CRATER_TABLE_H
#include "../rules/crater.h"
#include "../rules/crater_hash.h"

SPOOR_RULES_BEGIN

RULE_CONST kCraterTableBuffers = 5;  // storage bindings from the first: head, shapes, first, used, entries

struct CraterHead {
  int side;    // of a hash cell, 0.1 mm
  int width;   // of the map
  int height;  //
  int mask;    // buckets - 1; -1: there are no craters and no buckets
  int count;   // of craters
  int cell;    // side of a terrain cell
  int reserved[2];
};

SPOOR_RULES_END

#endif
