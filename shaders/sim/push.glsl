// Stage relax, drift: the cells that a body which pushes presses on. A lane takes up to 32 cells of a column of its
// box.
#ifndef SPOOR_SIM_PUSH_GLSL
#define SPOOR_SIM_PUSH_GLSL
#include "../rules/drift.h"
#include "domains.glsl"
#include "tick.glsl"

// owner: push; x: chunk of columns; y: first row of 32, both in the body's box
layout(std430, binding = kBindBlocks) readonly buffer Blocks { Block blocks[]; };
layout(std430, binding = kBindHeight) readonly buffer Height { int height[]; };
layout(std430, binding = kBindUnderside) readonly buffer Underside { int underside[]; };
layout(std430, binding = kBindBodies) readonly buffer Bodies { BodyEntry bodies[]; };
layout(std430, binding = kBindPushes) buffer Pushes { Push pushes[]; };

struct PushColumn {
  int x;
  int y;
  int end_y;  // y where there is nothing to do
  TileGrid grid;
};

PushColumn pushColumn(Block block) {
  BodyEntry body = bodies[pushes[block.owner].body];
  PushColumn own;
  own.x = body.x0 + block.x * kGroup + lane();
  own.y = body.y0 + block.y;
  own.end_y = own.x < body.x1 ? min(own.y + kMaskRows, body.y1) : own.y;
  own.grid = tileGrid(body.domain);
  return own;
}

/// The column's cell in row y where the body presses on it, else -1.
int contactAt(PushColumn own, int y) {
  int at = tileCell(own.grid, own.x, y);
  return isContact(height[at], underside[at], tick.obstacle_threshold) ? at : -1;
}

#endif
