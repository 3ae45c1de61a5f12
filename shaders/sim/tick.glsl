// Bindings that most stages share, and how a group finds its work.
#ifndef SPOOR_SIM_TICK_GLSL
#define SPOOR_SIM_TICK_GLSL
#include "../rules/limits.h"
#include "tables.h"

layout(local_size_x = SPOOR_GROUP) in;
const int kGroup = SPOOR_GROUP;

layout(std430, binding = kBindTick) buffer Tick {
  TickHead tick;
  RoundLists lists[];
};
layout(location = 0) uniform int group_count;
layout(location = 1) uniform int list;  // of RoundLists

/// Groups are dispatched in rows; this is their number in reading order.
int groupIndex() { return int(gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x); }
int lane() { return int(gl_LocalInvocationID.x); }

#endif
