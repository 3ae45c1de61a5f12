// The free mask of a domain, column by column.
#ifndef SPOOR_SIM_FREE_ROWS_GLSL
#define SPOOR_SIM_FREE_ROWS_GLSL
#include "../rules/nearest.h"
#include "tables.h"

/// The nearest free row of a column seen from a row, or kNoFreeRow. `free_mask` must be declared.
int nearestFreeRow(DomainEntry domain, int column, int row) {
  int first_word = domain.first_word + column;
  int word = row / kMaskRows;
  uint bit = uint(row % kMaskRows);

  uint found = free_mask[first_word + word * domain.width] & (0xffffffffu >> (31u - bit));
  int at = word;
  while (found == 0u && at > 0) found = free_mask[first_word + --at * domain.width];
  int beneath = found != 0u ? at * kMaskRows + findMSB(found) : kNoFreeRow;

  int words = (domain.rows + kMaskRows - 1) / kMaskRows;
  found = free_mask[first_word + word * domain.width] & (0xffffffffu << bit);
  at = word;
  while (found == 0u && at + 1 < words) found = free_mask[first_word + ++at * domain.width];
  int above = found != 0u ? at * kMaskRows + findLSB(found) : kNoFreeRow;
  return nearestInColumn(row, beneath, above);
}

#endif
