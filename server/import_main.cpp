// spoor-import: scene, DEM and meshes -> scene pack.
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "server/scene_source.h"
#include "server/snowfall_text.h"

namespace {

using namespace spoor;

/// Writes a file whole or not at all: beside its place first, then renamed.
Status writeWhole(const std::string& path, const std::vector<std::uint8_t>& bytes) {
  const std::string part = path + ".part" + std::to_string(::getpid());
  std::FILE* file = std::fopen(part.c_str(), "wb");
  if (!file) return Error{path + ": cannot be written: " + std::strerror(errno)};
  bool written = std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
  written = std::fflush(file) == 0 && written;
  written = ::fsync(::fileno(file)) == 0 && written;
  written = std::fclose(file) == 0 && written;
  std::error_code error;
  if (written) std::filesystem::rename(part, path, error);
  if (written && !error) return {};
  const std::string why = written ? error.message() : "disk full or gone";
  std::filesystem::remove(part, error);
  return Error{path + ": cannot be written: " + why};
}

int refuse(const char* why) {
  std::fprintf(stderr, "spoor-import: %s (see --help)\n", why);
  return 2;
}

int fail(const std::string& why) {
  std::fprintf(stderr, "spoor-import: %s\n", why.c_str());
  return 1;
}

void report(const LoadedScene& scene, const std::string& out) {
  const ScenePack& pack = scene.pack;
  for (const std::string& note : scene.notes) std::printf("note: %s\n", note.c_str());
  std::printf("scene  %s: %zu meshes, %zu paths, %zu bodies, %d ticks at %d Hz\n", pack.name.c_str(),
              pack.meshes.size(), pack.paths.size(), pack.bodies.size(), pack.default_ticks, pack.ticks_per_second);
  std::printf("world  %d x %d cells of %g m: %.1f x %.1f m\n", pack.width_cells, pack.height_cells, pack.cell_q / 1e4,
              pack.width_cells * (pack.cell_q / 1e4), pack.height_cells * (pack.cell_q / 1e4));
  if (pack.crater_limits.radius_q > 0)
    std::printf("craters %zu timed, the largest allowed has R3 %g m\n", pack.craters.size(),
                pack.crater_limits.radius_q / 1e4);
  std::string names;
  for (const Material& material : pack.materials) names += (names.empty() ? "" : ", ") + material.name;
  constexpr const char* kMaps[] = {"everywhere", "by an image", "by rules over height and slope"};
  std::printf("soil   %s, %s\n", names.c_str(),
              pack.materials.size() > 1 ? kMaps[int(pack.material_map.kind)] : kMaps[0]);
  for (const Snowfall& snowfall : pack.snowfalls) std::printf("snow   %s\n", describeSnowfall(pack, snowfall).c_str());
  std::printf("pack   %s: %zu bytes, id %s\n", out.c_str(), scene.encoded.size(), toText(scene.id).c_str());
}

}  // namespace

int main(int argc, char** argv) {
  std::string out;
  SceneSource source;
  Options options("spoor-import", "compiles a scene, or a DEM with bodies to drive over it, to a scene pack");
  addSceneOptions(options, source);
  options.add("ticks", "N", "with --terrain: length of a session in ticks", &source.terrain.ticks, 1, 1'000'000'000);
  options.add("out", "FILE", "pack to write", &out);
  options.parseOrExit(argc, argv);
  if (out.empty()) return refuse("--out is missing");

  const Result<LoadedScene> scene = loadScene(source);
  if (!scene) return fail(scene.error());
  if (const Status status = writeWhole(out, scene->encoded); !status) return fail(status.error());
  report(*scene, out);
  return 0;
}
