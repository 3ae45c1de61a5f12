// The numbers every room agrees on.
#ifndef SPOOR_RULES_LIMITS_H
#define SPOOR_RULES_LIMITS_H
#include "language.h"

SPOOR_RULES_BEGIN

RULE_CONST kTileSize = 64;  // cells along a tile's side
RULE_CONST kTileCells = kTileSize * kTileSize;
RULE_CONST kUnitsPerMetre = 10000;        // height units (0.1 mm); Persson's heightmapScale
RULE_CONST kHeightLimit = (1 << 30) - 1;  // heights lie within +-kHeightLimit, so differences never overflow
RULE_CONST kNoUnderside = kHeightLimit;   // no body over this cell: the room above it ends at the height limit
RULE_CONST kSubcells = 256;               // raster positions per cell side

RULE_CONST kFree = -1;     // overlap of a cell that can receive soil (the thesis's seed)
RULE_CONST kObstacle = 0;  // overlap of a cell just under, or inside, a body; > 0: penetrating
RULE_CONST kNoTarget = -1;

// Planes, as they enter hashes.
RULE_CONST kHeightPlane = 0;
RULE_CONST kCompactedPlane = 1;
RULE_CONST kMaterialPlane = 2;

/// The eight neighbours of a cell, in turn from +x towards +y: d = 0..7 is (1,0) (1,1) (0,1) (-1,1) (-1,0) ...; the one
/// opposite to d is d ^ 4. One from each of two bits of a constant.
RULE int neighbourX(int d) { return (0x901a >> (2 * d) & 3) - 1; }
RULE int neighbourY(int d) { return (0x01a9 >> (2 * d) & 3) - 1; }

SPOOR_RULES_END
#endif
