#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "shared/base/result.h"
#include "shared/world/crater.h"
#include "shared/world/material.h"
#include "shared/world/parameters.h"
#include "shared/world/pose.h"
#include "shared/world/snowfall.h"

namespace spoor {

/// 128-bit id of a pack: a hash of its canonical bytes. Not a signature: it finds differences, not forgers.
struct PackId {
  std::uint64_t low = 0;
  std::uint64_t high = 0;
  bool operator==(const PackId&) const = default;
};
std::string toText(const PackId& id);

/// Ground made by integer gradient noise between two heights.
struct NoiseBase {
  std::uint64_t seed = 0;
  std::int64_t lattice_step_q32 = 0;  // lattice units per cell * 2^32, 1 .. 2^(33 - octaves)
  std::int32_t octaves = 1;           // 1..8; each halves the period and the height
  std::int32_t lowest_q = 0;          // 0.1 mm
  std::int32_t highest_q = 0;         // 0.1 mm, >= lowest_q
  bool operator==(const NoiseBase&) const = default;
};

/// Ground interpolated from samples on a regular grid, first row at y = 0 (south), first column at x = 0 (west).
struct SampleBase {
  std::int32_t column_count = 0;
  std::int32_t row_count = 0;
  std::int64_t step_x_q32 = 0;  // samples per cell * 2^32, along x and along y; 1 .. 2^38
  std::int64_t step_y_q32 = 0;
  std::vector<std::int32_t> height_q;  // [row_count * column_count], 0.1 mm
  bool operator==(const SampleBase&) const = default;
};

enum class BaseKind : std::uint8_t { noise = 0, samples = 1 };

/// A triangle mesh in its own frame: x forward, y left, z up, 0.1 mm units.
struct Mesh {
  std::string name;
  std::vector<std::array<std::int32_t, 3>> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::array<std::uint32_t, 2>> edges;  // each undirected edge of the triangles once, sorted
};

/// A point of a path, 0.1 mm units from the south-west corner of the world.
struct Waypoint {
  std::int32_t x_q = 0;
  std::int32_t y_q = 0;
};

/// Where scripted bodies go: waypoints at a constant speed from `first_tick`, resting at the last (or starting over).
struct Path {
  std::vector<Waypoint> waypoints;    // at least 1
  std::int32_t speed_q_per_tick = 0;  // 0.1 mm per tick, >= 0
  std::int32_t first_tick = 0;
  std::uint8_t closed = 0;  // 1: from the last waypoint back to the first, for ever
};

/// One rigid mesh on a path: a wheel, a chassis, a boot.
struct Body {
  std::string name;
  std::int32_t mesh_index = 0;
  std::int32_t path_index = 0;
  std::array<std::int32_t, 3> offset_q{};  // from the path's point, in its heading frame: forward, left, up
  std::int32_t sinkage_q = 0;              // how far the mesh's lowest point lies below the base, before offset_q[2]
  std::int32_t roll_radius_q = 0;          // > 0: a wheel that spins by distance / radius
  std::int32_t stride_q = 0;               // > 0: a foot: lifted for half of each stride of this length
  std::int32_t lift_q = 0;                 // how high the foot is lifted
  std::int32_t phase_q = 0;                // where in its stride the foot starts
  std::uint8_t follows_slope = 0;          // 1: pitch and roll with the base under its box
  std::int32_t force_n = 0;  // newtons with which it pushes soil the way it moves, for drift, 0 .. kForceLimit
  // Its size, a share of the mesh's: the first up to one tick, evenly to the last at another.
  std::int32_t first_scale_q16 = kFullScale, last_scale_q16 = kFullScale;  // 1 .. kFullScale
  std::int32_t first_scale_tick = 0, last_scale_tick = 0;                  // first <= last
};

inline constexpr std::int32_t kForceLimit = 1 << 26;

/// Everything that steers a session besides its inputs, in integers. See pack.cpp for the canonical bytes.
struct ScenePack {
  std::string name;
  std::uint64_t seed = 0;
  std::int32_t width_cells = 0;  // 1 .. kWorldCellsLimit
  std::int32_t height_cells = 0;
  std::int32_t cell_q = 0;  // side of a cell, 0.1 mm, 1 .. 10^6; width_cells * cell_q < 2^31
  std::int32_t ticks_per_second = 60;
  std::int32_t default_ticks = 600;     // length of a session when nobody says otherwise
  std::int32_t soil_depth_q = 0;        // soil over bedrock, 0.1 mm, >= 0
  std::int32_t patches_per_row = 0;     // of the terrain as it is drawn, 0..4096; 0: as the client likes
                                        // [numVerticesPerRow]
  std::int32_t normal_blur_passes = 0;  // 0..16, of the 3 x 3 Gaussian over drawn normals [numIterationsBlurNormals]
  Parameters parameters;                // at first; a session may change them
  std::vector<Material> materials = {{"soil", {236, 240, 245}, MaterialTexture::snow}};  // 1 .. kMaterialsLimit
  MaterialMap material_map;
  BaseKind base_kind = BaseKind::noise;
  NoiseBase noise;     // where base_kind is noise, else as made
  SampleBase samples;  // where base_kind is samples, else as made
  std::vector<Mesh> meshes;
  std::vector<Path> paths;
  std::vector<Body> bodies;
  CraterLimits crater_limits;
  std::vector<Crater> craters;      // that the scene times itself: by tick, ids from 0 on
  std::vector<Snowfall> snowfalls;  // there from before the first tick
};

inline constexpr std::int32_t kWorldCellsLimit = 1 << 24;
// What a world without active areas may measure.
inline constexpr std::int32_t kWholeWorldSideLimit = 1 << 14;
inline constexpr std::int64_t kWholeWorldCellsLimit = 1 << 24;
inline constexpr std::size_t kPackBytesLimit = std::size_t(256) << 20;

/// Checks every value's range and every index. The error names the field.
[[nodiscard]] Status validatePack(const ScenePack& pack);

/// Checks parameters for a session of this pack: every value's range, that they are of its materials, and that a world
/// without active areas is small enough. The error names the field.
[[nodiscard]] Status validateParameters(const ScenePack& pack, const Parameters& parameters);

/// The canonical bytes. The pack must be valid (asserted).
std::vector<std::uint8_t> encodePack(const ScenePack& pack);

/// Safe on untrusted bytes: wrong magic, version, truncation, trailing bytes and every invalid value are errors.
Result<ScenePack> decodePack(std::span<const std::uint8_t> bytes);

/// Id of encoded bytes.
PackId packId(std::span<const std::uint8_t> encoded);

/// Fills `edges` from `triangles`.
void deriveEdges(Mesh& mesh);

}  // namespace spoor
