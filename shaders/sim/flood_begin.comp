// Stage nearest by jump flooding, first pass: free cells know themselves, others nothing.
// In: blocks, overlap. Out: next known. A lane takes 32 cells of a column. Twin: nearest_flood.cpp.
#version 450 core
#include "domain_column.glsl"
#include "flood.glsl"

layout(std430, binding = kBindOverlap) readonly buffer Overlap { int overlap[]; };
layout(std430, binding = kBindNextKnown) writeonly buffer NextKnown { int next_known[]; };

void main() {
  DomainColumn own = domainColumn();
  DomainEntry domain = domains[own.domain];
  for (int row = own.first_row; row < own.end_row; ++row) {
    int cell = domain.first_cell + row * domain.width + own.column;
    next_known[cell] = overlap[cell] == kFree ? packedPlace(own.column, row) : kNoTarget;
  }
}
