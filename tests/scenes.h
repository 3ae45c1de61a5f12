#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "shared/sim/simulation.h"
#include "tests/backends.h"
#include "tests/oracle.h"

namespace spoor::test {

/// Level ground: `width` x `height` cells of 1000 units, the surface at height 0, soil so deep that bedrock is far
/// away.
ScenePack flatPack(int width, int height);

/// Ground with the given heights, row by row from the south; soil of `soil_depth` under them.
ScenePack groundPack(int width, int height, const std::vector<std::int32_t>& heights, int soil_depth);

/// Rolling ground between two heights (of the surface).
ScenePack noisePack(int width, int height, std::uint64_t seed, int lowest, int highest, int soil_depth);

// Meshes, 0.1 mm, their lowest point at z = 0 and their origin in the middle.
Mesh boxMesh(int length, int width, int height);
Mesh wedgeMesh(int length, int width, int height);  // its edge points down, across its direction
Mesh tetrahedronMesh(int size);                     // its tip points down
Mesh archMesh(int length, int width, int height);   // two legs with a gap between them: not convex
Mesh bladeMesh(int length, int height);             // a vertical sheet without any thickness

/// Adds a body whose path begins, and stays, at a point (0.1 mm). Returns its index.
int addBody(ScenePack& pack, Mesh mesh, int x_q, int y_q, int sinkage_q);

/// What a body's pose is at the start of a session, moved and turned.
Pose moved(Pose pose, int dx_q, int dy_q, int dz_q = 0, int turn = 0);

/// A pack with everything that is made from it. Checks that the pack is valid.
class World {
 public:
  explicit World(ScenePack pack);
  World(const World&) = delete;

  ScenePack pack;
  BaseTerrain base{pack};
  PackId id;
  Simulation simulate(const NativeOptions& options = {.thread_count = 1}) const;
  Simulation simulateOn(const BackendCase& backend_case) const;
};

/// Parameters of a seed: every method, and numbers at and between the ends of what makes a difference.
Parameters randomParameters(std::uint32_t seed, int material_count = 1);

/// Gives a pack several materials, mapped by an image or by rules over its base. Its parameters must be of as many.
void addMaterials(ScenePack& pack, int count, std::uint32_t seed);

/// All of them, in words and numbers.
std::string describe(const Parameters& parameters);

/// A crater about as large as `reach_q`, or much smaller, anywhere on a map or over its border. Valid where the pack
/// allows an R3 of `reach_q`.
Crater randomCrater(const ScenePack& pack, std::uint32_t seed, int reach_q);

/// A small world of a seed: its size is a multiple of nothing, its ground, parameters and bodies are anything, and the
/// bodies wander, turn, rise, fall, shrink and grow, some faster than a cell a tick, some out of the world. In most of
/// them craters appear: small and large, alone and many in a tick, some twice, some over the border, some under bodies.
/// Every other one has several materials, and in most of them it snows.
struct RandomWorld {
  ScenePack pack;
  std::vector<std::vector<Pose>> ticks;  // poses of every tick
  std::size_t change = SIZE_MAX;         // index of the tick from which on `changed` holds
  Parameters changed;

  std::vector<std::vector<Crater>> craters;      // of every tick
  std::vector<std::vector<Snowfall>> snowfalls;  // the same; the pack may have some too

  /// What a tick is given besides its poses.
  std::optional<Parameters> changeAt(std::size_t tick) const {
    return tick == change ? std::optional(changed) : std::nullopt;
  }
  const std::vector<Crater>& cratersAt(std::size_t tick) const { return craters[tick]; }
  const std::vector<Snowfall>& snowfallsAt(std::size_t tick) const { return snowfalls[tick]; }

  std::string description;
};
RandomWorld randomWorld(std::uint32_t seed, int tick_count);

/// Are all live tiles, wake masks, the ledger and the state hash the same? The message names the first difference.
::testing::AssertionResult sameState(const WorldState& state, const Oracle& oracle);

/// The highest difference over what rests, between inside neighbours of live tiles that are both live (0: all rest).
std::int64_t steepestExcess(const ScenePack& pack, const TileStore& tiles);

/// What a tile would be with other heights, for differenceOf.
TilePlanes planesWith(const Tile& tile, const PlaneCells& height);

/// Height of a cell of a live tile.
std::int32_t heightOf(const WorldState& state, int x, int y);

}  // namespace spoor::test
