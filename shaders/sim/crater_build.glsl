// What the kernels that build craters' spatial hash share: the table's buffers, to be written, and a record's cells.
#ifndef SPOOR_SIM_CRATER_BUILD_GLSL
#define SPOOR_SIM_CRATER_BUILD_GLSL
#include "crater_table.h"

layout(local_size_x = SPOOR_GROUP) in;
layout(std430, binding = 0) readonly buffer CraterHeadBlock { CraterHead crater_head; };
layout(std430, binding = 1) readonly buffer CraterShapes { CraterShape crater_shapes[]; };
layout(std430, binding = 2) buffer CraterFirst { int crater_first[]; };
layout(std430, binding = 3) buffer CraterUsed { int crater_used[]; };
layout(std430, binding = 4) writeonly buffer CraterEntries { CraterEntry crater_entries[]; };
layout(std430, binding = kBindCraterStarts) buffer CraterStarts { int crater_starts[]; };
layout(std430, binding = kBindCraterHeads) buffer CraterHeads { int crater_heads[]; };
layout(std430, binding = kBindCraterNodes) buffer CraterNodes {
  int crater_node_count;
  CraterNode crater_nodes[];
};
layout(location = 0) uniform int first_of_all;  // what the dispatch begins with, and ends before: records, or nodes
layout(location = 1) uniform int end_of_all;

int invocation() {
  uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
  return int(group) * SPOOR_GROUP + int(gl_LocalInvocationID.x);
}

/// The hash cells that a record meets, row by row.
struct CraterCells {
  ivec2 first;
  int columns;
  int count;
};

CraterCells cellsOf(int record) {
  int x = crater_shapes[record].x, y = crater_shapes[record].y, outer = crater_shapes[record].outer;
  int side = crater_head.side;
  ivec2 first = ivec2(craterFirstCell(x, outer, side), craterFirstCell(y, outer, side));
  ivec2 last =
      ivec2(craterLastCell(x, outer, side, crater_head.width), craterLastCell(y, outer, side, crater_head.height));
  ivec2 size = max(last - first + 1, ivec2(0));
  return CraterCells(first, size.x, size.x * size.y);
}

ivec2 cellAt(CraterCells cells, int i) { return cells.first + ivec2(i % cells.columns, i / cells.columns); }

#endif
