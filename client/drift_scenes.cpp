#include "client/drift_scenes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace spoor {

namespace {

constexpr double kMetre_q = 10000.0;
constexpr std::int32_t kCell_q = 300;
constexpr std::int32_t kSide_cells = 512;
constexpr double kWheelRadius_m = 0.34;
constexpr double kWheelWidth_m = 0.24;
constexpr int kImageSide = 256;

std::int32_t lengthOf(double value_m) { return std::int32_t(std::lround(value_m * kMetre_q)); }

/// A wheel about the y axis with lugs that alternate left and right.
Mesh wheelMesh() {
  constexpr int kSegments = 96, kLugSegments = 8;
  constexpr double kLug_m = 0.012, kShoulder_m = 0.03;
  const double half_m = kWheelWidth_m / 2.0;
  const double rings_m[] = {-half_m, -half_m + 0.03, -half_m + 0.05, -0.012,
                            0.012,   half_m - 0.05,  half_m - 0.03,  half_m};
  constexpr int kRings = 8;
  Mesh mesh;
  mesh.name = "wheel";
  for (int segment = 0; segment < kSegments; ++segment) {
    const double angle = 2.0 * std::numbers::pi * segment / kSegments;
    for (int ring = 0; ring < kRings; ++ring) {
      const int half = ring < kRings / 2 ? 0 : kLugSegments / 2;
      const bool lug = (segment + half) % kLugSegments < kLugSegments / 2;
      const int inwards = std::min(ring, kRings - 1 - ring);  // from the shoulder, over its even edge, to the lugs
      const double radius_m = kWheelRadius_m - (inwards == 0 ? kShoulder_m : inwards == 1 || !lug ? kLug_m : 0.0);
      mesh.vertices.push_back(
          {lengthOf(radius_m * std::sin(angle)), lengthOf(rings_m[ring]), lengthOf(radius_m * std::cos(angle))});
    }
  }
  for (const double side : {-half_m, half_m}) mesh.vertices.push_back({0, lengthOf(side), 0});
  const auto at = [](int segment, int ring) { return std::uint32_t(segment % kSegments * kRings + ring); };
  for (int segment = 0; segment < kSegments; ++segment) {
    for (int ring = 0; ring + 1 < kRings; ++ring) {
      mesh.triangles.push_back({at(segment, ring), at(segment, ring + 1), at(segment + 1, ring + 1)});
      mesh.triangles.push_back({at(segment, ring), at(segment + 1, ring + 1), at(segment + 1, ring)});
    }
    mesh.triangles.push_back({std::uint32_t(kSegments * kRings), at(segment, 0), at(segment + 1, 0)});
    mesh.triangles.push_back(
        {std::uint32_t(kSegments * kRings + 1), at(segment + 1, kRings - 1), at(segment, kRings - 1)});
  }
  deriveEdges(mesh);
  return mesh;
}

Mesh ballMesh(double radius_m) {
  constexpr int kAround = 36, kRings = 18;
  Mesh mesh;
  mesh.name = "ball";
  mesh.vertices.push_back({0, 0, -lengthOf(radius_m)});
  for (int ring = 1; ring < kRings; ++ring) {
    const double up = std::numbers::pi * ring / kRings;
    for (int i = 0; i < kAround; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kAround;
      mesh.vertices.push_back({lengthOf(radius_m * std::sin(up) * std::cos(angle)),
                               lengthOf(radius_m * std::sin(up) * std::sin(angle)),
                               -lengthOf(radius_m * std::cos(up))});
    }
  }
  mesh.vertices.push_back({0, 0, lengthOf(radius_m)});
  const auto at = [](int ring, int i) { return std::uint32_t(1 + (ring - 1) * kAround + i % kAround); };
  const auto top = std::uint32_t(mesh.vertices.size() - 1);
  for (int i = 0; i < kAround; ++i) {
    mesh.triangles.push_back({0, at(1, i + 1), at(1, i)});
    for (int ring = 1; ring + 1 < kRings; ++ring) {
      mesh.triangles.push_back({at(ring, i), at(ring, i + 1), at(ring + 1, i + 1)});
      mesh.triangles.push_back({at(ring, i), at(ring + 1, i + 1), at(ring + 1, i)});
    }
    mesh.triangles.push_back({at(kRings - 1, i), at(kRings - 1, i + 1), top});
  }
  deriveEdges(mesh);
  return mesh;
}

Material lookOf(DriftMaterial material) {
  switch (material) {
    case DriftMaterial::mud:
      return {"mud", {88, 74, 62}, MaterialTexture::mud};
    case DriftMaterial::pebbles:
      return {"pebbles", {158, 148, 136}, MaterialTexture::pebbles, lengthOf(0.065), lengthOf(0.022)};
    case DriftMaterial::sand:
      return {"sand", {214, 184, 140}, MaterialTexture::sand};
    case DriftMaterial::snow:
      break;
  }
  return {"snow", {236, 240, 245}, MaterialTexture::snow};
}

/// @param repose  radians
MaterialRules rulesOf(double friction_inverse, double repose, double diffusion, double compression) {
  MaterialRules rules;
  rules.friction_inverse_q32 = std::int32_t(friction_inverse * 4294967296.0);
  rules.slope_threshold_q = std::int32_t(std::tan(repose) * kCell_q);
  rules.diagonal_threshold_q = std::int32_t(std::tan(repose) * kCell_q * std::numbers::sqrt2);
  rules.repose_q16 = std::int32_t(repose / (std::numbers::pi / 2.0) * kOneQ16);
  rules.diffusion_q16 = std::int32_t(diffusion * kOneQ16);
  rules.compression_q16 = std::int32_t(compression * kOneQ16);
  return rules;
}

MaterialRules rulesOf(DriftMaterial material) {
  // Friction and diffusion are the paper's. Its angles are of steps in time (DriftWeights::displacement); these are of
  // slopes.
  constexpr double kDegree = std::numbers::pi / 180.0;
  switch (material) {
    case DriftMaterial::mud:
      return rulesOf(6.0e-4, 50.0 * kDegree, 0.25, 0.50);
    case DriftMaterial::pebbles:
      return rulesOf(3.0e-4, 38.0 * kDegree, 0.9, 0.35);
    case DriftMaterial::sand:
      return rulesOf(4.0e-4, 33.0 * kDegree, 1.0, 0.35);
    case DriftMaterial::snow:
      break;
  }
  return rulesOf(3.0e-4, 45.0 * kDegree, 0.5, 0.7);
}

ScenePack fieldPack(const char* name, const std::vector<DriftMaterial>& materials) {
  ScenePack pack;
  pack.name = name;
  pack.width_cells = pack.height_cells = kSide_cells;
  pack.cell_q = kCell_q;
  pack.soil_depth_q = lengthOf(0.5);
  pack.noise = {9, (std::int64_t(1) << 32) / 170, 3, -pack.soil_depth_q - lengthOf(0.12),
                -pack.soil_depth_q + lengthOf(0.12)};
  Parameters& parameters = pack.parameters;
  parameters.slopes = SlopeRule::drift;
  parameters.sweeps_per_tick = 16;
  parameters.displacement = Displacement::spread;
  parameters.penetration_divider_q = 40;
  parameters.spread_cells = 8;
  parameters.obstacle_threshold_q = 10;
  parameters.materials.clear();
  pack.materials.clear();
  for (const DriftMaterial material : materials) {
    pack.materials.push_back(lookOf(material));
    parameters.materials.push_back(rulesOf(material));
  }
  if (materials.size() == 1) return pack;
  pack.material_map.kind = MaterialMapKind::image;
  MaterialImage& image = pack.material_map.image;
  image.column_count = image.row_count = kImageSide;
  image.step_x_q32 = image.step_y_q32 = (std::int64_t(kImageSide) << 32) / kSide_cells;
  for (int y = 0; y < kImageSide; ++y) {
    for (int x = 0; x < kImageSide; ++x) {
      const double winding = 0.022 * std::sin(y * 0.07) + 0.012 * std::sin(y * 0.19 + 1.0) + 0.006 * std::sin(y * 0.53);
      const double strip = (double(x) / kImageSide + winding) * double(materials.size());
      image.material.push_back(std::uint8_t(std::clamp(strip, 0.0, double(materials.size()) - 1.0)));
    }
  }
  return pack;
}

Path wayAcross(double speed_m_s) {
  Path path;
  for (int i = 0; i <= 24; ++i) {
    const double part = i / 24.0;
    path.waypoints.push_back({lengthOf(1.2 + 13.0 * part), lengthOf(7.7 + 1.1 * std::sin(4.0 * part + 0.4))});
  }
  path.speed_q_per_tick = lengthOf(speed_m_s / 60.0);
  return path;
}

Body wheelBody(const char* name, double left_m) {
  Body body;
  body.name = name;
  body.offset_q = {0, lengthOf(left_m), 0};
  body.sinkage_q = lengthOf(0.06);
  body.roll_radius_q = lengthOf(kWheelRadius_m);
  body.force_n = 1500;
  return body;
}

}  // namespace

ScenePack driftTracksPack(const std::vector<DriftMaterial>& materials) {
  ScenePack pack = fieldPack("tracks", materials);
  pack.meshes.push_back(wheelMesh());
  pack.paths.push_back(wayAcross(2.6));
  pack.bodies.push_back(wheelBody("left", 0.6));
  pack.bodies.push_back(wheelBody("right", -0.6));
  pack.default_ticks = kTracksTicks;
  return pack;
}

ScenePack snowedTracksPack() {
  ScenePack pack = driftTracksPack({DriftMaterial::mud});
  pack.name = "snowed tracks";
  Snowfall snowfall;
  snowfall.area = {0, 0, pack.width_cells, pack.height_cells};
  snowfall.first_tick = kTracksTicks + 1;
  snowfall.last_tick = kSnowTicks - 20;
  snowfall.rate_q32 = (std::int64_t(lengthOf(0.16)) << 32) / (snowfall.last_tick - snowfall.first_tick);
  snowfall.seed = 4;
  pack.snowfalls.push_back(snowfall);
  pack.default_ticks = kSnowTicks;
  return pack;
}

ScenePack growingBallPack() {
  ScenePack pack = fieldPack("growing ball", {DriftMaterial::snow});
  constexpr double kRadius_m = 0.6;
  pack.meshes.push_back(ballMesh(kRadius_m));
  pack.paths.push_back(wayAcross(2.2));
  Body body;
  body.name = "ball";
  body.sinkage_q = lengthOf(0.12);
  body.force_n = 1500;
  body.first_scale_q16 = kFullScale / 5;
  body.last_scale_tick = 340;
  pack.bodies.push_back(body);
  pack.default_ticks = 340;
  return pack;
}

ScenePack driftMeasurePack(std::int32_t side_cells) {
  ScenePack pack = driftTracksPack({DriftMaterial::sand});
  pack.name = "drift measured";
  pack.width_cells = pack.height_cells = side_cells;
  pack.parameters.active_areas = 0;
  pack.parameters.sweeps_per_tick = 1;
  pack.parameters.displacement = Displacement::none;
  pack.parameters.drift_step_q16 = 16384;  // D * step = 1/4: not split
  pack.bodies.resize(1);
  for (Waypoint& at : pack.paths[0].waypoints) at.y_q += (side_cells - kSide_cells) * kCell_q / 2;
  return pack;
}

}  // namespace spoor
