#include "client/views.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "client/column_renderer.h"
#include "shaders/rules/limits.h"
#include "shared/base/assert.h"

namespace spoor {

namespace {

constexpr double kUnits = rules::kUnitsPerMetre;
constexpr double kSmallestSize_cells = 3.0;  // a view is as wide as bodies are large, but never closer than this

struct Box {
  glm::dvec2 low_m, high_m;
  glm::dvec2 middle_m() const { return (low_m + high_m) * 0.5; }
};

/// Of the live tiles, within the world; the first body's surroundings where none is live.
Box liveBox(const TerrainView& view) {
  const ScenePack& pack = view.base->pack();
  const double tile_m = rules::kTileSize * pack.cell_q / kUnits;
  Box box{glm::dvec2(1e30), glm::dvec2(-1e30)};
  for (const Tile* tile : view.state->tiles.sorted()) {
    box.low_m = glm::min(box.low_m, glm::dvec2(tile->at.x, tile->at.y) * tile_m);
    box.high_m = glm::max(box.high_m, glm::dvec2(tile->at.x + 1, tile->at.y + 1) * tile_m);
  }
  const glm::dvec2 world_m = glm::dvec2(pack.width_cells, pack.height_cells) * (pack.cell_q / kUnits);
  if (box.low_m.x > box.high_m.x) {
    const glm::dvec2 at = view.state->poses.empty()
                              ? world_m * 0.5
                              : glm::dvec2(view.state->poses[0].x_q, view.state->poses[0].y_q) / kUnits;
    box = {at - 4.0 * tile_m, at + 4.0 * tile_m};
  }
  return {glm::max(box.low_m, glm::dvec2(0.0)), glm::min(box.high_m, world_m)};
}

/// Radius of the bodies on a path, about the path's point [m].
double sizeOnPath(const ScenePack& pack, int path_index) {
  double radius_m = 0.0;
  for (const Body& body : pack.bodies) {
    if (body.path_index != path_index) continue;
    double reach_q = 0.0;
    for (const auto& v : pack.meshes[std::size_t(body.mesh_index)].vertices)
      reach_q = std::max(reach_q, std::hypot(double(v[0]), double(v[1]), double(v[2])));
    radius_m = std::max(radius_m, (reach_q + std::hypot(double(body.offset_q[0]), double(body.offset_q[1]))) / kUnits);
  }
  return radius_m;
}

glm::dvec2 pointOf(const Waypoint& waypoint) { return glm::dvec2(waypoint.x_q, waypoint.y_q) / kUnits; }

std::vector<std::array<glm::dvec2, 2>> segmentsOf(const Path& path) {
  std::vector<std::array<glm::dvec2, 2>> segments;
  for (std::size_t i = 1; i < path.waypoints.size(); ++i)
    segments.push_back({pointOf(path.waypoints[i - 1]), pointOf(path.waypoints[i])});
  if (path.closed != 0 && path.waypoints.size() > 1)
    segments.push_back({pointOf(path.waypoints.back()), pointOf(path.waypoints.front())});
  return segments;
}

std::optional<glm::dvec2> crossing(const std::array<glm::dvec2, 2>& a, const std::array<glm::dvec2, 2>& b) {
  const glm::dvec2 along_a = a[1] - a[0], along_b = b[1] - b[0], between = b[0] - a[0];
  const double turn = along_a.x * along_b.y - along_a.y * along_b.x;
  if (std::abs(turn) < 1e-9) return std::nullopt;
  const double on_a = (between.x * along_b.y - between.y * along_b.x) / turn;
  const double on_b = (between.x * along_a.y - between.y * along_a.x) / turn;
  if (on_a < 0.0 || on_a > 1.0 || on_b < 0.0 || on_b > 1.0) return std::nullopt;
  return a[0] + on_a * along_a;
}

glm::dvec2 nearestOn(const std::array<glm::dvec2, 2>& segment, const glm::dvec2& place_m) {
  const glm::dvec2 along = segment[1] - segment[0];
  const double length_squared = std::max(glm::dot(along, along), 1e-12);
  return segment[0] + along * glm::clamp(glm::dot(place_m - segment[0], along) / length_squared, 0.0, 1.0);
}

const Tile* tileAt(const TerrainView& view, const glm::dvec2& place_m) {
  const glm::dvec2 tile = glm::floor(place_m * kUnits / double(view.base->pack().cell_q * rules::kTileSize));
  return view.state->tiles.find({std::int32_t(tile.x), std::int32_t(tile.y)});
}

/// Where the tracks are worth a look.
glm::dvec2 tracksMiddle(const TerrainView& view) {
  const auto& paths = view.base->pack().paths;
  const glm::dvec2 middle_m = liveBox(view).middle_m();
  glm::dvec2 best_m = middle_m;
  double best_away = std::numeric_limits<double>::max();
  const auto consider = [&](const glm::dvec2& place_m) {
    if (glm::distance(place_m, middle_m) >= best_away) return;
    best_away = glm::distance(place_m, middle_m);
    best_m = place_m;
  };
  for (std::size_t first = 0; first < paths.size(); ++first)
    for (std::size_t second = first + 1; second < paths.size(); ++second)
      for (const auto& a : segmentsOf(paths[first]))
        for (const auto& b : segmentsOf(paths[second]))
          if (const auto place_m = crossing(a, b); place_m && tileAt(view, *place_m) != nullptr) consider(*place_m);
  if (best_away < std::numeric_limits<double>::max()) return best_m;
  for (const Path& path : paths)
    for (const auto& segment : segmentsOf(path))
      if (const glm::dvec2 place_m = nearestOn(segment, middle_m); tileAt(view, place_m) != nullptr) consider(place_m);
  if (best_away < std::numeric_limits<double>::max()) return best_m;
  const double tile_m = rules::kTileSize * view.base->pack().cell_q / kUnits;
  for (const Tile* tile : view.state->tiles.sorted()) consider((glm::dvec2(tile->at.x, tile->at.y) + 0.5) * tile_m);
  return best_m;
}

/// Raises the eye where the ground would hide it.
void keepAboveGround(const TerrainView& view, glm::dvec3& eye_m, double clearance_m) {
  eye_m.z = std::max(eye_m.z, groundHeight(view, {eye_m.x, eye_m.y}) + clearance_m);
}

/// Widens a circle about a crater so that it holds the newest of the others that meet it, too.
void takeInNeighbour(const TerrainView& view, std::uint32_t id, glm::dvec2& centre_m, double& outer_m) {
  const CraterSet& craters = view.state->craters;
  const std::vector<std::uint32_t> ids = craters.meeting(craterBox(view.base->pack(), craters.records()[id]));
  const auto other = std::ranges::find_if(ids.rbegin(), ids.rend(), [&](std::uint32_t i) { return i != id; });
  if (other == ids.rend()) return;
  const Crater& crater = craters.records()[*other];
  const glm::dvec2 other_m = glm::dvec2(crater.x_q, crater.y_q) / kUnits;
  const double other_outer_m = double(crater.outerRadius()) / kUnits, apart_m = glm::distance(centre_m, other_m);
  if (apart_m >= outer_m + other_outer_m) return;  // only their squares meet
  const double both_m = std::max({(apart_m + outer_m + other_outer_m) / 2.0, outer_m, other_outer_m});
  if (apart_m > 0.0) centre_m += (other_m - centre_m) / apart_m * glm::clamp(both_m - outer_m, 0.0, apart_m);
  outer_m = both_m;
}

}  // namespace

double groundHeight(const TerrainView& view, const glm::dvec2& place_m) {
  const ScenePack& pack = view.base->pack();
  const glm::dvec2 size(pack.width_cells, pack.height_cells);
  const glm::dvec2 at = glm::clamp(place_m * kUnits / double(pack.cell_q) - 0.5, glm::dvec2(0.0), size - 1.0);
  const glm::dvec2 low = glm::min(glm::floor(at), glm::max(size - 2.0, glm::dvec2(0.0)));
  const auto heightOf = [&](double cell_x, double cell_y) {
    const auto x = std::int32_t(std::min(cell_x, size.x - 1.0)), y = std::int32_t(std::min(cell_y, size.y - 1.0));
    const Tile* tile = view.state->tiles.find({x / rules::kTileSize, y / rules::kTileSize});
    if (tile == nullptr) return double(dormantGround(*view.state, *view.base).height(x, y));
    return double(tile->height()[std::size_t(y % rules::kTileSize * rules::kTileSize + x % rules::kTileSize)]);
  };
  const glm::dvec2 part = at - low;
  const double south = glm::mix(heightOf(low.x, low.y), heightOf(low.x + 1, low.y), part.x);
  const double north = glm::mix(heightOf(low.x, low.y + 1), heightOf(low.x + 1, low.y + 1), part.x);
  return glm::mix(south, north, part.y) / kUnits;
}

std::vector<int> leadingBodies(const ScenePack& pack) {
  std::vector<int> result;
  std::vector<std::int32_t> seen;
  for (std::size_t i = 0; i < pack.bodies.size(); ++i) {
    if (std::ranges::find(seen, pack.bodies[i].path_index) != seen.end()) continue;
    seen.push_back(pack.bodies[i].path_index);
    result.push_back(int(i));
  }
  return result;
}

Camera followView(const TerrainView& view, int body_index) {
  const ScenePack& pack = view.base->pack();
  SPOOR_ASSERT(body_index >= 0 && std::size_t(body_index) < view.state->poses.size());
  const Pose& pose = view.state->poses[std::size_t(body_index)];
  const double size_m = std::max(sizeOnPath(pack, pack.bodies[std::size_t(body_index)].path_index),
                                 kSmallestSize_cells * pack.cell_q / kUnits);
  const double heading = double(pose.yaw) / 65536.0 * 2.0 * std::numbers::pi;
  const glm::dvec2 ahead(std::cos(heading), std::sin(heading));
  const glm::dvec2 aside(-ahead.y, ahead.x);
  const glm::dvec2 at_m = glm::dvec2(pose.x_q, pose.y_q) / kUnits;
  const double ground_m = groundHeight(view, at_m);
  // A little to the side and above, looking just behind the body, so that its tracks fill the foreground.
  glm::dvec3 eye_m(at_m - ahead * 4.2 * size_m + aside * 1.1 * size_m, ground_m + 1.9 * size_m);
  keepAboveGround(view, eye_m, 0.8 * size_m);
  return cameraLookingAt(eye_m, {at_m - ahead * 0.6 * size_m, ground_m + 0.15 * size_m});
}

Camera trailsView(const TerrainView& view, double sun_azimuth_deg) {
  const ScenePack& pack = view.base->pack();
  const glm::dvec2 middle_m = tracksMiddle(view);
  double size_m = kSmallestSize_cells * pack.cell_q / kUnits;
  for (const int body : leadingBodies(pack))
    size_m = std::max(size_m, sizeOnPath(pack, pack.bodies[std::size_t(body)].path_index));
  const double ground_m = groundHeight(view, middle_m);

  // The sun from the side, either side, a little in front or behind: whichever shows most of the bodies, and among
  // those the one that looks most along their way from here.
  std::optional<Camera> best;
  double best_score = 0.0;
  for (const double turn_deg : {-75.0, 75.0, -105.0, 105.0}) {
    const double azimuth = glm::radians(sun_azimuth_deg + turn_deg);
    const glm::dvec2 ahead(std::cos(azimuth), std::sin(azimuth));
    glm::dvec3 eye_m(middle_m - ahead * 4.4 * size_m, ground_m + 2.5 * size_m);
    keepAboveGround(view, eye_m, 1.0 * size_m);
    const Camera camera = cameraLookingAt(eye_m, {middle_m + ahead * 0.6 * size_m, ground_m});
    double score = 0.0;
    for (const int body : leadingBodies(pack)) {
      const Pose& pose = view.state->poses[std::size_t(body)];
      const glm::dvec3 at_m = glm::dvec3(pose.x_q, pose.y_q, pose.z_q) / kUnits;
      const glm::dvec3 towards = at_m - camera.eye_m;
      if (glm::length(towards) < 25.0 * size_m && glm::dot(glm::normalize(towards), camera.forward) > 0.82)
        score += 2.0;
      const glm::dvec2 way = glm::dvec2(at_m) - middle_m;
      if (glm::length(way) > 0.0) score += glm::dot(glm::normalize(way), ahead);
    }
    if (best && score <= best_score) continue;
    best_score = score;
    best = camera;
  }
  return *best;
}

Camera aboveView(const TerrainView& view, double aspect) {
  const Box box = liveBox(view);
  const glm::dvec2 size_m = box.high_m - box.low_m;
  double highest_m = -1e9;
  for (int i = 0; i < 256; ++i)
    highest_m = std::max(highest_m, groundHeight(view, box.low_m + size_m * glm::dvec2(i % 16, i / 16) / 15.0));
  constexpr double kClearance_m = 1000.0;  // above whatever the coarse look missed
  Camera camera;
  camera.eye_m = {box.middle_m(), highest_m + kClearance_m};
  camera.forward = {0.0, 0.0, -1.0};
  camera.up = {0.0, 1.0, 0.0};
  camera.orthographic_height_m = 1.04 * std::max(size_m.y, size_m.x / aspect);
  camera.focus_m = box.middle_m();
  return camera;
}

Camera columnsView(const TerrainView& view) {
  const double cell_m = view.base->pack().cell_q / kUnits;
  const ColumnCells cells = columnCells(view, glm::ivec2(liveBox(view).middle_m() / cell_m));
  const glm::dvec2 middle_m = (glm::dvec2(cells.first) + glm::dvec2(cells.count) * 0.5) * cell_m;
  const double size_m = glm::max(cells.count.x, cells.count.y) * cell_m;
  const double ground_m = groundHeight(view, middle_m);
  // From so far away that columns stand all but parallel; one side of a square faces the eye more than the other.
  constexpr double kAway = 2.95, kView_deg = 22.0;
  const glm::dvec3 back(0.40, -0.66, 0.64);
  Camera camera =
      cameraLookingAt(glm::dvec3(middle_m, ground_m) + glm::normalize(back) * kAway * size_m, {middle_m, ground_m});
  camera.field_of_view_deg = kView_deg;
  return camera;
}

Camera overviewView(const TerrainView& view, double aspect) {
  const ScenePack& pack = view.base->pack();
  const glm::dvec2 world_m = glm::dvec2(pack.width_cells, pack.height_cells) * (pack.cell_q / kUnits);
  const glm::dvec2 middle_m = world_m * 0.5;
  const double ground_m = groundHeight(view, middle_m);
  const double size_m = std::max(world_m.y, world_m.x * 1.6 / aspect);
  constexpr double kView_deg = 34.0;
  const glm::dvec3 eye_m(middle_m + glm::dvec2(0.0, -0.98 * size_m), ground_m + 1.15 * size_m);
  Camera camera = cameraLookingAt(eye_m, {middle_m + glm::dvec2(0.0, -0.06 * size_m), ground_m});
  camera.field_of_view_deg = kView_deg;
  camera.focus_m = middle_m;
  return camera;
}

Camera craterView(const TerrainView& view, std::uint32_t id, CraterLook look, double sun_azimuth_deg, double aspect) {
  SPOOR_ASSERT(id < view.state->craters.size());
  constexpr double kEye_m = 1.7;  // of a man, over the ground
  const Crater& crater = view.state->craters.records()[id];
  glm::dvec2 centre_m = glm::dvec2(crater.x_q, crater.y_q) / kUnits;
  double outer_m = double(crater.outerRadius()) / kUnits;
  const double crest_m = crater.crest_radius_q / kUnits;
  if (look == CraterLook::at_once || look == CraterLook::above) takeInNeighbour(view, id, centre_m, outer_m);
  // Inside, towards the wall that is lit.
  const double azimuth = glm::radians(sun_azimuth_deg + (look == CraterLook::inside ? 150.0 : -75.0));
  const glm::dvec2 ahead(std::cos(azimuth), std::sin(azimuth));
  const auto onGround = [&](const glm::dvec2& place_m, double over_m) {
    return glm::dvec3(place_m, groundHeight(view, place_m) + over_m);
  };
  const glm::dvec3 edge_m = onGround(centre_m - ahead * outer_m, 0.0);  // about as high as before the explosion
  if (look == CraterLook::above) {
    Camera camera = cameraLookingAt({centre_m, edge_m.z + 500.0}, {centre_m, edge_m.z});
    camera.orthographic_height_m = 2.6 * std::max(outer_m, outer_m / aspect);
    return camera;
  }
  Camera camera;
  if (look == CraterLook::ground) {
    camera = cameraLookingAt(onGround(centre_m - ahead * (1.2 * outer_m + 2.5), kEye_m), {centre_m, edge_m.z});
  } else if (look == CraterLook::inside) {
    const glm::dvec3 eye_m = onGround(centre_m - ahead * 0.30 * crest_m, kEye_m);
    const glm::dvec3 rim_m = onGround(centre_m + ahead * crest_m, 0.0);
    camera = cameraLookingAt(eye_m, {glm::dvec2(rim_m), std::min(rim_m.z, eye_m.z)});
    camera.field_of_view_deg = 75.0;
  } else {
    glm::dvec3 eye_m(centre_m - ahead * 2.1 * outer_m, edge_m.z + 1.15 * outer_m);
    keepAboveGround(view, eye_m, 0.3 * outer_m);
    camera = cameraLookingAt(eye_m, {centre_m, edge_m.z - 0.1 * outer_m});
    camera.field_of_view_deg = 45.0;
  }
  camera.focus_m = centre_m;
  return camera;
}

}  // namespace spoor
