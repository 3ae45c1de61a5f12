// What the host tells the compute shaders about a tick, and what they tell it: one text for C++ and GLSL.
// Every struct is made of 4-byte ints, so that both languages lay it out alike.
#ifndef SPOOR_SIM_TABLES_H
#define SPOOR_SIM_TABLES_H
#include "../rules/limits.h"

SPOOR_RULES_BEGIN

// Storage bindings; no shader uses more than 14 of them. Cells of tiles are indexed by active tile, those of domains by
// DomainEntry::first_cell.
RULE_CONST kBindTick = 0;            // Tick
RULE_CONST kBindTiles = 1;           // TileEntry [active tiles]
RULE_CONST kBindTileStates = 2;      // TileState [active tiles]
RULE_CONST kBindHeight = 3;          // int [active tiles * kTileCells]
RULE_CONST kBindBedrock = 4;         // the same
RULE_CONST kBindUnderside = 5;       // the same; only where a tile is covered
RULE_CONST kBindBlocks = 6;          // Block [groups of the dispatch]
RULE_CONST kBindDomains = 7;         // DomainEntry [domains of the sub-step]
RULE_CONST kBindDomainTiles = 8;     // int: the active tile of every tile that a domain meets
RULE_CONST kBindOverlap = 9;         // int [domain cells]
RULE_CONST kBindTarget = 10;         // int [domain cells]: index in the domain's box, or kNoTarget
RULE_CONST kBindRequestedLow = 11;   // uint [domain cells]: soil that wants to come to a cell, 64 bits in two words;
RULE_CONST kBindRequestedHigh = 12;  // 0 everywhere between sub-steps
RULE_CONST kBindGranted = 14;        // uint [domain cells]: what was let in where not all fits; 0 as these
RULE_CONST kBindRowChunks = 15;      // RowChunk [groups of the dispatch]
// Stages that do not need the planes of displacement use their bindings for:
RULE_CONST kBindBodies = 9;            // depth: BodyEntry [bodies of the sub-step]
RULE_CONST kBindPoints = 10;           // depth: int [3 * points of the sub-step's bodies], as RasterPoint
RULE_CONST kBindVertices = 11;         // depth: int [3 * vertices of all meshes]
RULE_CONST kBindIndices = 12;          // depth: int, the triangles of all meshes (3 each) and their edges (2 each)
RULE_CONST kBindLarge = 13;            // depth: ivec2 (body, primitive): those worth groups of their own
RULE_CONST kBindUndersideBefore = 12;  // depth, penetration: as kBindUnderside, a sub-step earlier
RULE_CONST kBindFreeMask = 13;         // nearest: uint [words of the domains]: a column's 32 cells, bit set: free
RULE_CONST kBindNearestRow = 14;   // nearest: int [domain cells]: of the same column, in rows of the box, or kNoFreeRow
RULE_CONST kBindRowFlags = 1;      // penetration, displace: int [rows of all domains of all sub-steps]
RULE_CONST kBindReceivers = 6;     // displace: RowChunk: rows that hold targets
RULE_CONST kBindKnown = 11;        // nearest by flooding: int [domain cells]: as kBindTarget, before a pass
RULE_CONST kBindNextKnown = 12;    // the same after it
RULE_CONST kBindNearer = 11;       // iterative: int [domain cells]: bit d: neighbour d is nearer to a free cell
RULE_CONST kBindCarried = 12;      // iterative: int [domain cells], before a step
RULE_CONST kBindNextCarried = 13;  // the same after it
RULE_CONST kBindOffered = 14;      // iterative: int [domain cells]: sum of offers to a cell
RULE_CONST kBindRoom = 15;         // iterative: int [domain cells]: what a cell can take in a step
RULE_CONST kBindNextHeight = 6;    // relax: int [active tiles * kTileCells]: heights after a sweep
RULE_CONST kBindAmounts = 9;       // relax: the same: what a cell gives each neighbour that it gives to
RULE_CONST kBindSpareHeight = 10;  // relax: the same: heights after the next sweep
RULE_CONST kBindPushX = 11;    // push, drift: int [active tiles * kTileCells]: what bodies push with, then how far it
RULE_CONST kBindPushY = 12;    // moves the soil (rules/drift.h)
RULE_CONST kBindPushes = 10;   // push: Push [bodies that push]
RULE_CONST kBindMaterial = 7;  // relax, push: uint [active tiles * kTileCells / 4]: numbers of the materials of four
                               // cells, the first in the low byte; where there are several
RULE_CONST kBindDomainMaterial = 10;  // penetration: the same
RULE_CONST kBindSnowTiles = 2;        // snow: SnowTile [tiles in snow]
RULE_CONST kBindSnowLayers = 3;       // snow: SnowLayer
RULE_CONST kBindCraterTiles = 2;      // craters: CraterTile [tiles that new ones change]
RULE_CONST kBindCraterChanges = 3;    // craters: int: differences of these tiles' boxes, one after the other
RULE_CONST kBindCraterSums = 4;       // craters: CraterSum [2 * the same cells]: without and with new craters
RULE_CONST kBindCraterTable = 11;     // craters: the first of kCraterTableBuffers, up to 15
RULE_CONST kBindPoolHeight = 9;       // craters, gather, hash: int [slots * kTileCells]: heights before this tick
RULE_CONST kBindPoolBedrock = 10;     // craters, gather: the same
RULE_CONST kBindResults = 11;         // hash: TileResult [active tiles]
RULE_CONST kBindStaging = 12;         // hash: int: differences of all changed tiles' boxes, one after the other
RULE_CONST kBindPoolMaterial = 15;    // gather: uint, four cells in a word
RULE_CONST kBindPoolCompacted = 13;   // gather, hash: as heights
RULE_CONST kBindCompacted = 14;  // gather, penetration, hash: int [active tiles * kTileCells], where the tick compacts

// Uniform bindings.
RULE_CONST kBindMaterials = 0;  // MaterialEntry [kMaterialsMost]
RULE_CONST kMaterialsMost = 16;

RULE_CONST kSnowLaneCells = 4;           // cells of a tile that a lane of snow takes
RULE_CONST kCraterLaneCells = 4;         // cells of a tile that a lane of craters takes
RULE_CONST kCraterEntriesAtOnce = 4096;  // of a bucket, in one dispatch: a lane's loops must end (llvmpipe: 65 535)
RULE_CONST kGatherQuads = 4;             // cells of a tile, in fours, that a lane gathers
RULE_CONST kBlocksPerSide = 2;           // of a tile, in a fused sweep
RULE_CONST kSlabRows = 8;                // what relax skips where nothing has changed
RULE_CONST kSlabs = kTileSize / kSlabRows;
RULE_CONST kSlabCells = kSlabRows * kTileSize;
RULE_CONST kMaskRows = 32;             // rows of a free mask's word, and of a block of a domain
RULE_CONST kLargeParts = 4;            // groups that share a large primitive
RULE_CONST kDispatchRowsMost = 65535;  // GL guarantees no more
RULE_CONST kDispatchColumns = 256;     // groups per row of a dispatch whose size the GPU finds

RULE_CONST kRowPenetrates = 1;
RULE_CONST kRowReceives = 2;  // in the first round; in round i that bit << i

/// Size of an indirect dispatch, and how many of its groups have work.
struct GroupCount {
  int x;
  int y;
  int z;
  int used;
};

/// Lists that the GPU makes in a round of displacement, in no particular order.
struct RoundLists {
  GroupCount large;      // kBindLarge; in the first round only, as depth comes before it
  GroupCount rows;       // kBindRowChunks; in later rounds the same rows, or none where no soil is left
  GroupCount receivers;  // kBindReceivers
  GroupCount wholes;     // all blocks of the domains; y is 0 until there is soil to displace, then `used`
};

/// The head of the tick's table; RoundLists of all rounds of all sub-steps follow it.
struct TickHead {
  int tile_count;
  int obstacle_threshold;
  int penetration_divider;  // from here on as in Parameters
  int spread_cells;
  // From here on written by the GPU.
  int highest;            // of all heights so far in this tick
  int penetrating_cells;  // of all sub-steps
  int slabs_visited;      // by the relaxation; each stands for kSlabRows * kTileSize / 2 pairs
  int staged_cells;
  uint kept_back_low;  // soil that found no room, of all sub-steps: 64 bits in two words
  uint kept_back_high;
};

/// The rules of a material, as the tick's slope rule wants them. No arrays: those of uniform blocks are laid out
/// otherwise than C++ does.
struct MaterialEntry {
  int slope_threshold;     // drift: DriftNumbers::rest
  int diagonal_threshold;  // drift: DriftNumbers::inverse
  int roughness;           // drift: DriftNumbers::rate
  int compression;         // from here on as in MaterialRules
  int compaction_limit;
  int friction_inverse;
  int reserved_a;
  int reserved_b;
};

/// An active tile.
struct TileEntry {
  int slot;  // in the pool
  int x0;    // its first cell
  int y0;
  int inside_columns;  // how much of it lies in the world
  int inside_rows;
  int neighbour[9];  // active tile at (dy + 1) * 3 + (dx + 1), or -1; 4 is the tile itself
};

/// A tile that was live before the tick and that new craters change.
struct CraterTile {
  int slot;     // in the pool
  int tile_x0;  // its first cell
  int tile_y0;
  int x0;  // the box of cells in it that they meet; it lies in the world
  int y0;
  int x1;
  int y1;
  int first_change;  // in kBindCraterChanges: the box's cells, row-major
  uint gained[2];    // written by the GPU: sums of the low and high 16 bits of the box's differences + 2^31
};

/// A tile that was live and awake before the tick and takes snow in it.
struct SnowTile {
  int slot;  // in the pool
  int x0;    // its first cell
  int y0;
  int first_layer;  // SnowLayer: of each snowfall that it takes
  int end_layer;
};

/// What a snowfall leaves on a tile between two beats (rules/snowfall.h).
struct SnowLayer {
  int x0;  // cells it falls on
  int y0;
  int x1;
  int y1;
  uint seed;
  int layers_before;  // SnowDepth
  uint share_before;
  int layers;
  uint share;
};

/// A body that pushes soil, in one sub-step.
struct Push {
  int body;        // BodyEntry
  uint force_low;  // PlacedBody::force_cell: 64 bits in two words
  uint force_high;
  int direction_x;  // Q30
  int direction_y;
  int contacts;  // written by the GPU: cells that the body presses on
};

/// What the tick knows of an active tile's slabs.
struct TileState {
  int ceiling[kSlabs];     // the lowest underside; kNoUnderside: none, and the slab's undersides are not filled
  int changed_at[kSlabs];  // step of the relaxation at which it last changed
};

/// One group's share of a table: what `owner` means depends on the stage.
struct Block {
  int owner;
  int x;
  int y;
};

/// Cells [chunk * group size, ...) of one row of a domain.
struct RowChunk {
  int domain;
  int row;
  int chunk;
};

/// A body in one sub-step.
struct BodyEntry {
  int matrix[9];  // rules/place.h, Placement
  int within_x;
  int within_y;
  int cell;
  int origin_x;
  int origin_y;
  int z;
  int x0;  // its box; empty ones are left out
  int y0;
  int x1;
  int y1;
  int domain;
  int first_vertex;  // of its mesh, in kBindVertices
  int vertex_count;
  int first_point;     // in kBindPoints
  int first_triangle;  // int in kBindIndices
  int triangle_count;
  int first_edge;  // int in kBindIndices
  int edge_count;
};

/// A search domain in one sub-step.
struct DomainEntry {
  int x0;
  int y0;
  int width;
  int rows;
  int first_cell;  // in the planes of domains
  int first_word;  // in kBindFreeMask; row-major words of the box
  int first_row;   // in kBindRowFlags
  int first_tile;  // in kBindDomainTiles
  int tile_x0;     // the domain's tiles, in tiles
  int tile_y0;
  int tile_columns;
};

/// What a tick did to an active tile.
struct TileResult {
  int x0;  // the box of changed cells [x0, x1) x [y0, y1); empty: none
  int y0;
  int x1;
  int y1;
  uint hash_low[2];   // sums of the low and high 16 bits of the cells' low lanes (rules/mix.h), of both planes
  uint hash_high[2];  // and of their high lanes
  uint height[2];     // sums of the low and high 16 bits of height + 2^30
  uint compacted[2];  // of compacted soil, where the tick compacts
  int compacts;       // has any compacted soil of the box changed?
  int first_staged;   // the box's differences in kBindStaging, row-major: heights; where it compacts the other plane
};

SPOOR_RULES_END
#endif
