// Craters and their spatial hash as GlCraterTable binds them. Before it: #define CRATER_BINDING, the first of
// kCraterTableBuffers storage bindings.
#include "crater_table.h"

layout(std430, binding = CRATER_BINDING) readonly buffer CraterHeadBlock { CraterHead crater_head; };
layout(std430, binding = CRATER_BINDING + 1) readonly buffer CraterShapes { CraterShape crater_shapes[]; };
layout(std430, binding = CRATER_BINDING + 2) readonly buffer CraterFirst { int crater_first[]; };
layout(std430, binding = CRATER_BINDING + 3) readonly buffer CraterUsed { int crater_used[]; };
layout(std430, binding = CRATER_BINDING + 4) readonly buffer CraterEntries { CraterEntry crater_entries[]; };

/// Where the records of a place's hash cell are: entries [first, end) with this tag, in the order of their ids.
struct CraterRange {
  int first;
  int end;
  uint tag;
};

/// @param x, y  in the map, 0.1 mm
CraterRange cratersAt(int x, int y) {
  if (crater_head.mask < 0) return CraterRange(0, 0, 0u);
  ivec2 cell = ivec2(x, y) / crater_head.side;
  int bucket = craterBucket(cell.x, cell.y, crater_head.mask);
  int first = crater_first[bucket];
  return CraterRange(first, first + crater_used[bucket], craterTag(cell.x, cell.y));
}
