#include "shared/world/snowfall.h"

#include <algorithm>
#include <array>
#include <string>

#include "shared/base/assert.h"
#include "shared/base/kernels.h"
#include "shared/world/pack.h"

namespace spoor {
namespace {

template <typename SnowfallType, typename Visit>
void visitFields(SnowfallType& snowfall, Visit visit) {
  for (auto* value : {&snowfall.area.x0, &snowfall.area.y0, &snowfall.area.x1, &snowfall.area.y1}) visit(*value);
  visit(snowfall.rate_q32);
  visit(snowfall.first_tick);
  visit(snowfall.last_tick);
  visit(snowfall.seed);
}

/// Ticks of a snowfall that are over at the end of `tick`.
std::int64_t ticksFallen(const Snowfall& snowfall, std::int32_t tick) {
  return std::clamp<std::int64_t>(std::int64_t(tick) - snowfall.first_tick + 1, 0,
                                  std::int64_t(snowfall.last_tick) - snowfall.first_tick + 1);
}

bool meetsTile(const Snowfall& snowfall, TileCoordinate at) {
  const std::int32_t x = at.x * rules::kTileSize, y = at.y * rules::kTileSize;
  return snowfall.area.meets({x, y, x + rules::kTileSize, y + rules::kTileSize});
}

}  // namespace

Status validateSnowfall(const ScenePack& pack, const Snowfall& snowfall) {
  const CellBox& area = snowfall.area;
  if (area.x0 < 0 || area.y0 < 0 || area.x1 > pack.width_cells || area.y1 > pack.height_cells || area.empty())
    return Error{"area: cells " + std::to_string(area.x0) + " .. " + std::to_string(area.x1) + " by " +
                 std::to_string(area.y0) + " .. " + std::to_string(area.y1) + " are not a part of the world of " +
                 std::to_string(pack.width_cells) + " x " + std::to_string(pack.height_cells)};
  if (snowfall.rate_q32 < 1 || snowfall.rate_q32 > kSnowRateLimit)
    return Error{"rate: " + std::to_string(snowfall.rate_q32) + " is not within 1 .. " +
                 std::to_string(kSnowRateLimit)};
  if (snowfall.first_tick < 1 || snowfall.first_tick > snowfall.last_tick || snowfall.last_tick > 1 << 30)
    return Error{"ticks: " + std::to_string(snowfall.first_tick) + " .. " + std::to_string(snowfall.last_tick) +
                 " are not first to last within 1 .. 2^30"};
  const std::int64_t ticks = std::int64_t(snowfall.last_tick) - snowfall.first_tick + 1;
  if (ticks > (std::int64_t(kSnowDepthLimit) << 32) / snowfall.rate_q32)
    return Error{"rate: too much in all; the limit is " + std::to_string(kSnowDepthLimit) + " units of 0.1 mm"};
  return {};
}

Status validateNewSnowfalls(const ScenePack& pack, std::span<const Snowfall> snowfalls, std::int32_t tick,
                            std::size_t known_count) {
  if (known_count + snowfalls.size() > kSnowfallsLimit)
    return Error{std::to_string(known_count + snowfalls.size()) + " snowfalls, the limit is " +
                 std::to_string(kSnowfallsLimit)};
  for (const Snowfall& snowfall : snowfalls) {
    Status status = validateSnowfall(pack, snowfall);
    if (status && snowfall.first_tick < tick)
      status =
          Error{"ticks: it begins at " + std::to_string(snowfall.first_tick) + ", before tick " + std::to_string(tick)};
    if (!status)
      return Error{"snowfall " + std::to_string(known_count + std::size_t(&snowfall - snowfalls.data())) + ": " +
                   status.error()};
  }
  return {};
}

void putSnowfall(ByteWriter& writer, const Snowfall& snowfall) {
  visitFields(snowfall, [&](auto value) { writer.put(value); });
}

Snowfall getSnowfall(ByteReader& reader) {
  Snowfall snowfall;
  visitFields(snowfall, [&](auto& value) { value = reader.get<std::remove_reference_t<decltype(value)>>(); });
  return snowfall;
}

std::int32_t snowBeat(TileCoordinate at, std::int32_t tick) {
  // Neighbours' beats are near each other, so that their ground is nearly level.
  const std::int32_t phase = (at.x + 4 * at.y) & (rules::kSnowBeat - 1);
  return tick - ((tick + phase) & (rules::kSnowBeat - 1));
}

bool snowDue(TileCoordinate at, std::span<const Snowfall> snowfalls, std::int32_t tick) {
  if (snowBeat(at, tick) != tick) return false;
  return std::ranges::any_of(snowfalls, [&](const Snowfall& snowfall) {
    return meetsTile(snowfall, at) && ticksFallen(snowfall, tick) > ticksFallen(snowfall, tick - rules::kSnowBeat);
  });
}

rules::SnowDepth snowDepth(const Snowfall& snowfall, TileCoordinate at, std::int32_t tick) {
  const std::int64_t depth_q32 = ticksFallen(snowfall, snowBeat(at, tick)) * snowfall.rate_q32;
  return {std::int32_t(depth_q32 >> 32), std::uint32_t(depth_q32)};
}

void fillSnow(const ScenePack& pack, std::span<const Snowfall> snowfalls, std::int32_t tick, std::int32_t x,
              std::int32_t y, std::int32_t stride, std::int32_t columns, std::int32_t rows,
              std::span<std::int32_t> depth) {
  SPOOR_ASSERT(depth.size() == std::size_t(columns) * std::size_t(rows));
  std::ranges::fill(depth, 0);
  for (const Snowfall& snowfall : snowfalls) {
    if (ticksFallen(snowfall, tick) == 0) continue;
    const CellBox area{std::max(snowfall.area.x0, 0), std::max(snowfall.area.y0, 0),
                       std::min(snowfall.area.x1, pack.width_cells), std::min(snowfall.area.y1, pack.height_cells)};
    for (std::int32_t row = 0; row < rows; ++row) {
      const std::int64_t cell_y = y + std::int64_t(row) * stride;
      if (cell_y < area.y0 || cell_y >= area.y1) continue;
      // Columns within the area, tile by tile: floor and ceiling of (area.x - x) / stride.
      const std::int64_t first = area.x0 <= x ? 0 : (std::int64_t(area.x0) - x + stride - 1) / stride;
      const std::int64_t end =
          std::min<std::int64_t>(columns, area.x1 <= x ? 0 : (std::int64_t(area.x1) - x + stride - 1) / stride);
      for (std::int64_t column = first; column < end;) {
        const auto cell_x = std::int32_t(x + column * stride);
        const TileCoordinate at{cell_x / rules::kTileSize, std::int32_t(cell_y / rules::kTileSize)};
        const std::int64_t in_tile = ((at.x + 1) * std::int64_t(rules::kTileSize) - cell_x + stride - 1) / stride;
        const std::int64_t count = std::min(in_tile, end - column);
        kernels().snowRow(snowfall.seed, cell_x, stride, std::int32_t(cell_y), int(count),
                          snowDepth(snowfall, at, tick),
                          depth.data() + std::size_t(row) * std::size_t(columns) + std::size_t(column));
        column += count;
      }
    }
  }
}

std::int64_t addSnow(const ScenePack& pack, TileCoordinate at, std::span<const Snowfall> snowfalls, std::int32_t tick,
                     std::span<std::int32_t, rules::kTileCells> height) {
  std::array<std::int32_t, rules::kTileCells> before, after;
  const auto fill = [&](std::int32_t when, std::span<std::int32_t> depth) {
    fillSnow(pack, snowfalls, when, at.x * rules::kTileSize, at.y * rules::kTileSize, 1, rules::kTileSize,
             rules::kTileSize, depth);
  };
  fill(tick - rules::kSnowBeat, before);
  fill(tick, after);
  std::int64_t gained = 0;
  for (std::size_t i = 0; i < height.size(); ++i) {
    const std::int32_t ground = rules::snowGround(height[i], after[i] - before[i]);
    gained += ground - height[i];
    height[i] = ground;
  }
  return gained;
}

}  // namespace spoor
