#include "shared/world/pack.h"

#include <algorithm>

#include "shaders/rules/raster.h"
#include "shared/base/assert.h"
#include "shared/base/bytes.h"
#include "shared/base/hash.h"
#include "shared/base/json.h"

namespace spoor {
namespace {

constexpr std::uint32_t kMagic = 0x50525053;  // "SPRP"
constexpr std::uint32_t kVersion = 4;
constexpr std::size_t kListLimit = 4096;         // meshes, paths, bodies
constexpr std::size_t kWaypointLimit = 1 << 16;  // of a path
constexpr std::size_t kWorkLimit = 1 << 24;  // vertices, triangles and edges, over all bodies: a tick visits them all
constexpr std::int32_t kWorldMargin = 1 << 27;      // waypoints outside the world, 0.1 mm
constexpr std::int32_t kSoilLimit = (1 << 28) - 1;  // with a cubic's overshoot the base stays within the height limit
constexpr std::int32_t kStrideLimit = 1 << 20;      // 105 m
constexpr std::size_t kMeshLimit = 1 << 22;         // vertices, triangles of a mesh
constexpr std::int32_t kGroundLimit = 1 << 29;      // base heights; leaves as much again for soil that piles up
constexpr std::int32_t kMeshReach = 1 << 24;        // mesh coordinates, 0.1 mm

Status outOfRange(const std::string& field, std::int64_t value, std::int64_t lowest, std::int64_t highest) {
  return Error{"pack: " + field + " is " + std::to_string(value) + ", not within " + std::to_string(lowest) + " .. " +
               std::to_string(highest)};
}

constexpr bool isWithin(std::int64_t value, std::int64_t lowest, std::int64_t highest) {
  return value >= lowest && value <= highest;
}

#define SPOOR_CHECK_RANGE(value, lowest, highest) \
  if (!isWithin(value, lowest, highest)) return outOfRange(#value, value, lowest, highest)

Status validateBase(const ScenePack& pack) {
  SPOOR_CHECK_RANGE(int(pack.base_kind), 0, 1);
  if (pack.base_kind == BaseKind::noise) {
    const NoiseBase& noise = pack.noise;
    SPOOR_CHECK_RANGE(noise.octaves, 1, 8);
    SPOOR_CHECK_RANGE(noise.lattice_step_q32, 1, std::int64_t(1) << (33 - noise.octaves));
    SPOOR_CHECK_RANGE(noise.lowest_q, -kGroundLimit, kGroundLimit);
    SPOOR_CHECK_RANGE(noise.highest_q, noise.lowest_q, kGroundLimit);
    if (pack.samples != SampleBase{}) return Error{"pack: samples given for a base of noise"};
    return {};
  }
  if (pack.noise != NoiseBase{}) return Error{"pack: noise given for a base of samples"};
  const SampleBase& samples = pack.samples;
  SPOOR_CHECK_RANGE(samples.column_count, 1, 1 << 20);
  SPOOR_CHECK_RANGE(samples.row_count, 1, 1 << 20);
  SPOOR_CHECK_RANGE(samples.step_x_q32, 1, std::int64_t(1) << 38);
  SPOOR_CHECK_RANGE(samples.step_y_q32, 1, std::int64_t(1) << 38);
  if (samples.height_q.size() != std::size_t(samples.column_count) * std::size_t(samples.row_count))
    return Error{"pack: samples.height_q holds " + std::to_string(samples.height_q.size()) +
                 " heights, not column_count * row_count"};
  for (const std::int32_t sample_height : samples.height_q)
    SPOOR_CHECK_RANGE(sample_height, -kGroundLimit, kGroundLimit);
  return {};
}

Status validateMesh(const Mesh& mesh) {
  const std::string name = "mesh '" + mesh.name + "'";
  if (mesh.triangles.empty()) return Error{"pack: " + name + " has no triangles"};
  if (mesh.vertices.size() > kMeshLimit || mesh.triangles.size() > kMeshLimit || mesh.edges.size() > 3 * kMeshLimit)
    return Error{"pack: " + name + " is larger than 2^22 vertices or triangles"};
  for (const auto& vertex : mesh.vertices)
    for (const std::int32_t coordinate : vertex) SPOOR_CHECK_RANGE(coordinate, -kMeshReach, kMeshReach);
  const auto count = mesh.vertices.size();
  const auto outside = [count](std::uint32_t index) { return index >= count; };
  for (const auto& triangle : mesh.triangles)
    if (std::ranges::any_of(triangle, outside)) return Error{"pack: " + name + " names a vertex it does not have"};
  for (const auto& edge : mesh.edges)
    if (std::ranges::any_of(edge, outside)) return Error{"pack: " + name + " names a vertex it does not have"};
  return {};
}

/// A mesh may be turned any way, so its diagonal must fit the raster's window.
Status validateMeshSize(const Mesh& mesh, std::int32_t cell_q) {
  std::int64_t farthest = 0;
  for (const auto& vertex : mesh.vertices) {
    std::int64_t square = 0;
    for (const std::int64_t coordinate : vertex) square += coordinate * coordinate;
    farthest = std::max(farthest, square);
  }
  const std::int64_t reach_limit =
      std::min<std::int64_t>(std::int64_t(rules::kRasterSpanCells / 2 - 2) * cell_q, rules::kRasterHeightSpan / 2 - 2);
  if (farthest > reach_limit * reach_limit)
    return Error{"pack: mesh '" + mesh.name + "' reaches farther than " + std::to_string(reach_limit) +
                 " units (0.1 mm) from its origin, the limit at this cell size"};
  return {};
}

Status validateBody(const ScenePack& pack, const Body& body) {
  SPOOR_CHECK_RANGE(body.mesh_index, 0, std::int64_t(pack.meshes.size()) - 1);
  SPOOR_CHECK_RANGE(body.path_index, 0, std::int64_t(pack.paths.size()) - 1);
  for (const std::int32_t offset_q : body.offset_q) SPOOR_CHECK_RANGE(offset_q, -kMeshReach, kMeshReach);
  SPOOR_CHECK_RANGE(body.sinkage_q, -kMeshReach, kMeshReach);
  SPOOR_CHECK_RANGE(body.roll_radius_q, 0, kMeshReach);
  SPOOR_CHECK_RANGE(body.stride_q, 0, kStrideLimit);
  SPOOR_CHECK_RANGE(body.lift_q, 0, kStrideLimit);
  SPOOR_CHECK_RANGE(body.phase_q, 0, kMeshReach);
  SPOOR_CHECK_RANGE(body.follows_slope, 0, 1);
  SPOOR_CHECK_RANGE(body.force_n, 0, kForceLimit);
  SPOOR_CHECK_RANGE(body.first_scale_q16, 1, kFullScale);
  SPOOR_CHECK_RANGE(body.last_scale_q16, 1, kFullScale);
  SPOOR_CHECK_RANGE(body.first_scale_tick, 0, 1 << 30);
  SPOOR_CHECK_RANGE(body.last_scale_tick, body.first_scale_tick, 1 << 30);
  return {};
}

Status validatePath(const Path& path) {
  if (path.waypoints.empty() || path.waypoints.size() > kWaypointLimit)
    return Error{"pack: a path needs 1 .. 65536 waypoints, this one has " + std::to_string(path.waypoints.size())};
  SPOOR_CHECK_RANGE(path.speed_q_per_tick, 0, 1 << 20);
  SPOOR_CHECK_RANGE(path.first_tick, 0, 1 << 30);
  SPOOR_CHECK_RANGE(path.closed, 0, 1);
  for (const Waypoint& waypoint : path.waypoints) {
    SPOOR_CHECK_RANGE(waypoint.x_q, -kWorldMargin, 0x7fffffff - kMeshReach * 4);
    SPOOR_CHECK_RANGE(waypoint.y_q, -kWorldMargin, 0x7fffffff - kMeshReach * 4);
  }
  return {};
}

Status validateTimedCraters(const ScenePack& pack) {
  if (Status status = validateCraterLimits(pack.crater_limits); !status) return Error{"pack: " + status.error()};
  SPOOR_CHECK_RANGE(std::int64_t(pack.craters.size()), 0, std::int64_t(kCratersLimit));
  std::size_t of_tick = 0;
  std::int64_t hash_cells = 0;
  for (std::size_t i = 0; i < pack.craters.size(); ++i) {
    const Crater& crater = pack.craters[i];
    const std::string name = "pack: crater " + std::to_string(i) + ": ";
    if (Status status = validateCrater(pack, crater); !status) return Error{name + status.error()};
    if (crater.id != i) return Error{name + "its id is " + std::to_string(crater.id)};
    const std::int32_t before = i > 0 ? pack.craters[i - 1].tick : 1;
    if (crater.tick < before)
      return Error{name + "its tick is " + std::to_string(crater.tick) + ", before " + std::to_string(before)};
    of_tick = crater.tick == before ? of_tick + 1 : 1;
    if (of_tick > kTickCratersLimit)
      return Error{name + "more than " + std::to_string(kTickCratersLimit) + " in one tick"};
    hash_cells += hashCellsOf(pack, crater);
    if (hash_cells > kCraterHashCellsLimit)
      return Error{name + "together they are in more than " + std::to_string(kCraterHashCellsLimit) +
                   " hash cells; larger cells help"};
  }
  return {};
}

/// The one list of fields behind encodePack and decodePack: `visit(value)` for integers, in the order of the bytes.
template <typename Pack, typename Visit>
void visitScalars(Pack& pack, Visit visit) {
  visit(pack.seed);
  visit(pack.width_cells);
  visit(pack.height_cells);
  visit(pack.cell_q);
  visit(pack.ticks_per_second);
  visit(pack.default_ticks);
  visit(pack.soil_depth_q);
  visit(pack.patches_per_row);
  visit(pack.normal_blur_passes);
  visit(pack.noise.seed);
  visit(pack.noise.lattice_step_q32);
  visit(pack.noise.octaves);
  visit(pack.noise.lowest_q);
  visit(pack.noise.highest_q);
  visit(pack.samples.column_count);
  visit(pack.samples.row_count);
  visit(pack.samples.step_x_q32);
  visit(pack.samples.step_y_q32);
}

template <typename Limits, typename Visit>
void visitScalars(Limits& limits, Visit visit) requires std::same_as<std::remove_const_t<Limits>, CraterLimits> {
  visit(limits.radius_q);
  visit(limits.hash_cell_q);
  visit(limits.request_radius_q);
  visit(limits.request_height_q);
  visit(limits.request_distance_q);
  visit(limits.requests_per_minute);
}

template <typename BodyType, typename Visit>
void visitScalars(BodyType& body, Visit visit) requires std::same_as<std::remove_const_t<BodyType>, Body> {
  visit(body.mesh_index);
  visit(body.path_index);
  for (auto& offset : body.offset_q) visit(offset);
  visit(body.sinkage_q);
  visit(body.roll_radius_q);
  visit(body.stride_q);
  visit(body.lift_q);
  visit(body.phase_q);
  visit(body.follows_slope);
  visit(body.force_n);
  visit(body.first_scale_q16);
  visit(body.last_scale_q16);
  visit(body.first_scale_tick);
  visit(body.last_scale_tick);
}

/// A vector of fixed arrays, read as one block.
template <typename T, std::size_t N>
std::vector<std::array<T, N>> getArrays(ByteReader& reader) {
  const std::size_t count = reader.get<std::uint32_t>();
  std::vector<std::array<T, N>> result;
  if (count > reader.left() / sizeof(std::array<T, N>)) {
    (void)reader.getBytes(reader.left() + 1);
    return result;
  }
  result.resize(count);
  for (auto& item : result)
    for (T& value : item) value = reader.get<T>();
  return result;
}

template <typename T, std::size_t N>
void putArrays(ByteWriter& writer, const std::vector<std::array<T, N>>& items) {
  writer.put(std::uint32_t(items.size()));
  for (const auto& item : items)
    for (const T value : item) writer.put(value);
}

void putMaterials(ByteWriter& writer, const ScenePack& pack) {
  writer.put(std::uint32_t(pack.materials.size()));
  for (const Material& material : pack.materials) {
    writer.putText(material.name);
    for (const std::uint8_t channel : material.colour) writer.put(channel);
    writer.put(std::uint8_t(material.texture));
    writer.put(material.grain_size_q);
    writer.put(material.grain_height_q);
  }
  const MaterialMap& map = pack.material_map;
  writer.put(std::uint8_t(map.kind));
  writer.put(map.image.column_count);
  writer.put(map.image.row_count);
  writer.put(map.image.step_x_q32);
  writer.put(map.image.step_y_q32);
  writer.put(std::uint32_t(map.image.material.size()));
  writer.putBytes(map.image.material);
  writer.put(std::uint32_t(map.rules.size()));
  for (const MaterialRule& rule : map.rules)
    for (const std::int32_t value : {rule.material, rule.lowest_q, rule.highest_q, rule.gentlest_q, rule.steepest_q})
      writer.put(value);
}

void getMaterials(ByteReader& reader, ScenePack& pack) {
  pack.materials.clear();
  for (auto count = reader.get<std::uint32_t>(); count > 0 && !reader.failed(); --count) {
    Material& material = pack.materials.emplace_back();
    material.name = reader.getText();
    for (std::uint8_t& channel : material.colour) channel = reader.get<std::uint8_t>();
    material.texture = MaterialTexture(reader.get<std::uint8_t>());
    material.grain_size_q = reader.get<std::int32_t>();
    material.grain_height_q = reader.get<std::int32_t>();
  }
  MaterialMap& map = pack.material_map;
  map.kind = MaterialMapKind(reader.get<std::uint8_t>());
  map.image.column_count = reader.get<std::int32_t>();
  map.image.row_count = reader.get<std::int32_t>();
  map.image.step_x_q32 = reader.get<std::int64_t>();
  map.image.step_y_q32 = reader.get<std::int64_t>();
  const auto samples = reader.getBytes(reader.get<std::uint32_t>());
  map.image.material.assign(samples.begin(), samples.end());
  for (auto count = reader.get<std::uint32_t>(); count > 0 && !reader.failed(); --count) {
    MaterialRule& rule = map.rules.emplace_back();
    for (std::int32_t* value : {&rule.material, &rule.lowest_q, &rule.highest_q, &rule.gentlest_q, &rule.steepest_q})
      *value = reader.get<std::int32_t>();
  }
}

}  // namespace

std::string toText(const PackId& id) { return hexText(id.high) + hexText(id.low); }

Status validatePack(const ScenePack& pack) {
  SPOOR_CHECK_RANGE(pack.width_cells, 1, kWorldCellsLimit);
  SPOOR_CHECK_RANGE(pack.height_cells, 1, kWorldCellsLimit);
  SPOOR_CHECK_RANGE(pack.cell_q, 1, 1000000);
  const std::int64_t width_q = std::int64_t(pack.width_cells) * pack.cell_q;
  const std::int64_t height_q = std::int64_t(pack.height_cells) * pack.cell_q;
  SPOOR_CHECK_RANGE(width_q, 1, 0x7fffffff - kMeshReach * 4);
  SPOOR_CHECK_RANGE(height_q, 1, 0x7fffffff - kMeshReach * 4);
  SPOOR_CHECK_RANGE(pack.ticks_per_second, 1, 1000);
  SPOOR_CHECK_RANGE(pack.default_ticks, 1, 1 << 30);
  SPOOR_CHECK_RANGE(pack.soil_depth_q, 0, kSoilLimit);
  SPOOR_CHECK_RANGE(pack.patches_per_row, 0, 4096);
  SPOOR_CHECK_RANGE(pack.normal_blur_passes, 0, 16);
  if (Status status = validateMaterials(pack.materials, pack.material_map); !status)
    return Error{"pack: " + status.error()};
  if (Status status = validateParameters(pack, pack.parameters); !status) return Error{"pack: " + status.error()};
  if (Status base = validateBase(pack); !base) return base;
  if (pack.meshes.size() > kListLimit || pack.paths.size() > kListLimit || pack.bodies.size() > kListLimit)
    return Error{"pack: more than 4096 meshes, paths or bodies"};
  for (const Mesh& mesh : pack.meshes) {
    if (Status status = validateMesh(mesh); !status) return status;
    if (Status status = validateMeshSize(mesh, pack.cell_q); !status) return status;
  }
  for (const Path& path : pack.paths)
    if (Status status = validatePath(path); !status) return status;
  std::size_t work = 0;
  for (const Body& body : pack.bodies) {
    if (Status status = validateBody(pack, body); !status) return Error{status.error() + " (body '" + body.name + "')"};
    const Mesh& mesh = pack.meshes[std::size_t(body.mesh_index)];
    work += mesh.vertices.size() + mesh.triangles.size() + mesh.edges.size();
  }
  SPOOR_CHECK_RANGE(std::int64_t(work), 0, kWorkLimit);
  if (Status status = validateNewSnowfalls(pack, pack.snowfalls, 1, 0); !status)
    return Error{"pack: " + status.error()};
  return validateTimedCraters(pack);
}

Status validateParameters(const ScenePack& pack, const Parameters& parameters) {
  if (Status status = validateParameters(parameters); !status) return status;
  if (parameters.materials.size() != pack.materials.size())
    return Error{"parameters: of " + std::to_string(parameters.materials.size()) + " materials, the pack has " +
                 std::to_string(pack.materials.size())};
  const std::int64_t cells = std::int64_t(pack.width_cells) * pack.height_cells;
  if (parameters.active_areas == 0 && (pack.width_cells > kWholeWorldSideLimit ||
                                       pack.height_cells > kWholeWorldSideLimit || cells > kWholeWorldCellsLimit))
    return Error{"parameters: active_areas is 0 in a world of " + std::to_string(pack.width_cells) + " x " +
                 std::to_string(pack.height_cells) + " cells; all of it can be simulated up to " +
                 std::to_string(kWholeWorldCellsLimit) + " cells, " + std::to_string(kWholeWorldSideLimit) + " a side"};
  return {};
}

std::vector<std::uint8_t> encodePack(const ScenePack& pack) {
  SPOOR_ASSERT(validatePack(pack));
  ByteWriter writer;
  writer.put(kMagic);
  writer.put(kVersion);
  writer.putText(pack.name);
  visitScalars(pack, [&](auto value) { writer.put(value); });
  putParameters(writer, pack.parameters);
  writer.put(std::uint8_t(pack.base_kind));
  writer.put(std::uint32_t(pack.samples.height_q.size()));
  writer.putAll(std::span<const std::int32_t>(pack.samples.height_q));
  writer.put(std::uint32_t(pack.meshes.size()));
  for (const Mesh& mesh : pack.meshes) {
    writer.putText(mesh.name);
    putArrays(writer, mesh.vertices);
    putArrays(writer, mesh.triangles);
    putArrays(writer, mesh.edges);
  }
  writer.put(std::uint32_t(pack.paths.size()));
  for (const Path& path : pack.paths) {
    writer.put(std::uint32_t(path.waypoints.size()));
    for (const Waypoint& waypoint : path.waypoints) {
      writer.put(waypoint.x_q);
      writer.put(waypoint.y_q);
    }
    writer.put(path.speed_q_per_tick);
    writer.put(path.first_tick);
    writer.put(path.closed);
  }
  writer.put(std::uint32_t(pack.bodies.size()));
  for (const Body& body : pack.bodies) {
    writer.putText(body.name);
    visitScalars(body, [&](auto value) { writer.put(value); });
  }
  visitScalars(pack.crater_limits, [&](auto value) { writer.put(value); });
  writer.put(std::uint32_t(pack.craters.size()));
  for (const Crater& crater : pack.craters) putCrater(writer, crater);
  putMaterials(writer, pack);
  writer.put(std::uint32_t(pack.snowfalls.size()));
  for (const Snowfall& snowfall : pack.snowfalls) putSnowfall(writer, snowfall);
  return std::move(writer.bytes);
}

Result<ScenePack> decodePack(std::span<const std::uint8_t> bytes) {
  ByteReader reader(bytes);
  if (reader.get<std::uint32_t>() != kMagic) return Error{"pack: not a Spoor scene pack (wrong magic)"};
  if (const auto version = reader.get<std::uint32_t>(); version != kVersion)
    return Error{"pack: format version " + std::to_string(version) + ", this program reads " +
                 std::to_string(kVersion)};
  const auto get = [&](auto& value) { value = reader.get<std::remove_reference_t<decltype(value)>>(); };
  // A list ends where the bytes do, however many elements it announces.
  const auto getCount = [&] { return reader.get<std::uint32_t>(); };
  ScenePack pack;
  pack.name = reader.getText();
  visitScalars(pack, get);
  pack.parameters = getParameters(reader);
  pack.base_kind = BaseKind(reader.get<std::uint8_t>());
  pack.samples.height_q = reader.getAll<std::int32_t>(reader.get<std::uint32_t>());
  for (auto count = getCount(); count > 0 && !reader.failed(); --count) {
    Mesh& mesh = pack.meshes.emplace_back();
    mesh.name = reader.getText();
    mesh.vertices = getArrays<std::int32_t, 3>(reader);
    mesh.triangles = getArrays<std::uint32_t, 3>(reader);
    mesh.edges = getArrays<std::uint32_t, 2>(reader);
  }
  for (auto count = getCount(); count > 0 && !reader.failed(); --count) {
    Path& path = pack.paths.emplace_back();
    for (const auto& point : getArrays<std::int32_t, 2>(reader)) path.waypoints.push_back({point[0], point[1]});
    get(path.speed_q_per_tick);
    get(path.first_tick);
    get(path.closed);
  }
  for (auto count = getCount(); count > 0 && !reader.failed(); --count) {
    Body& body = pack.bodies.emplace_back();
    body.name = reader.getText();
    visitScalars(body, get);
  }
  visitScalars(pack.crater_limits, get);
  for (auto count = getCount(); count > 0 && !reader.failed(); --count) pack.craters.push_back(getCrater(reader));
  getMaterials(reader, pack);
  for (auto count = getCount(); count > 0 && !reader.failed(); --count) pack.snowfalls.push_back(getSnowfall(reader));
  if (reader.failed()) return Error{"pack: truncated"};
  if (reader.left() > 0) return Error{"pack: " + std::to_string(reader.left()) + " bytes too many"};
  if (Status status = validatePack(pack); !status) return Error{status.error()};
  return pack;
}

PackId packId(std::span<const std::uint8_t> encoded) { return {hashBytes(encoded, 1), hashBytes(encoded, 2)}; }

void deriveEdges(Mesh& mesh) {
  mesh.edges.clear();
  for (const auto& triangle : mesh.triangles)
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t a = triangle[i], b = triangle[(i + 1) % 3];
      mesh.edges.push_back({std::min(a, b), std::max(a, b)});
    }
  std::ranges::sort(mesh.edges);
  const auto repeats = std::ranges::unique(mesh.edges);
  mesh.edges.erase(repeats.begin(), repeats.end());
}

}  // namespace spoor
