#include "server/import/scene_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "server/import/mesh_file.h"
#include "server/import/path_maker.h"
#include "server/import/units.h"
#include "shaders/rules/limits.h"

namespace spoor {
namespace {

// What validatePack allows, in metres.
constexpr Range kOffsetRange{-1600, 1600, "m"};
constexpr Range kLengthRange{0, 1600, "m"};
constexpr Range kScaleRange{1e-6, 1e6, ""};
constexpr Range kSizeRange{1e-4, 1, ""};
constexpr double kSpeedLimitQ = 1 << 20;
constexpr double kPathMarginM = 1000;  // how far beyond the world's edge a path may lead

void addName(TableReader& table, const std::string& name, std::map<std::string, std::int32_t>& index) {
  if (!index.emplace(name, std::int32_t(index.size())).second) table.wrong("name", "'" + name + "' is there already");
}

/// Index of what a key names.
std::int32_t lookUp(TableReader& table, std::string_view key, const std::map<std::string, std::int32_t>& index,
                    const char* kind) {
  const std::string name = table.text(key);
  const auto found = index.find(name);
  if (found != index.end()) return found->second;
  table.wrong(key, fmt::format("no [[{}]] is named '{}'", kind, name));
  return 0;
}

/// Points of a path as the file gives them, from the world's south-west corner.
std::vector<PointM> readPoints(TableReader& table, const ScenePack& pack) {
  const double cell_m = double(pack.cell_q) / rules::kUnitsPerMetre;
  const PointM size{pack.width_cells * cell_m, pack.height_cells * cell_m};
  const bool from_centre = table.choice("origin", {"corner", "centre"}, "corner") == "centre";
  std::vector<PointM> points = table.points("points_m", {-3e5, 3e5, "m"});
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (int axis = 0; axis < 2; ++axis) {
      if (from_centre) points[i][axis] += size[axis] / 2;
      if (points[i][axis] >= -kPathMarginM && points[i][axis] <= size[axis] + kPathMarginM) continue;
      table.wrong("points_m", fmt::format("point {} at ({}, {}) m lies more than {} m outside the world of {} x {} m",
                                          i + 1, plainNumber(points[i][0]), plainNumber(points[i][1]), kPathMarginM,
                                          plainNumber(size[0]), plainNumber(size[1])));
      return {};
    }
    if (i > 0 && points[i] == points[i - 1]) {
      table.wrong("points_m", fmt::format("points {} and {} are the same", i, i + 1));
      return {};
    }
  }
  return points;
}

std::int32_t readSpeed(TableReader& table, std::int32_t ticks_per_second, const std::string& name,
                       std::vector<std::string>& notes) {
  const double limit_m_s = kSpeedLimitQ * ticks_per_second / rules::kUnitsPerMetre;
  const double speed_m_s = table.number("speed_m_s", {0, limit_m_s, "m/s"});
  const double exact_q = speed_m_s * rules::kUnitsPerMetre / ticks_per_second;
  const auto speed_q = std::int32_t(std::llround(exact_q));
  if (speed_q == 0 && speed_m_s > 0)
    table.wrong("speed_m_s", plainNumber(speed_m_s) + " m/s are less than 0.1 mm per tick");
  if (std::abs(speed_q - exact_q) > 1e-3 * exact_q) {
    notes.push_back(fmt::format("path '{}': {} m/s rounded to {} m/s (whole 0.1 mm per tick)", name,
                                plainNumber(speed_m_s),
                                plainNumber(double(speed_q) * ticks_per_second / rules::kUnitsPerMetre)));
  }
  return speed_q;
}

Path readPath(TableReader& table, const std::string& name, const ScenePack& pack, std::vector<std::string>& notes) {
  Path path;
  path.speed_q_per_tick = readSpeed(table, pack.ticks_per_second, name, notes);
  path.first_tick = std::int32_t(std::llround(table.number("start_s", {0, 1e6, "s"}, 0) * pack.ticks_per_second));
  const bool closed = table.flag("closed", false);
  const bool smooth = table.flag("smooth", true);
  std::vector<PointM> points = readPoints(table, pack);
  path.closed = closed ? 1 : 0;
  if (closed && !points.empty() && (points.size() < 2 || points.front() == points.back())) {
    table.wrong("points_m", "a closed path needs two points or more, the first not repeated at the end");
    return path;
  }
  if (smooth && points.size() > 1) {
    points = smoothPath(points, closed);
    const double step_m = pathLength(points, closed) / double(points.size());
    if (step_m > kSmoothStepM * 1.01) {
      notes.push_back(fmt::format("path '{}': {} points are the most, so they lie {} m apart", name, points.size(),
                                  plainNumber(step_m)));
    }
  }
  for (const PointM& point : points) path.waypoints.push_back({toUnits(point[0]), toUnits(point[1])});
  return path;
}

/// A vehicle's measures, metres.
struct VehicleShape {
  double track_m, wheelbase_m, wheel_radius_m, sinkage_m, chassis_height_m, left_m;
};

VehicleShape readShape(TableReader& table) {
  VehicleShape shape{};
  shape.track_m = table.number("track_m", {0, 100, "m"});
  shape.wheelbase_m = table.number("wheelbase_m", {0, 100, "m"});
  shape.wheel_radius_m = table.number("wheel_radius_m", {0.001, 100, "m"});
  shape.sinkage_m = table.number("sinkage_m", {0, 100, "m"}, 0.1);
  shape.chassis_height_m = table.number("chassis_height_m", {-100, 100, "m"}, shape.wheel_radius_m);
  shape.left_m = table.number("left_m", kOffsetRange, 0);
  return shape;
}

/// How large a body is: a share of its mesh, or from one to another between two times.
void readSize(TableReader& table, const ScenePack& pack, Body& body, std::vector<std::string>& notes) {
  const Span size = table.sequence("size", kSizeRange, 1);
  const auto share = [](double value) { return std::max(std::int32_t(std::llround(value * kFullScale)), 1); };
  body.first_scale_q16 = share(size.least);
  body.last_scale_q16 = share(size.most);
  const bool changes = size.least != size.most;
  if (changes && !table.has("size_s")) table.wrong("size_s", "missing; [from, to] of the change of size");
  if (!table.has("size_s")) return;
  if (!changes) return table.wrong("size_s", "goes with size = [first, last]");
  const Span time_s = table.span("size_s", {0, 1e6, "s"});
  const auto tick = [&](double at_s) {
    const double exact = at_s * pack.ticks_per_second;
    if (std::abs(exact - std::round(exact)) > 1e-6)
      notes.push_back(fmt::format("{}: {} s rounded to tick {}", table.keyPath("size_s"), plainNumber(at_s),
                                  plainNumber(std::round(exact))));
    return std::int32_t(std::llround(exact));
  };
  body.first_scale_tick = tick(time_s.least);
  body.last_scale_tick = tick(time_s.most);
}

std::int32_t readForce(TableReader& table) {
  return std::int32_t(std::llround(table.number("force_n", {0, kForceLimit, "N"}, 0)));
}

}  // namespace

std::string filePath(const SceneDraft& draft, const std::string& named) { return (draft.directory / named).string(); }

void readMeshTables(TableReader& file, const SceneErrors& errors, SceneDraft& draft) {
  for (TableReader& table : file.tables("mesh")) {
    MeshRequest request;
    request.name = table.text("name");
    request.file = filePath(draft, table.text("file"));
    request.scale = table.number("scale", kScaleRange, 1);
    request.up = table.choice("up", {"y", "z"}, "");
    addName(table, request.name, draft.meshes);
    table.finish();
    if (errors.failed()) return;
    Result<Mesh> mesh = readMesh(request, draft.scene.pack.cell_q, draft.scene.notes);
    if (!mesh) return table.wrong("file", mesh.error());
    draft.scene.pack.meshes.push_back(std::move(*mesh));
  }
}

void readPathTables(TableReader& file, const SceneErrors& errors, SceneDraft& draft) {
  for (TableReader& table : file.tables("path")) {
    const std::string name = table.text("name");
    addName(table, name, draft.paths);
    draft.scene.pack.paths.push_back(readPath(table, name, draft.scene.pack, draft.scene.notes));
    table.finish();
    if (errors.failed()) return;
  }
}

void readBodyTables(TableReader& file, SceneDraft& draft) {
  for (TableReader& table : file.tables("body")) {
    Body body;
    body.mesh_index = lookUp(table, "mesh", draft.meshes, "mesh");
    body.path_index = lookUp(table, "path", draft.paths, "path");
    body.name = table.text("name", table.text("mesh"));
    const std::vector<double> offset = table.numbers("offset_m", 3, kOffsetRange);
    for (int axis = 0; axis < 3; ++axis) body.offset_q[axis] = toUnits(offset[axis]);
    body.sinkage_q = toUnits(table.number("sinkage_m", kOffsetRange, 0));
    body.roll_radius_q = toUnits(table.number("wheel_radius_m", kLengthRange, 0));
    body.stride_q = toUnits(table.number("stride_m", kLengthRange, 0));
    body.lift_q = toUnits(table.number("lift_m", kLengthRange, 0));
    body.phase_q = toUnits(table.number("phase_m", kLengthRange, 0));
    body.follows_slope = table.flag("follows_slope", false) ? 1 : 0;
    body.force_n = readForce(table);
    readSize(table, draft.scene.pack, body, draft.scene.notes);
    table.finish();
    draft.scene.pack.bodies.push_back(std::move(body));
  }
}

void readVehicleTables(TableReader& file, SceneDraft& draft) {
  for (TableReader& table : file.tables("vehicle")) {
    const std::string name = table.text("name");
    Body chassis;
    chassis.path_index = lookUp(table, "path", draft.paths, "path");
    chassis.mesh_index = lookUp(table, "chassis", draft.meshes, "mesh");
    Body wheel;
    wheel.path_index = chassis.path_index;
    wheel.mesh_index = lookUp(table, "wheel", draft.meshes, "mesh");
    const VehicleShape shape = readShape(table);
    wheel.force_n = readForce(table);
    table.finish();

    chassis.name = name + ".chassis";
    chassis.offset_q = {0, toUnits(shape.left_m), toUnits(shape.chassis_height_m)};
    chassis.follows_slope = 1;
    draft.scene.pack.bodies.push_back(std::move(chassis));
    wheel.sinkage_q = toUnits(shape.sinkage_m);
    wheel.roll_radius_q = toUnits(shape.wheel_radius_m);
    for (const bool front : {true, false}) {
      for (const bool left : {true, false}) {
        wheel.name = fmt::format("{}.{}_{}", name, front ? "front" : "rear", left ? "left" : "right");
        wheel.offset_q = {toUnits(shape.wheelbase_m / (front ? 2 : -2)),
                          toUnits(shape.left_m + shape.track_m / (left ? 2 : -2)), 0};
        draft.scene.pack.bodies.push_back(wheel);
      }
    }
  }
}

}  // namespace spoor
