#include "shared/world/crater.h"

#include <algorithm>
#include <string>

#include "shaders/rules/crater_hash.h"
#include "shared/base/fixed.h"
#include "shared/world/pack.h"

namespace spoor {
namespace {

std::string metres(std::int64_t value_q) { return metresText(value_q) + " m"; }

}  // namespace

Status validateCraterLimits(const CraterLimits& limits) {
  const auto outside = [](const char* name, std::int64_t value, std::int64_t low, std::int64_t high) {
    return Error{std::string(name) + " " + std::to_string(value) + ": want " + std::to_string(low) + " .. " +
                 std::to_string(high)};
  };
  constexpr std::int32_t reach = rules::kCraterReachLimit;
  if (limits.radius_q < 0 || limits.radius_q > reach) return outside("craters.radius_q", limits.radius_q, 0, reach);
  // A crater is then in at most 34 x 34 of them.
  const std::int32_t least = std::max(1, (limits.radius_q + 15) / 16);
  constexpr std::int32_t most = 1 << 30;
  if (limits.hash_cell_q < least || limits.hash_cell_q > most)
    return outside("craters.hash_cell_q", limits.hash_cell_q, least, most);
  if (limits.request_radius_q < 0 || limits.request_radius_q > limits.radius_q)
    return outside("craters.request_radius_q", limits.request_radius_q, 0, limits.radius_q);
  if (limits.request_height_q < 0 || limits.request_height_q > rules::kCraterHeightLimit)
    return outside("craters.request_height_q", limits.request_height_q, 0, rules::kCraterHeightLimit);
  if (limits.request_distance_q < 0)
    return outside("craters.request_distance_q", limits.request_distance_q, 0, INT32_MAX);
  if (limits.requests_per_minute < 0 || limits.requests_per_minute > 60000)
    return outside("craters.requests_per_minute", limits.requests_per_minute, 0, 60000);
  return {};
}

Status validateCrater(const ScenePack& pack, const Crater& crater) {
  if (pack.crater_limits.radius_q == 0) return Error{"crater: this scene has none"};
  if (crater.crest_radius_q < 1) return Error{"crater: R2 is " + metres(crater.crest_radius_q) + ", not above 0"};
  if (crater.inner_radius_q < 0) return Error{"crater: R1 is " + metres(crater.inner_radius_q) + ", below 0"};
  if (crater.inner_radius_q > crater.crest_radius_q)
    return Error{"crater: R1 " + metres(crater.inner_radius_q) + " is more than R2 " + metres(crater.crest_radius_q)};
  if (crater.outerRadius() > pack.crater_limits.radius_q)
    return Error{"crater: R3 = 2 R2 - R1 is " + metres(crater.outerRadius()) + ", the scene allows " +
                 metres(pack.crater_limits.radius_q)};
  const auto inRange = [](std::int32_t v) { return v >= 0 && v <= rules::kCraterHeightLimit; };
  if (!inRange(crater.rim_height_q) || !inRange(crater.depth_q))
    return Error{std::string("crater: ") + (inRange(crater.depth_q) ? "H4" : "D5") + " is " +
                 metres(inRange(crater.depth_q) ? crater.rim_height_q : crater.depth_q) + ", want 0 .. " +
                 metres(rules::kCraterHeightLimit)};
  const std::int64_t outer = crater.outerRadius();
  const auto misses = [&](std::int64_t at, std::int64_t cells) {
    return at + outer < 0 || at - outer >= cells * pack.cell_q;
  };
  if (misses(crater.x_q, pack.width_cells) || misses(crater.y_q, pack.height_cells))
    return Error{"crater: all of it lies off the map (centre " + metres(crater.x_q) + ", " + metres(crater.y_q) +
                 ", R3 " + metres(outer) + ")"};
  return {};
}

Status validateNewCraters(const ScenePack& pack, std::span<const Crater> craters, std::size_t before,
                          std::int64_t hash_cells_before) {
  if (craters.size() > kTickCratersLimit)
    return Error{std::to_string(craters.size()) + " craters in one tick, the limit is " +
                 std::to_string(kTickCratersLimit)};
  if (craters.size() > kCratersLimit - std::min(before, kCratersLimit))
    return Error{"craters: " + std::to_string(before) + " and " + std::to_string(craters.size()) +
                 " more, the limit of a session is " + std::to_string(kCratersLimit)};
  std::int64_t hash_cells = hash_cells_before;
  for (const Crater& crater : craters) {
    if (Status status = validateCrater(pack, crater); !status) return status;
    hash_cells += hashCellsOf(pack, crater);
  }
  if (hash_cells > kCraterHashCellsLimit)
    return Error{"craters: they would be in " + std::to_string(hash_cells) + " cells of " +
                 metres(pack.crater_limits.hash_cell_q) + ", the limit of a session is " +
                 std::to_string(kCraterHashCellsLimit) + "; larger cells help"};
  return {};
}

std::int64_t hashCellsOf(const ScenePack& pack, const Crater& crater) {
  const auto outer = std::int32_t(crater.outerRadius());
  const auto count = [&](std::int32_t centre, std::int32_t cells) {
    const std::int32_t side = pack.crater_limits.hash_cell_q;
    return std::int64_t(rules::craterLastCell(centre, outer, side, cells * pack.cell_q)) -
           rules::craterFirstCell(centre, outer, side) + 1;
  };
  return std::max<std::int64_t>(count(crater.x_q, pack.width_cells), 0) *
         std::max<std::int64_t>(count(crater.y_q, pack.height_cells), 0);
}

std::string metresText(std::int64_t value_q) {
  std::string text = std::to_string(double(value_q) / rules::kUnitsPerMetre);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

void putCrater(ByteWriter& writer, const Crater& crater) {
  for (const std::int32_t value :
       {crater.x_q, crater.y_q, crater.inner_radius_q, crater.crest_radius_q, crater.rim_height_q, crater.depth_q})
    writer.put(value);
  writer.put(crater.noise_seed);
  writer.put(crater.noise_q16);
  writer.put(crater.tick);
  writer.put(crater.id);
}

Crater getCrater(ByteReader& reader) {
  Crater crater;
  for (std::int32_t* value : {&crater.x_q, &crater.y_q, &crater.inner_radius_q, &crater.crest_radius_q,
                              &crater.rim_height_q, &crater.depth_q})
    *value = reader.get<std::int32_t>();
  crater.noise_seed = reader.get<std::uint16_t>();
  crater.noise_q16 = reader.get<std::uint16_t>();
  crater.tick = reader.get<std::int32_t>();
  crater.id = reader.get<std::uint32_t>();
  return crater;
}

rules::CraterShape shapeOf(const Crater& crater) {
  return rules::craterShape(crater.x_q, crater.y_q, crater.inner_radius_q, crater.crest_radius_q, crater.rim_height_q,
                            crater.depth_q, crater.noise_seed, crater.noise_q16, int(crater.id));
}

CellBox craterBox(std::int32_t cell_q, std::int32_t width_cells, std::int32_t height_cells, const Crater& crater) {
  const auto cellOf = [&](std::int64_t at_q, std::int32_t cells) {
    return std::int32_t(std::clamp<std::int64_t>(floorDiv(at_q, cell_q), 0, cells));
  };
  const std::int64_t outer = crater.outerRadius();
  return {cellOf(crater.x_q - outer, width_cells), cellOf(crater.y_q - outer, height_cells),
          cellOf(crater.x_q + outer + cell_q, width_cells), cellOf(crater.y_q + outer + cell_q, height_cells)};
}

CellBox craterBox(const ScenePack& pack, const Crater& crater) {
  return craterBox(pack.cell_q, pack.width_cells, pack.height_cells, crater);
}

std::int32_t balancedRimHeight(std::int32_t inner_radius_q, std::int32_t crest_radius_q, std::int32_t depth_q) {
  // In shares of R2^2, Q30: 0.35 + band * ((2 - 3 pi / 8) + 0.35 band) with band = m / R2.
  constexpr std::int64_t kOne = std::int64_t(1) << 30;
  constexpr std::int64_t kSmooth = 375809638;  // 0.35
  constexpr std::int64_t kRound = 882511363;   // 2 - 3 pi / 8
  const std::int64_t band = (std::int64_t(crest_radius_q - inner_radius_q) << 30) / crest_radius_q;
  const std::int64_t whole = kSmooth + band * (kRound + kSmooth * band / kOne) / kOne;
  constexpr std::int64_t kCavity = 161061274;  // 0.15
  return std::int32_t((depth_q * kCavity + whole / 2) / whole);
}

}  // namespace spoor
