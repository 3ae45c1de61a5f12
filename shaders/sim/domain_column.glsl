// What stages over whole domains share: a lane takes up to 32 cells of a column.
#ifndef SPOOR_SIM_DOMAIN_COLUMN_GLSL
#define SPOOR_SIM_DOMAIN_COLUMN_GLSL
#include "domains.glsl"
#include "tick.glsl"

// owner: domain; x: chunk of columns; y: first row of 32
layout(std430, binding = kBindBlocks) readonly buffer Blocks { Block blocks[]; };

struct DomainColumn {
  int domain;
  int column;
  int first_row;
  int end_row;  // first_row where there is nothing to do
};

DomainColumn domainColumn() {
  DomainColumn own = DomainColumn(0, 0, 0, 0);
  if (groupIndex() >= group_count) return own;
  Block block = blocks[groupIndex()];
  own.domain = block.owner;
  own.column = block.x * kGroup + lane();
  own.first_row = block.y;
  own.end_row = block.y;
  if (own.column < domains[block.owner].width) own.end_row = min(block.y + kMaskRows, domains[block.owner].rows);
  return own;
}

bool inDomain(DomainEntry domain, int x, int y) { return x >= 0 && y >= 0 && x < domain.width && y < domain.rows; }

#endif
