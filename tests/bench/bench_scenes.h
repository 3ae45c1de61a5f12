#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "shared/world/script.h"
#include "shared/world/state.h"

namespace spoor {

/// A pack, and what happens in it besides its script.
struct BenchScene {
  ScenePack pack;
  PackId id;
  std::int32_t cone_radius_cells = 0;   // > 0: a cone of soil twice as steep as it rests, in the world's middle
  std::int32_t sinking_q_per_tick = 0;  // how far the bodies go down in a tick, 0.1 mm
};

/// Names for makeBenchScene.
std::vector<std::string> benchSceneNames();

/// Scenes made in code, for measuring without files:
///   car491   one body whose search domain is 491 x 491 cells: a plate on four wheels' footprints
///   slab491  the same domain with the whole underside in the soil: the worst case for `nearest`
///   pile     no body; a cone of soil on level ground, 512 cells across, comes to rest
///   small_pile  the same, 128 cells across
///   car      a car of five bodies in 2048 x 2048 cells; car_wide: the same car in 65 536 x 65 536
///   areas1, areas2, areas4, areas8   plates that go down on level ground: makeAreasScene
BenchScene makeBenchScene(const std::string& name);

/// Eight plates in one to eight rows far apart, each row an area, that go down a little in every tick, so that all
/// cells under them penetrate in every tick. Whatever the areas' number they have the same cells together, nearly the
/// same width and border, and lie on the same number of tiles, which their soil does not leave within kAreasTickLimit
/// ticks.
/// @param area_count  1, 2, 4 or 8
BenchScene makeAreasScene(int area_count);
inline constexpr std::int64_t kAreasTickLimit = 60;

/// The set-up of the thesis's measurements: cars of 24 m side by side, 30 m apart, drive over dunes of snow. Each has
/// four wheels' footprints in the soil under a roof that spans the active area that the thesis gives for one car (3774
/// to 241 591 cells on maps of 512 to 4096 cells a side), so that its search domain is that area. They move a cell a
/// tick, for half the map's length, and then rest.
/// @param heightmap_size  cells a side
/// @param terrain_size_m  the same, m
BenchScene makeThesisScene(const std::string& name, int heightmap_size, int terrain_size_m, int car_count,
                           const Parameters& parameters);

/// The thesis's three ways (Table 5.1), with its defaults: jump flooding, no memory of compaction, one round.
Parameters thesisIterative();
Parameters thesisSsbo();
Parameters thesisSsboMultiple();

/// Makes the tiles of a box live and awake, with more soil on each of their cells: added(x, y), 0.1 mm.
void heapSoil(const BaseTerrain& base, const CellBox& box, WorldState& state,
              const std::function<std::int32_t(std::int32_t, std::int32_t)>& added);

/// The scene's state before its first tick. The base is the scene's pack's.
WorldState startOf(const BenchScene& scene, const BaseTerrain& base);

/// Poses of the scene's bodies after `tick` ticks. The script is the scene's pack's.
std::vector<Pose> posesOf(const BenchScene& scene, const Script& script, std::int32_t tick);

}  // namespace spoor
