#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "server/import/importer.h"
#include "server/import/table_reader.h"

namespace spoor {

/// A scene file on its way to a pack.
struct SceneDraft {
  std::filesystem::path directory;  // files are looked up from here
  ImportedScene scene;
  std::map<std::string, std::int32_t> meshes;  // index by name
  std::map<std::string, std::int32_t> paths;
};

// Each reads one kind of table of the file into the draft; what is wrong goes to the reader's SceneErrors. In this
// order: meshes need the cell size, paths the size of the world, bodies and vehicles the meshes and paths.
void readMeshTables(TableReader& file, const SceneErrors& errors, SceneDraft& draft);
void readPathTables(TableReader& file, const SceneErrors& errors, SceneDraft& draft);
void readBodyTables(TableReader& file, SceneDraft& draft);
void readVehicleTables(TableReader& file, SceneDraft& draft);
/// [craters] and every [[crater]] (crater_tables.cpp); after the size of the world.
void readCraterTables(TableReader& file, const SceneErrors& errors, SceneDraft& draft);

/// Every [[material]], if any, instead of the one of [soil] (material_tables.cpp); after the cell size and readSoil.
void readMaterialTables(TableReader& file, TableReader& soil, TableReader& thesis, const SceneErrors& errors,
                        SceneDraft& draft);
/// [materials]: which of them lies where (material_map.cpp); after the size of the world.
void readMaterialMap(TableReader& file, const SceneErrors& errors, SceneDraft& draft);
/// Every [[snowfall]] (snowfall_tables.cpp); after the size of the world.
void readSnowfallTables(TableReader& file, const SceneErrors& errors, SceneDraft& draft);

/// "#rrggbb"; nothing where it is another text.
std::optional<std::array<std::uint8_t, 3>> parseColour(std::string_view text);

/// A file named in a scene, from the scene's directory.
std::string filePath(const SceneDraft& draft, const std::string& named);

}  // namespace spoor
