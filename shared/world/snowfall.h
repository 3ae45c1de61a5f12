#pragma once

#include <cstdint>
#include <span>

#include "shaders/rules/snowfall.h"
#include "shared/base/bytes.h"
#include "shared/base/result.h"
#include "shared/world/cell_box.h"

namespace spoor {

struct ScenePack;

/// Soil that falls on an area, tick after tick: a record with a closed form in time (rules/snowfall.h). It falls on
/// bodies' tracks and beneath bodies alike.
///
/// A tile takes what fell at its own beat only, every kSnowBeat ticks, so that a tick visits few of the tiles at rest.
struct Snowfall {
  CellBox area;
  std::int64_t rate_q32 = 0;    // 0.1 mm per tick * 2^32, 1 .. kSnowRateLimit
  std::int32_t first_tick = 0;  // the first and the last tick in which it falls, 1 <= first <= last
  std::int32_t last_tick = 0;
  std::uint32_t seed = 0;
  bool operator==(const Snowfall&) const = default;
};

inline constexpr std::size_t kSnowfallsLimit = 64;                     // of a session
inline constexpr std::int64_t kSnowRateLimit = std::int64_t(1) << 44;  // 0.4 m a tick
inline constexpr std::int32_t kSnowDepthLimit = 1 << 23;               // 0.1 mm, of one snowfall: 839 m
inline constexpr std::size_t kSnowfallBytes = 4 * 4 + 8 + 3 * 4;

/// Checks all ranges, and that it snows within the world. The error names the field.
[[nodiscard]] Status validateSnowfall(const ScenePack& pack, const Snowfall& snowfall);

/// Checks snowfalls that come with tick `tick`: also that they do not begin before it, and that there are not too many
/// with those that are there already. The error names the snowfall.
[[nodiscard]] Status validateNewSnowfalls(const ScenePack& pack, std::span<const Snowfall> snowfalls, std::int32_t tick,
                                          std::size_t known_count);

/// Canonical bytes, kSnowfallBytes of them; values are not checked by the reader.
void putSnowfall(ByteWriter& writer, const Snowfall& snowfall);
Snowfall getSnowfall(ByteReader& reader);

/// The last tick up to `tick` at which a tile took what had fallen; less than 1 before its first.
std::int32_t snowBeat(TileCoordinate at, std::int32_t tick);

/// Does a tile take snow in a tick? Only at its beats, and where a snowfall meets it whose snow it has not all.
bool snowDue(TileCoordinate at, std::span<const Snowfall> snowfalls, std::int32_t tick);

/// How much of a snowfall a tile has by a tick, as rules/snowfall.h takes it.
rules::SnowDepth snowDepth(const Snowfall& snowfall, TileCoordinate at, std::int32_t tick);

/// What lies on cells by a tick, 0.1 mm, `stride` cells apart from (x, y) on; 0 outside the world.
/// @param depth  out, row-major [rows * columns]
void fillSnow(const ScenePack& pack, std::span<const Snowfall> snowfalls, std::int32_t tick, std::int32_t x,
              std::int32_t y, std::int32_t stride, std::int32_t columns, std::int32_t rows,
              std::span<std::int32_t> depth);

/// Adds to a tile's heights what it takes in tick `tick` (snowDue). Nothing rises above the height limit.
/// Returns what the cells gained, 0.1 mm * cells.
std::int64_t addSnow(const ScenePack& pack, TileCoordinate at, std::span<const std::int32_t, rules::kTileCells> bedrock,
                     std::span<const Snowfall> snowfalls, std::int32_t tick,
                     std::span<std::int32_t, rules::kTileCells> height);

}  // namespace spoor
