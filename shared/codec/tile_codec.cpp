#include "shared/codec/tile_codec.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>

#include "shared/base/bytes.h"
#include "shared/base/json.h"
#include "shared/base/kernels.h"
#include "shared/world/tile_snow.h"

namespace spoor {
namespace {

constexpr std::size_t kEntryBytes = 4 * 4 + 2 + 8 + 1 + 4 + kPlaneCount;

std::string nameOf(TileCoordinate at) { return "tile (" + std::to_string(at.x) + ", " + std::to_string(at.y) + ")"; }

std::uint32_t zigzag(std::int32_t v) { return (std::uint32_t(v) << 1) ^ std::uint32_t(v >> 31); }
std::int32_t unzigzag(std::uint32_t v) { return std::int32_t((v >> 1) ^ (0u - (v & 1u))); }

/// The differences of a plane.
std::vector<std::int32_t>& planeOf(TileChange& change, int plane) {
  return plane == int(Plane::height)      ? change.difference
         : plane == int(Plane::compacted) ? change.compaction
                                          : change.material;
}
const std::vector<std::int32_t>& planeOf(const TileChange& change, int plane) {
  return planeOf(const_cast<TileChange&>(change), plane);
}

/// Bytes that the largest zigzag difference needs, 0 where all are 0.
std::uint8_t byteCount(const std::vector<std::int32_t>& difference) {
  std::uint32_t all = 0;
  for (const std::int32_t d : difference) all |= zigzag(d);
  return std::uint8_t(all == 0 ? 0 : all < 0x100 ? 1 : all < 0x10000 ? 2 : all < 0x1000000 ? 3 : 4);
}

/// Bytes per difference in each plane.
using ByteCounts = std::array<std::uint8_t, kPlaneCount>;

struct Entry {
  TileChange change;
  std::uint8_t planes = 0;  // bit i: plane i differs somewhere
  ByteCounts byte_counts{};
};

/// Checks one entry's header; the difference is not read yet.
Status checkEntry(const Entry& entry, TileCoordinate extent) {
  const TileChange& change = entry.change;
  const auto wrong = [&](const char* why) { return Error{nameOf(change.at) + ": " + why}; };
  if (change.at.x < 0 || change.at.y < 0 || change.at.x >= extent.x || change.at.y >= extent.y)
    return wrong("lies outside the world");
  if (change.base_version < kDormantVersion || change.new_version < change.base_version || change.new_version < 0)
    return wrong("versions run backwards");
  if (change.wake_mask >= kWakeMaskLimit || (change.wake_mask != 0 && (change.wake_mask & kWakeSelf) == 0))
    return wrong("wake mask is none that a tick makes");
  if (entry.planes >> kPlaneCount != 0) return wrong("names a plane that this version does not know");
  if ((entry.planes != 0) != (change.width > 0) || (change.width > 0) != (change.height > 0))
    return wrong("box and planes disagree");
  for (int plane = 0; plane < kPlaneCount; ++plane)
    if ((entry.planes >> plane & 1) != (entry.byte_counts[plane] > 0 ? 1 : 0) || entry.byte_counts[plane] > 4)
      return wrong("planes and bytes disagree");
  if (change.x + change.width > rules::kTileSize || change.y + change.height > rules::kTileSize)
    return wrong("box leaves the tile");
  return {};
}

}  // namespace

TilePlanes planesOf(const Tile& tile) {
  TilePlanes planes;
  for (int plane = 0; plane < kPlaneCount; ++plane) planes[plane] = tile.planes[plane].get();
  return planes;
}

TileChange differenceOf(const Tile& tile, const TilePlanes& before, std::int32_t base_version) {
  constexpr int size = rules::kTileSize;
  static const PlaneCells none{};
  TilePlanes after = planesOf(tile), old = before;
  for (TilePlanes* planes : {&after, &old})
    for (const PlaneCells*& plane : *planes)
      if (plane == nullptr) plane = &none;
  int x_first = size, x_last = -1, y_first = size, y_last = -1;
  bool differs[kPlaneCount] = {};
  for (int plane = 0; plane < kPlaneCount; ++plane) {
    if (after[plane] == old[plane]) continue;
    for (int y = 0; y < size; ++y) {
      const std::int32_t* a = after[plane]->data() + y * size;
      const std::int32_t* b = old[plane]->data() + y * size;
      if (std::memcmp(a, b, size * sizeof(*a)) == 0) continue;
      int first = 0, last = size - 1;
      while (a[first] == b[first]) ++first;
      while (a[last] == b[last]) --last;
      x_first = std::min(x_first, first);
      x_last = std::max(x_last, last);
      y_first = std::min(y_first, y);
      y_last = std::max(y_last, y);
      differs[plane] = true;
    }
  }
  TileChange change{tile.at, base_version, tile.version_tick, tile.wake_mask, tile.hash, 0, 0, 0, 0, {}, {}, {}};
  if (x_last < 0) return change;
  change.x = std::uint8_t(x_first);
  change.y = std::uint8_t(y_first);
  change.width = std::uint8_t(x_last - x_first + 1);
  change.height = std::uint8_t(y_last - y_first + 1);
  for (int plane = 0; plane < kPlaneCount; ++plane) {
    if (!differs[plane] && plane != int(Plane::height)) continue;
    std::vector<std::int32_t>& difference = planeOf(change, plane);
    difference.reserve(std::size_t(change.width) * change.height);
    for (int y = y_first; y <= y_last; ++y)
      for (int x = x_first; x <= x_last; ++x) {
        const auto i = std::size_t(y * size + x);
        difference.push_back((*after[plane])[i] - (*old[plane])[i]);
      }
  }
  return change;
}

std::vector<std::uint8_t> encodeTiles(std::span<const TileChange> changes) {
  ByteWriter writer;
  std::vector<ByteCounts> byte_counts(changes.size());
  writer.put(std::uint32_t(changes.size()));
  for (std::size_t i = 0; i < changes.size(); ++i) {
    const TileChange& change = changes[i];
    std::uint8_t planes = 0;
    for (int plane = 0; plane < kPlaneCount; ++plane) {
      byte_counts[i][plane] = byteCount(planeOf(change, plane));
      planes = std::uint8_t(planes | (byte_counts[i][plane] > 0 ? 1 << plane : 0));
    }
    writer.put(change.at.x);
    writer.put(change.at.y);
    writer.put(change.base_version);
    writer.put(change.new_version);
    writer.put(change.wake_mask);
    writer.put(change.hash);
    writer.put(planes);
    for (const std::uint8_t value : {change.x, change.y, change.width, change.height}) writer.put(value);
    for (const std::uint8_t value : byte_counts[i]) writer.put(value);
  }
  for (int plane = 0; plane < kPlaneCount; ++plane)
    for (int byte = 0; byte < 4; ++byte)
      for (std::size_t i = 0; i < changes.size(); ++i) {
        if (byte_counts[i][plane] <= byte) continue;
        const std::vector<std::int32_t>& difference = planeOf(changes[i], plane);
        const std::size_t at = writer.bytes.size();
        writer.bytes.resize(at + difference.size());
        std::ranges::transform(difference, writer.bytes.begin() + std::ptrdiff_t(at),
                               [byte](std::int32_t d) { return std::uint8_t(zigzag(d) >> (8 * byte)); });
      }
  return std::move(writer.bytes);
}

Result<std::vector<TileChange>> decodeTiles(std::span<const std::uint8_t> bytes, const ScenePack& pack,
                                            std::size_t tile_limit) {
  ByteReader reader(bytes);
  const std::size_t count = reader.get<std::uint32_t>();
  if (count > tile_limit)
    return Error{"tile changes: " + std::to_string(count) + " tiles, the limit is " + std::to_string(tile_limit)};
  if (count > reader.left() / kEntryBytes) return Error{"tile changes: truncated"};
  const TileCoordinate extent = tileExtent(pack);
  std::vector<Entry> entries(count);
  std::size_t plane_bytes = 0;
  for (std::size_t i = 0; i < count; ++i) {
    Entry& entry = entries[i];
    TileChange& change = entry.change;
    change.at.x = reader.get<std::int32_t>();
    change.at.y = reader.get<std::int32_t>();
    change.base_version = reader.get<std::int32_t>();
    change.new_version = reader.get<std::int32_t>();
    change.wake_mask = reader.get<WakeMask>();
    change.hash = reader.get<std::uint64_t>();
    entry.planes = reader.get<std::uint8_t>();
    for (std::uint8_t* value : {&change.x, &change.y, &change.width, &change.height})
      *value = reader.get<std::uint8_t>();
    for (std::uint8_t& value : entry.byte_counts) value = reader.get<std::uint8_t>();
    if (Status status = checkEntry(entry, extent); !status) return Error{status.error()};
    if (i > 0 && !(entries[i - 1].change.at < change.at)) return Error{nameOf(change.at) + ": out of order"};
    for (const std::uint8_t byte_count : entry.byte_counts)
      plane_bytes += std::size_t(change.width) * change.height * byte_count;
  }
  if (reader.failed() || plane_bytes != reader.left())
    return Error{"tile changes: " + std::to_string(reader.left()) + " bytes of differences, not " +
                 std::to_string(plane_bytes)};
  std::vector<TileChange> changes;
  changes.reserve(count);
  for (Entry& entry : entries)
    for (int plane = 0; plane < kPlaneCount; ++plane)
      if (plane == int(Plane::height) || entry.byte_counts[plane] > 0)
        planeOf(entry.change, plane).resize(std::size_t(entry.change.width) * entry.change.height);
  for (int plane = 0; plane < kPlaneCount; ++plane)
    for (int byte = 0; byte < 4; ++byte)
      for (Entry& entry : entries) {
        if (entry.byte_counts[plane] <= byte) continue;
        std::vector<std::int32_t>& difference = planeOf(entry.change, plane);
        const auto part = reader.getBytes(difference.size());
        for (std::size_t i = 0; i < part.size(); ++i)
          difference[i] = std::int32_t(std::uint32_t(difference[i]) | std::uint32_t(part[i]) << (8 * byte));
      }
  for (Entry& entry : entries) {
    for (int plane = 0; plane < kPlaneCount; ++plane)
      for (std::int32_t& d : planeOf(entry.change, plane)) d = unzigzag(std::uint32_t(d));
    changes.push_back(std::move(entry.change));
  }
  return changes;
}

namespace {

/// What a plane's values may be, in the world.
std::int32_t highestOf(Plane plane, const ScenePack& pack) {
  return plane == Plane::material ? std::int32_t(pack.materials.size()) - 1 : rules::kHeightLimit;
}

/// A tile's new cells, checked, waiting for all the others to be checked too.
struct Prepared {
  Tile* live = nullptr;                                         // where it was live already
  std::unique_ptr<Tile> fresh;                                  // where it was dormant
  std::array<std::unique_ptr<PlaneCells>, kPlaneCount> planes;  // its new cells; nullptr: as they were
  std::int64_t gained = 0;                                      // by craters
  std::unique_ptr<TileCraters> craters;                         // where new ones met it
};

Result<Prepared> prepare(WorldState& state, const BaseTerrain& base, const TileChange& change, std::int32_t tick,
                         std::size_t first_new_crater) {
  Prepared prepared;
  prepared.live = state.tiles.find(change.at);
  const std::int32_t held = prepared.live != nullptr ? prepared.live->version_tick : kDormantVersion;
  if (held != change.base_version)
    return Error{nameOf(change.at) + ": change is against version " + std::to_string(change.base_version) +
                 ", held is " + std::to_string(held)};
  if (prepared.live == nullptr) {
    DormantGround dormant = dormantGround(state, base);
    dormant.tick = tick;
    prepared.fresh = makeTile(change.at, dormant, change.new_version);
    prepared.gained = prepared.fresh->first_craters;
  }
  Tile& tile = prepared.live != nullptr ? *prepared.live : *prepared.fresh;
  for (int plane = 0; plane < kPlaneCount; ++plane)
    if (plane == int(Plane::height) || !planeOf(change, plane).empty())
      prepared.planes[plane] = tile.planes[plane] != nullptr ? std::make_unique<PlaneCells>(*tile.planes[plane])
                                                             : std::make_unique<PlaneCells>();
  if (prepared.live != nullptr && first_new_crater < state.craters.size()) {
    if (tile.craters != nullptr) prepared.craters = std::make_unique<TileCraters>(*tile.craters);
    prepared.gained = addCraters(change.at, *prepared.planes[int(Plane::height)], *tile.bedrock, state.craters,
                                 first_new_crater, prepared.craters);
  }
  std::uint64_t hash = 0;
  for (int plane = 0; plane < kPlaneCount; ++plane) {
    const std::vector<std::int32_t>& difference = planeOf(change, plane);
    PlaneCells* cells = prepared.planes[plane].get();
    for (std::size_t next = 0; next < difference.size(); ++next) {
      const int x = change.x + int(next) % change.width, y = change.y + int(next) / change.width;
      const auto i = std::size_t(y * rules::kTileSize + x);
      const std::int64_t value = std::int64_t((*cells)[i]) + difference[next];
      const bool inside = change.at.x * rules::kTileSize + x < base.pack().width_cells &&
                          change.at.y * rules::kTileSize + y < base.pack().height_cells;
      const std::int32_t lowest = plane == int(Plane::height) ? (*tile.bedrock)[i] : 0;
      if (value < lowest || value > (inside ? highestOf(Plane(plane), base.pack()) : 0))
        return Error{nameOf(change.at) + ": " +
                     (plane == int(Plane::height)      ? "a height lies below bedrock"
                      : plane == int(Plane::compacted) ? "compacted soil below 0"
                                                       : "a material that there is not") +
                     ", above the limit or outside the world"};
      (*cells)[i] = std::int32_t(value);
    }
    hash += planeHash(change.at, Plane(plane), cells != nullptr ? cells : tile.planes[plane].get());
  }
  if (hash != change.hash)
    return Error{nameOf(change.at) + ": hash " + hexText(hash) + " here, " + hexText(change.hash) + " announced"};
  return prepared;
}

void commit(WorldState& state, const TileChange& change, Prepared prepared) {
  if (prepared.fresh != nullptr) {
    prepared.live = &state.tiles.insert(std::move(prepared.fresh));
    state.ledger.initial += prepared.live->initial;
    state.ledger.events += prepared.live->first_snow;
  } else {
    state.tiles_hash -= tileStateHash(*prepared.live);
    state.ledger.ground -= prepared.live->ground;
    state.ledger.compacted -= prepared.live->compacted_sum;
  }
  state.ledger.craters += prepared.gained;
  Tile& tile = *prepared.live;
  for (int plane = 0; plane < kPlaneCount; ++plane)
    if (prepared.planes[plane] != nullptr) tile.planes[plane] = std::move(prepared.planes[plane]);
  if (prepared.craters != nullptr) tile.craters = std::move(prepared.craters);
  tile.version_tick = change.new_version;
  state.tiles.setWake(tile, change.wake_mask);
  tile.hash = change.hash;
  tile.ground = kernels().sum(tile.height().data(), rules::kTileCells);
  tile.compacted_sum = tile.compacted() == nullptr ? 0 : kernels().sum(tile.compacted()->data(), rules::kTileCells);
  state.tiles_hash += tileStateHash(tile);
  state.ledger.ground += tile.ground;
  state.ledger.compacted += tile.compacted_sum;
}

}  // namespace

Status applyTiles(WorldState& state, const BaseTerrain& base, std::span<const TileChange> changes, std::int32_t tick,
                  std::size_t first_new_crater) {
  const auto fresh = std::size_t(std::ranges::count(changes, kDormantVersion, &TileChange::base_version));
  if (state.tiles.size() + fresh > kSnapshotTilesLimit)
    return Error{std::to_string(state.tiles.size() + fresh) + " live tiles, the limit is " +
                 std::to_string(kSnapshotTilesLimit)};
  const auto new_craters = state.craters.records().subspan(std::min(first_new_crater, state.craters.size()));
  for (const Tile* tile : state.tiles.meeting(base.pack(), new_craters))
    if (!std::ranges::binary_search(changes, tile->at, {}, &TileChange::at))
      return Error{nameOf(tile->at) + ": a new crater meets it, and it is left out"};
  std::vector<Prepared> prepared;
  prepared.reserve(changes.size());
  for (const TileChange& change : changes) {
    Result<Prepared> one = prepare(state, base, change, tick, first_new_crater);
    if (!one) return Error{one.error()};
    prepared.push_back(std::move(*one));
  }
  for (std::size_t i = 0; i < changes.size(); ++i) commit(state, changes[i], std::move(prepared[i]));
  return {};
}

Status applyTick(WorldState& state, const BaseTerrain& base, const TickUpdate& update) {
  const std::string tick_name = "tick " + std::to_string(update.tick) + ": ";
  if (update.tick != state.tick + 1) return Error{tick_name + "expected tick " + std::to_string(state.tick + 1)};
  if (Status status = validatePoses(base.pack(), update.poses); !status) return Error{tick_name + status.error()};
  auto changes = decodeTiles(update.tiles, base.pack());
  if (!changes) return Error{tick_name + changes.error()};
  for (const TileChange& change : *changes)
    if (change.new_version != update.tick) return Error{tick_name + nameOf(change.at) + ": is of another tick"};
  if (update.parameters)
    if (Status status = validateParameters(base.pack(), *update.parameters); !status)
      return Error{tick_name + status.error()};
  if (Status status = validateNewCraters(base.pack(), update.craters, state.craters.size(), state.craters.hashCells());
      !status)
    return Error{tick_name + status.error()};
  if (Status status = validateNewSnowfalls(base.pack(), update.snowfalls, update.tick, state.snowfalls.size()); !status)
    return Error{tick_name + status.error()};
  const std::size_t crater_count = state.craters.size();
  for (std::size_t i = 0; i < update.craters.size(); ++i)
    if (update.craters[i].tick != update.tick || update.craters[i].id != crater_count + i)
      return Error{tick_name + "crater " + std::to_string(crater_count + i) + " has another id or tick"};
  state.craters.add(update.craters);
  state.snowfalls.insert(state.snowfalls.end(), update.snowfalls.begin(), update.snowfalls.end());
  SnowOfTick snow(state, base.pack(), update.tick, SnowTiles::all);
  if (Status status = applyTiles(state, base, *changes, update.tick, crater_count); !status) {
    snow.takeBack(state);
    state.snowfalls.resize(state.snowfalls.size() - update.snowfalls.size());
    state.craters.truncate(crater_count);
    return Error{tick_name + status.error()};
  }
  if (update.parameters) state.parameters = *update.parameters;
  state.tick = update.tick;
  state.previous_poses = std::move(state.poses);
  state.poses = update.poses;
  if (const std::uint64_t hash = stateHash(state); hash != update.state_hash)
    return Error{tick_name + "state hash " + hexText(hash) + " here, " + hexText(update.state_hash) + " announced"};
  return {};
}

}  // namespace spoor
