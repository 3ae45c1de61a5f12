#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shaders/sim/tables.h"
#include "shared/sim/drift.h"

namespace spoor {

/// Meshes of a pack in two flat arrays, as the shaders read them.
struct MeshTable {
  struct Place {
    int first_vertex = 0;
    int first_triangle = 0;  // offsets in `indices`
    int first_edge = 0;
  };
  std::vector<std::int32_t> vertices;  // [3 * vertices]
  std::vector<std::int32_t> indices;   // triangles of all meshes, then edges of all meshes
  std::vector<Place> places;           // [meshes]
};
MeshTable makeMeshTable(const ScenePack& pack);

/// How work is cut into groups. None of it changes one bit of what comes out.
struct GroupShape {
  int group = 64;              // lanes of a group: 64, 128 or 256
  int groups_per_row = 65535;  // of a dispatch; GL guarantees 65 535
  bool reversed = false;       // last tile, body and block first
};

/// Bytes of the upload, aligned so that they can be bound.
struct TableRange {
  std::int64_t offset = 0;
  std::int64_t bytes = 0;
};

/// A dispatch: how many groups, where its indirect arguments lie, and its groups' blocks where it has any.
struct GroupList {
  int count = 0;
  std::int64_t arguments = 0;  // offset
  TableRange blocks;
};

struct SubStepTables {
  TableRange bodies, domains, domain_tiles;
  int first_list = 0;  // of RoundLists; one for each round
  GroupList cover, place, primitives, domain_blocks;
  TableRange pushes;      // Push
  GroupList push_blocks;  // none where nothing pushes
  int push_limit = 0;
  std::int64_t point_count = 0, primitive_count = 0, domain_cells = 0, mask_words = 0, row_chunks = 0;
  int longest_side = 0;  // of a domain, in cells
  int first_step = 0;    // of the relaxation
  int sweep_count = 0;
};

/// Tiles that new craters change, in the plan's order.
struct CraterTables {
  TableRange range;  // CraterTile, which the shaders write sums into
  GroupList groups;
  std::vector<rules::CraterTile> tiles;
  std::vector<int> active;  // [tiles] index in the plan
  std::int64_t cells = 0;   // of all boxes
};

/// Tiles that take snow before the tick, in the plan's order.
struct SnowTables {
  TableRange tiles, layers;
  GroupList groups;  // none where none does
};

/// What changes live tiles before a tick's stages: snow, then craters. Empty: nothing does.
struct TileEvents {
  std::span<const std::uint8_t> snowed;    // [plan.active] as ActiveTiles has it
  std::span<const Snowfall> snowfalls;     // of the state
  std::span<const CellBox> cratered = {};  // [plan.active] the same
};

/// Everything that the shaders need to know of a tick, in one piece of bytes.
struct TickTables {
  std::vector<std::uint8_t> bytes;
  std::int32_t tick = 0;
  Parameters parameters;
  rules::DriftStep drift{};
  TableRange head;  // TickHead and RoundLists
  TableRange row_flags;
  TableRange tiles;      // TileEntry [active tiles]
  TableRange materials;  // MaterialEntry [kMaterialsMost]
  SnowTables snow;
  CraterTables craters;
  GroupList gather, exchange, sweep, slope, hash;
  SubStepTables stood;  // where bodies stood before the tick: for depth only
  std::vector<SubStepTables> sub_steps;
  bool mixed = false;           // are there several materials?
  bool beneath = false;         // may an underside, or the height limit, stop soil from coming somewhere?
  std::vector<int> tile_index;  // [plan.active] where the shaders have that tile
};

/// @param slots    [plan.active] of the tiles in the pool
/// @param highest  no cell of the active tiles is higher before the tick
TickTables makeTickTables(const ScenePack& pack, const MeshTable& meshes, const TickPlan& plan,
                          std::span<const int> slots, std::int32_t highest, const GroupShape& shape,
                          const TileEvents& events = {});

}  // namespace spoor
