// The head of a device's crater table: what rules/crater_hash.h needs besides the buffers; and what building it needs.
#ifndef SPOOR_SIM_CRATER_TABLE_H
#define SPOOR_SIM_CRATER_TABLE_H
#include "../rules/crater.h"
#include "../rules/crater_hash.h"

SPOOR_RULES_BEGIN

RULE_CONST kCraterTableBuffers = 5;  // storage bindings from the first: head, shapes, first, used, entries
// Bindings of the kernels that build it, after these:
RULE_CONST kBindCraterStarts = 5;  // int [lanes of crater_sums]: places of a lane's buckets, then where they begin
RULE_CONST kBindCraterHeads = 6;   // int [buckets]: the node that came last, or -1
RULE_CONST kBindCraterNodes = 7;   // how many there are, CraterNode [kCraterNodesAtOnce]

RULE_CONST kCraterLaneBuckets = 128;   // buckets that a lane of the prefix sum takes
RULE_CONST kCraterScanLanes = 256;     // of the one group that adds up the lanes' sums
RULE_CONST kCraterNodesAtOnce = 2048;  // a list is walked once for each of its nodes: that bounds the work
RULE_CONST kCraterGroupsPerRow = 256;  // of the prefix sum's dispatches

struct CraterHead {
  int side;    // of a hash cell, 0.1 mm
  int width;   // of the map
  int height;  //
  int mask;    // buckets - 1; -1: there are no craters and no buckets
  int count;   // of craters
  int cell;    // side of a terrain cell
  int reserved[2];
};

/// An entry on its way into its bucket, in a list of its bucket's new ones.
struct CraterNode {
  CraterEntry entry;
  int bucket;
  int next;   // the node that came before it, or -1
  int grown;  // of the last in order: how many there are; else 0
};

SPOOR_RULES_END

#endif
