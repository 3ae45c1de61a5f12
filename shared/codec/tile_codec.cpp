#include "shared/codec/tile_codec.h"

#include <algorithm>
#include <cstring>
#include <memory>

#include "shared/base/bytes.h"
#include "shared/base/json.h"
#include "shared/base/kernels.h"

namespace spoor {
namespace {

constexpr std::size_t kEntryBytes = 4 * 4 + 2 + 8 + 6;

std::string nameOf(TileCoordinate at) { return "tile (" + std::to_string(at.x) + ", " + std::to_string(at.y) + ")"; }

std::uint32_t zigzag(std::int32_t v) { return (std::uint32_t(v) << 1) ^ std::uint32_t(v >> 31); }
std::int32_t unzigzag(std::uint32_t v) { return std::int32_t((v >> 1) ^ (0u - (v & 1u))); }

/// Bytes that the largest zigzag difference of a box needs, 0 for an empty box.
std::uint8_t byteCount(const TileChange& change) {
  std::uint32_t all = 0;
  for (const std::int32_t d : change.difference) all |= zigzag(d);
  return std::uint8_t(change.difference.empty() ? 0 : all < 0x100 ? 1 : all < 0x10000 ? 2 : all < 0x1000000 ? 3 : 4);
}

struct Entry {
  TileChange change;
  std::uint8_t planes = 0;
  std::uint8_t byte_count = 0;
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
  if (entry.planes > 1) return wrong("names a plane that this version does not know");
  if ((entry.planes == 1) != (change.width > 0) || (change.width > 0) != (change.height > 0) ||
      (change.width > 0) != (entry.byte_count > 0) || entry.byte_count > 4)
    return wrong("box and planes disagree");
  if (change.x + change.width > rules::kTileSize || change.y + change.height > rules::kTileSize)
    return wrong("box leaves the tile");
  return {};
}

}  // namespace

TileChange differenceOf(const Tile& tile, const PlaneCells& before, std::int32_t base_version) {
  constexpr int size = rules::kTileSize;
  int x_first = size, x_last = -1, y_first = size, y_last = -1;
  const PlaneCells& after = tile.height();
  for (int y = 0; y < size; ++y) {
    const std::int32_t* a = after.data() + y * size;
    const std::int32_t* b = before.data() + y * size;
    if (std::memcmp(a, b, size * sizeof(*a)) == 0) continue;
    int first = 0, last = size - 1;
    while (a[first] == b[first]) ++first;
    while (a[last] == b[last]) --last;
    x_first = std::min(x_first, first);
    x_last = std::max(x_last, last);
    y_first = std::min(y_first, y);
    y_last = y;
  }
  TileChange change{tile.at, base_version, tile.version_tick, tile.wake_mask, tile.hash, 0, 0, 0, 0, {}};
  if (x_last < 0) return change;
  change.x = std::uint8_t(x_first);
  change.y = std::uint8_t(y_first);
  change.width = std::uint8_t(x_last - x_first + 1);
  change.height = std::uint8_t(y_last - y_first + 1);
  change.difference.reserve(std::size_t(change.width) * change.height);
  for (int y = y_first; y <= y_last; ++y)
    for (int x = x_first; x <= x_last; ++x) change.difference.push_back(after[y * size + x] - before[y * size + x]);
  return change;
}

std::vector<std::uint8_t> encodeTiles(std::span<const TileChange> changes) {
  ByteWriter writer;
  std::vector<std::uint8_t> byte_counts;
  writer.put(std::uint32_t(changes.size()));
  for (const TileChange& change : changes) {
    byte_counts.push_back(byteCount(change));
    writer.put(change.at.x);
    writer.put(change.at.y);
    writer.put(change.base_version);
    writer.put(change.new_version);
    writer.put(change.wake_mask);
    writer.put(change.hash);
    writer.put(std::uint8_t(change.difference.empty() ? 0 : 1 << int(Plane::height)));
    for (const std::uint8_t value : {change.x, change.y, change.width, change.height, byte_counts.back()})
      writer.put(value);
  }
  for (int byte = 0; byte < 4; ++byte)
    for (std::size_t i = 0; i < changes.size(); ++i) {
      if (byte_counts[i] <= byte) continue;
      const std::size_t at = writer.bytes.size();
      writer.bytes.resize(at + changes[i].difference.size());
      std::ranges::transform(changes[i].difference, writer.bytes.begin() + std::ptrdiff_t(at),
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
    for (std::uint8_t* value : {&change.x, &change.y, &change.width, &change.height, &entry.byte_count})
      *value = reader.get<std::uint8_t>();
    if (Status status = checkEntry(entry, extent); !status) return Error{status.error()};
    if (i > 0 && !(entries[i - 1].change.at < change.at)) return Error{nameOf(change.at) + ": out of order"};
    plane_bytes += std::size_t(change.width) * change.height * entry.byte_count;
  }
  if (reader.failed() || plane_bytes != reader.left())
    return Error{"tile changes: " + std::to_string(reader.left()) + " bytes of differences, not " +
                 std::to_string(plane_bytes)};
  std::vector<TileChange> changes;
  changes.reserve(count);
  for (Entry& entry : entries) entry.change.difference.resize(std::size_t(entry.change.width) * entry.change.height);
  for (int byte = 0; byte < 4; ++byte)
    for (Entry& entry : entries) {
      if (entry.byte_count <= byte) continue;
      const auto part = reader.getBytes(entry.change.difference.size());
      for (std::size_t i = 0; i < part.size(); ++i) {
        std::int32_t& d = entry.change.difference[i];
        d = std::int32_t(std::uint32_t(d) | std::uint32_t(part[i]) << (8 * byte));
      }
    }
  for (Entry& entry : entries) {
    for (std::int32_t& d : entry.change.difference) d = unzigzag(std::uint32_t(d));
    changes.push_back(std::move(entry.change));
  }
  return changes;
}

namespace {

/// A tile's new cells, checked, waiting for all the others to be checked too.
struct Prepared {
  Tile* live = nullptr;                // where it was live already
  std::unique_ptr<Tile> fresh;         // where it was dormant
  std::unique_ptr<PlaneCells> height;  // its new cells
};

Result<Prepared> prepare(WorldState& state, const BaseTerrain& base, const TileChange& change) {
  Prepared prepared;
  prepared.live = state.tiles.find(change.at);
  const std::int32_t held = prepared.live != nullptr ? prepared.live->version_tick : kDormantVersion;
  if (held != change.base_version)
    return Error{nameOf(change.at) + ": change is against version " + std::to_string(change.base_version) +
                 ", held is " + std::to_string(held)};
  if (prepared.live == nullptr) prepared.fresh = makeTile(change.at, base, change.new_version);
  Tile& tile = prepared.live != nullptr ? *prepared.live : *prepared.fresh;
  prepared.height = std::make_unique<PlaneCells>(tile.height());
  auto d = change.difference.begin();
  for (int y = change.y; y < change.y + change.height; ++y)
    for (int x = change.x; x < change.x + change.width; ++x) {
      const auto i = std::size_t(y * rules::kTileSize + x);
      const std::int64_t height = std::int64_t((*prepared.height)[i]) + *d++;
      const bool inside = change.at.x * rules::kTileSize + x < base.pack().width_cells &&
                          change.at.y * rules::kTileSize + y < base.pack().height_cells;
      if (height < (*tile.bedrock)[i] || height > (inside ? rules::kHeightLimit : 0))
        return Error{nameOf(change.at) + ": a height lies below bedrock, above the limit or outside the world"};
      (*prepared.height)[i] = std::int32_t(height);
    }
  // The hash is over all planes; with height as the only one, its cells are the whole.
  const std::uint64_t hash = kernels().hashTile(prepared.height->data(), change.at.x * rules::kTileSize,
                                                change.at.y * rules::kTileSize, int(Plane::height));
  if (hash != change.hash)
    return Error{nameOf(change.at) + ": hash " + hexText(hash) + " here, " + hexText(change.hash) + " announced"};
  return prepared;
}

void commit(WorldState& state, const TileChange& change, Prepared prepared) {
  if (prepared.fresh != nullptr) {
    prepared.live = &state.tiles.insert(std::move(prepared.fresh));
    state.ledger.initial += prepared.live->initial;
  } else {
    state.tiles_hash -= tileStateHash(*prepared.live);
    state.ledger.ground -= prepared.live->ground;
  }
  Tile& tile = *prepared.live;
  tile.planes[int(Plane::height)] = std::move(prepared.height);
  tile.version_tick = change.new_version;
  state.tiles.setWake(tile, change.wake_mask);
  tile.hash = change.hash;
  tile.ground = kernels().sum(tile.height().data(), rules::kTileCells);
  state.tiles_hash += tileStateHash(tile);
  state.ledger.ground += tile.ground;
}

}  // namespace

Status applyTiles(WorldState& state, const BaseTerrain& base, std::span<const TileChange> changes) {
  const auto fresh = std::size_t(std::ranges::count(changes, kDormantVersion, &TileChange::base_version));
  if (state.tiles.size() + fresh > kSnapshotTilesLimit)
    return Error{std::to_string(state.tiles.size() + fresh) + " live tiles, the limit is " +
                 std::to_string(kSnapshotTilesLimit)};
  std::vector<Prepared> prepared;
  prepared.reserve(changes.size());
  for (const TileChange& change : changes) {
    Result<Prepared> one = prepare(state, base, change);
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
  if (Status status = applyTiles(state, base, *changes); !status) return Error{tick_name + status.error()};
  state.tick = update.tick;
  state.previous_poses = std::move(state.poses);
  state.poses = update.poses;
  if (const std::uint64_t hash = stateHash(state); hash != update.state_hash)
    return Error{tick_name + "state hash " + hexText(hash) + " here, " + hexText(update.state_hash) + " announced"};
  return {};
}

}  // namespace spoor
