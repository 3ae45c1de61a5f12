// Stage craters: snow, then craters.
#include <algorithm>
#include <stdexcept>

#include "shaders/host/gl_stages.h"
#include "shaders/rules/crater_hash.h"

namespace spoor {
namespace {

/// Entries of the fullest bucket that cells of these tiles' boxes look into.
int mostEntries(const CraterTables& tiles, const CraterTable& table, std::int32_t cell_q) {
  std::int32_t most = 0;
  for (const rules::CraterTile& tile : tiles.tiles) {
    const auto hashCell = [&](std::int32_t cell) {
      return std::int32_t((std::int64_t(cell) * cell_q + cell_q / 2) / table.side_q);
    };
    const std::int32_t x0 = hashCell(tile.tile_x0 + tile.x0), x1 = hashCell(tile.tile_x0 + tile.x1 - 1);
    const std::int32_t y0 = hashCell(tile.tile_y0 + tile.y0), y1 = hashCell(tile.tile_y0 + tile.y1 - 1);
    // Where hash cells are smaller than cells they may be more than there are buckets.
    if ((std::int64_t(x1) - x0 + 1) * (std::int64_t(y1) - y0 + 1) > std::int64_t(table.used.size()))
      return *std::ranges::max_element(table.used);
    for (std::int32_t y = y0; y <= y1; ++y)
      for (std::int32_t x = x0; x <= x1; ++x)
        most = std::max(most, table.used[std::size_t(rules::craterBucket(x, y, table.mask()))]);
  }
  return most;
}

}  // namespace

Result<const GlProgram*> GlStages::compiled(const GlProgram& (GlPrograms::*program)()) {
  try {
    return &(programs_.*program)();
  } catch (const std::runtime_error& error) {
    return Error{error.what()};
  }
}

Status GlStages::snow(const TickTables& tick, const TilePool& pool) {
  const auto program = compiled(&GlPrograms::snow);
  if (!program) return Error{program.error()};
  bindTable(rules::kBindSnowTiles, tick.snow.tiles);
  bindTable(rules::kBindSnowLayers, tick.snow.layers);
  pool.height().bind(rules::kBindPoolHeight);
  use(**program);
  dispatch(tick.snow.groups);
  return {};
}

Status GlStages::craters(const TickTables& tick, const TilePool& pool, const CraterSet& craters, std::size_t first_new,
                         const GlCraterTable& table, std::int32_t cell_q) {
  const auto program = compiled(&GlPrograms::craters);
  if (!program) return Error{program.error()};
  const int most = mostEntries(tick.craters, craters.table(), cell_q);
  const std::int64_t cells = tick.craters.cells;
  if (Status status = crater_changes_.reserve(cells * std::int64_t(sizeof(std::int32_t))); !status) return status;
  const bool in_turns = most > rules::kCraterEntriesAtOnce;
  if (Status status = crater_sums_.reserve(in_turns ? cells * 2 * std::int64_t(sizeof(rules::CraterSum)) : 0); !status)
    return status;
  bindTable(rules::kBindCraterTiles, tick.craters.range);
  crater_changes_.bind(rules::kBindCraterChanges);
  crater_sums_.bind(rules::kBindCraterSums);
  pool.height().bind(rules::kBindPoolHeight);
  pool.bedrock().bind(rules::kBindPoolBedrock);
  table.bind(rules::kBindCraterTable);
  use(**program);
  setUniform(2, int(first_new));
  for (int entry = 0; entry == 0 || entry < most; entry += rules::kCraterEntriesAtOnce) {
    setUniform(3, entry);
    setUniform(4, entry + rules::kCraterEntriesAtOnce >= most ? 1 : 0);
    dispatch(tick.craters.groups);
  }
  return {};
}

}  // namespace spoor
