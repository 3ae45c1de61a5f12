#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "shared/base/result.h"
#include "shared/world/pack.h"

namespace spoor {

/// A scene compiled to integers, and what the importer changed on the way: one line each (nodata filled, degrees to
/// metres, values rounded to what the pack can say, triangles dropped, ...).
struct ImportedScene {
  ScenePack pack;
  std::vector<std::string> notes;
};

/// Compiles a scene file (TOML; its keys, units, ranges and defaults are in scenes/README.md) with the DEM and the
/// meshes that it names. Files are looked up from the scene's directory.
/// Errors, in one line: file and line of the scene, the key, and why.
Result<ImportedScene> importScene(const std::string& path);

/// A scene without a scene file: a DEM, and bodies that drive over its middle.
struct TerrainRequest {
  std::string terrain;              // any raster GDAL reads; its heights in metres
  double cell_m = 0.05;             // 0.0001 .. 100
  std::vector<std::string> bodies;  // mesh files, side by side in this order, from right to left
  std::string up;                   // which axis of the meshes is up: "y" or "z"; empty: the format's (see MeshRequest)
  std::int64_t ticks = 600;         // 1 .. 10^9
};

/// The world spans the whole DEM, however large; the pack keeps only the DEM's samples. Each body follows one gentle
/// S curve about the middle of the world, 60 m long or as long as fits, at 5 m/s, pressed 0.1 m into 1 m of soil.
Result<ImportedScene> importTerrain(const TerrainRequest& request);

}  // namespace spoor
