#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "server/import/dem.h"
#include "server/import/importer.h"
#include "server/import/pack_maker.h"
#include "server/import/scene_parts.h"
#include "server/import/table_reader.h"
#include "server/import/thesis_table.h"
#include "server/import/units.h"
#include "shaders/rules/limits.h"

namespace spoor {
namespace {

constexpr std::uintmax_t kSceneFileLimitBytes = std::uintmax_t(16) << 20;
constexpr Range kHeightRange{-53000, 53000, "m"};
constexpr Range kWorldRange{0.0001, 210000, "m"};

void readHead(TableReader& file, const std::filesystem::path& path, ScenePack& pack) {
  pack.name = file.text("name", path.stem().string());
  pack.seed = std::uint64_t(file.integer("seed", {0, 9e18, ""}, 1));
  pack.default_ticks = std::int32_t(file.integer("ticks", {1, 1e9, "ticks"}, 600));
  pack.ticks_per_second = std::int32_t(file.integer("ticks_per_second", {1, 1000, "per second"}, 60));
}

/// The world's size as the file gives it, metres; 0 where it leaves it to the DEM.
struct WorldSize {
  double width_m = 0, height_m = 0;
};

/// The world as [thesis] says it: a square, and cells along its side. Of the two the number of cells is exact.
WorldSize readSquareWorld(const TableReader& world, TableReader& thesis, SceneDraft& draft) {
  for (const char* key : {"terrainSize", "heightmapSize"})
    for (const char* other : {"cell_m", "size_m", "cells"}) refuseBoth(thesis, key, world, other);
  for (const char* key : {"terrainSize", "heightmapSize"})
    if (!thesis.has(key)) thesis.wrong(key, "missing; terrainSize and heightmapSize go together");
  const double terrain_m = thesis.number("terrainSize", namedRange("terrainSize"), 1);
  const auto cells = double(thesis.integer("heightmapSize", namedRange("heightmapSize"), 1));
  const double cell_m = terrain_m / cells;
  if (cell_m < 0.00005 || cell_m > 100) {
    thesis.wrong("heightmapSize", fmt::format("{} cells in {} m are {} m each, not within 0.0001 .. 100 m", cells,
                                              plainNumber(terrain_m), plainNumber(cell_m)));
    return {};
  }
  draft.scene.pack.cell_q = toUnits(cell_m);
  const double rounded_m = double(draft.scene.pack.cell_q) / rules::kUnitsPerMetre;
  const double size_m = cells * rounded_m;
  if (std::abs(size_m - terrain_m) > 1e-9)
    draft.scene.notes.push_back(
        fmt::format("thesis.terrainSize: cells of {} m rounded to {} m (whole 0.1 mm); {} m become {} m",
                    plainNumber(cell_m), plainNumber(rounded_m), plainNumber(terrain_m), plainNumber(size_m)));
  const Status status = setWorldSize(draft.scene.pack, size_m, size_m);
  if (!status) thesis.wrong("heightmapSize", status.error());
  return {size_m, size_m};
}

WorldSize readWorld(TableReader& world, TableReader& thesis, SceneDraft& draft) {
  if (thesis.has("terrainSize") || thesis.has("heightmapSize")) return readSquareWorld(world, thesis, draft);
  const double cell_m = world.number("cell_m", {0.0001, 100, "m"}, 0.05);
  ScenePack& pack = draft.scene.pack;
  pack.cell_q = toUnits(cell_m);
  const double rounded_m = double(pack.cell_q) / rules::kUnitsPerMetre;
  if (std::abs(rounded_m - cell_m) > 1e-9) {
    draft.scene.notes.push_back(
        fmt::format("world.cell_m: {} m rounded to {} m (whole 0.1 mm)", plainNumber(cell_m), plainNumber(rounded_m)));
  }
  WorldSize size;
  if (world.has("size_m") && world.has("cells")) world.wrong("cells", "give either size_m or cells, not both");
  if (world.has("size_m")) {
    const std::vector<double> metres = world.numbers("size_m", 2, kWorldRange);
    size = {metres[0], metres[1]};
  } else if (world.has("cells")) {
    const std::vector<double> cells = world.numbers("cells", 2, {1, double(kWorldCellsLimit), "cells"});
    for (const double count : cells) {
      if (count != std::floor(count)) world.wrong("cells", "must be whole numbers");
    }
    size = {cells[0] * rounded_m, cells[1] * rounded_m};
  }
  if (size.width_m > 0) {
    const Status status = setWorldSize(pack, size.width_m, size.height_m);
    if (!status) world.wrong(world.has("cells") ? "cells" : "size_m", status.error());
  }
  return size;
}

void readNoise(TableReader& base, const WorldSize& size, TableReader& world, ScenePack& pack) {
  if (size.width_m <= 0) world.wrong("size_m", "missing (size_m or cells; only a DEM brings its own)");
  NoiseBase& noise = pack.noise;
  noise.seed = std::uint64_t(base.integer("seed", {0, 9e18, ""}, std::int64_t(pack.seed)));
  noise.octaves = std::int32_t(base.integer("octaves", {1, 8, ""}, 3));
  noise.lowest_q = toUnits(base.number("lowest_m", kHeightRange, 0));
  noise.highest_q = toUnits(base.number("highest_m", kHeightRange));
  if (noise.highest_q < noise.lowest_q) base.wrong("highest_m", "is below lowest_m");
  const double cell_m = double(pack.cell_q) / rules::kUnitsPerMetre;
  // The finest octave has at most two lattice points per cell.
  const double limit = std::ldexp(1.0, 1 - noise.octaves) / cell_m;
  const double frequency = base.number("frequency_per_m", {1e-7, limit, "per metre"});
  noise.lattice_step_q32 = std::max<std::int64_t>(1, std::llround(frequency * cell_m * 4294967296.0));
}

void readDemBase(TableReader& base, const SceneErrors& errors, WorldSize size, TableReader& world, SceneDraft& draft) {
  DemRequest request;
  request.file = filePath(draft, base.text("file"));
  request.vertical_scale = base.number("vertical_scale", {-1e6, 1e6, ""}, 1);
  if (base.has("nodata"))
    request.nodata =
        base.number("nodata", {-std::numeric_limits<double>::max(), std::numeric_limits<double>::max(), ""});
  if (base.has("sample_m")) request.sample_m = base.number("sample_m", {0.0001, 1e6, "m"});
  if (base.has("lowest_m") != base.has("highest_m"))
    base.wrong(base.has("lowest_m") ? "highest_m" : "lowest_m", "missing; both or none");
  if (base.has("lowest_m")) request.lowest_m = base.number("lowest_m", kHeightRange);
  if (base.has("highest_m")) request.highest_m = base.number("highest_m", kHeightRange);
  const std::vector<double> corner = base.numbers("corner_m", 2, {0, 1e9, "m"});
  request.west_m = corner[0];
  request.south_m = corner[1];
  request.size_x_m = size.width_m;
  request.size_y_m = size.height_m;
  base.finish();
  if (errors.failed()) return;
  Result<Dem> dem = readDem(request, draft.scene.notes);
  if (!dem) return base.wrong("file", dem.error());
  if (size.width_m <= 0) {
    const Status status = setWorldSize(draft.scene.pack, dem->widthM(), dem->heightM());
    if (!status) return world.wrong("cell_m", status.error());
  }
  if (const Status status = setGround(draft.scene.pack, std::move(*dem), request.file, draft.scene.notes); !status) {
    base.wrong("file", status.error());
  }
}

/// Sweeps of drift are split where they are long; says which key asks for too many.
void checkParameters(TableReader& thesis, const Parameters& parameters) {
  if (sweepsOf(parameters) <= kIterationsLimit) return;
  thesis.wrong(
      thesis.has("driftStep") ? "driftStep" : "slopes",
      fmt::format("{} sweeps a tick of {} steps each (so that diffusion * driftStep is 1/8 at most in each) are {}; "
                  "the limit is {}",
                  parameters.sweeps_per_tick, driftSteps(parameters), sweepsOf(parameters), kIterationsLimit));
}

/// Reads all tables; on an error, which SceneErrors holds, the draft is left half made.
void readScene(TableReader& file, const SceneErrors& errors, const std::filesystem::path& path, SceneDraft& draft) {
  readHead(file, path, draft.scene.pack);
  TableReader thesis = file.table("thesis");
  const std::vector<NamedValue> named = readNamedValues(thesis, NamedKeys::all);
  thesis.finish();
  if (errors.failed()) return;
  TableReader world = file.table("world");
  const WorldSize size = readWorld(world, thesis, draft);
  world.finish();
  if (errors.failed()) return;
  TableReader soil = file.table("soil");
  readSoil(soil, thesis, named, draft.scene.pack, draft.scene.notes);
  readMaterialTables(file, soil, thesis, errors, draft);
  if (errors.failed()) return;
  checkParameters(thesis, draft.scene.pack.parameters);
  TableReader base = file.table("base");
  const std::string kind = base.choice("kind", {"noise", "dem"});
  draft.scene.pack.soil_depth_q = toUnits(base.number("soil_depth_m", {0, 20000, "m"}, 1));
  if (errors.failed()) return;
  if (kind == "noise") {
    readNoise(base, size, world, draft.scene.pack);
    base.finish();
  } else {
    readDemBase(base, errors, size, world, draft);
  }
  if (errors.failed()) return;
  readMaterialMap(file, errors, draft);
  readSnowfallTables(file, errors, draft);
  if (errors.failed()) return;
  readMeshTables(file, errors, draft);
  if (errors.failed()) return;
  readPathTables(file, errors, draft);
  readBodyTables(file, draft);
  readVehicleTables(file, draft);
  if (errors.failed()) return;
  readCraterTables(file, errors, draft);
  file.finish();
}

}  // namespace

Result<ImportedScene> importScene(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return Error{path + ": no such file"};
  if (std::filesystem::file_size(path, error) > kSceneFileLimitBytes)
    return Error{path + ": larger than 16 MiB, not a scene"};
  toml::table parsed;
  try {
    parsed = toml::parse_file(path);
  } catch (const toml::parse_error& wrong) {
    return Error{fmt::format("{}:{}: {}", path, std::uint32_t(wrong.source().begin.line), wrong.description())};
  }
  SceneErrors errors(path);
  SceneDraft draft;
  draft.directory = std::filesystem::path(path).parent_path();
  TableReader file(parsed, "", errors);
  readScene(file, errors, path, draft);
  if (errors.failed()) return Error{errors.message()};
  if (const Status status = checkPack(draft.scene.pack); !status) return Error{path + ": " + status.error()};
  return std::move(draft.scene);
}

}  // namespace spoor
