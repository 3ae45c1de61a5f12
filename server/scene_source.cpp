#include "server/scene_source.h"

#include <fstream>
#include <iterator>

namespace spoor {
namespace {

LoadedScene encoded(ScenePack pack, std::vector<std::string> notes) {
  LoadedScene loaded{std::move(pack), {}, {}, std::move(notes)};
  loaded.encoded = encodePack(loaded.pack);
  loaded.id = packId(loaded.encoded);
  return loaded;
}

/// The bytes of a file that begins like a pack; nothing for any other file.
Result<std::vector<std::uint8_t>> readPackBytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) return Error{path + ": cannot be opened"};
  const auto size = std::size_t(file.tellg());
  file.seekg(0);
  char magic[4] = {};
  file.read(magic, sizeof magic);
  if (std::string_view(magic, 4) != "SPRP") return std::vector<std::uint8_t>();
  if (size > kPackBytesLimit) return Error{path + ": " + std::to_string(size) + " bytes, over the limit of a pack"};
  file.seekg(0);
  return std::vector<std::uint8_t>{std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

void addSceneOptions(Options& options, SceneSource& source) {
  options.add("scene", "FILE", "scene file (scenes/README.md) or pack", &source.scene);
  options.add("terrain", "FILE", "instead of a scene: a DEM, heights in metres", &source.terrain.terrain);
  options.add("cell", "M", "with --terrain: side of a cell in metres", &source.terrain.cell_m, 0.0001, 100.0);
  options.add("body", "FILE", "with --terrain: mesh of a body to drive over it", &source.terrain.bodies);
  options.add("up", "AXIS", "with --terrain: up axis of the meshes, y or z; none: the format's own",
              &source.terrain.up);
}

Result<LoadedScene> loadScene(const SceneSource& source) {
  if (source.scene.empty() == source.terrain.terrain.empty()) return Error{"give either --scene or --terrain"};
  if (!source.scene.empty() && !source.terrain.bodies.empty())
    return Error{"--body goes with --terrain; a scene names its own"};
  if (source.scene.empty()) {
    auto imported = importTerrain(source.terrain);
    if (!imported) return Error{imported.error()};
    return encoded(std::move(imported->pack), std::move(imported->notes));
  }
  auto bytes = readPackBytes(source.scene);
  if (!bytes) return Error{bytes.error()};
  if (bytes->empty()) {
    auto imported = importScene(source.scene);
    if (!imported) return Error{imported.error()};
    return encoded(std::move(imported->pack), std::move(imported->notes));
  }
  auto pack = decodePack(*bytes);
  if (!pack) return Error{source.scene + ": " + pack.error()};
  return encoded(std::move(*pack), {});
}

}  // namespace spoor
