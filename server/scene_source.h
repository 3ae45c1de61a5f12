#pragma once

#include <string>
#include <vector>

#include "server/import/importer.h"
#include "shared/base/options.h"

namespace spoor {

/// Where a session's scene comes from, as the command line says it; the same options in every program that takes them.
struct SceneSource {
  std::string scene;       // a scene TOML or a pack
  TerrainRequest terrain;  // instead of a scene
};
void addSceneOptions(Options& options, SceneSource& source);

/// A scene ready to host: the pack, its canonical bytes and id, and what the importer said.
struct LoadedScene {
  ScenePack pack;
  std::vector<std::uint8_t> encoded;
  PackId id;
  std::vector<std::string> notes;
};

/// Imports a TOML or a terrain, or reads a pack (told by its first bytes). Errors: neither or both given, and all that
/// the importers and decodePack refuse.
Result<LoadedScene> loadScene(const SceneSource& source);

}  // namespace spoor
