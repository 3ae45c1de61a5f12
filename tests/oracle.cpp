// A whole tick from DESIGN.md's description: what takes part, the sub-steps, what wakes, hash and ledger.
#include "tests/oracle.h"

#include <algorithm>

#include "shaders/rules/mix.h"
#include "shared/base/bytes.h"
#include "shared/base/fixed.h"
#include "shared/base/hash.h"

namespace spoor::test {
namespace {

constexpr int kSize = rules::kTileSize;
constexpr int kMostSubSteps = 32;

std::uint64_t cellHash(int x, int y, Plane plane, std::int32_t value) {
  const rules::uint key = rules::cellKey(x, y, int(plane));
  return rules::cellMixLow(key, value) + (std::uint64_t(rules::cellMixHigh(key, value)) << 32);
}

/// The smallest box that holds every cell of a tile for which `is` holds.
template <typename Is>
OracleBox boxWhere(Is is) {
  OracleBox box{kSize, kSize, 0, 0};
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x)
      if (is(x, y)) box = {std::min(box.x0, x), std::min(box.y0, y), std::max(box.x1, x + 1), std::max(box.y1, y + 1)};
  return box;
}

}  // namespace

Oracle::Oracle(const BaseTerrain& base, const PackId& id)
    : base_(&base),
      id_(id),
      parameters_(base.pack().parameters),
      extent_(tileExtent(base.pack())),
      world_(base),
      base_height_(world_.height) {
  const auto tiles = std::size_t(extent_.x) * std::size_t(extent_.y);
  live_.assign(tiles, 0);
  wake_.assign(tiles, 0);
  crater_sums_.assign(world_.height.size(), rules::craterSumOfNone());
  cratered_.assign(world_.height.size(), 0);
  snow_.assign(world_.height.size(), 0);
  snowed_.assign(tiles, 0);
  for (const Snowfall& snowfall : base.pack().snowfalls) addSnowfall(snowfall);
  poses_ = initialState(id, base).poses;
  previous_poses_ = poses_;
}

void Oracle::addSnowfall(const Snowfall& snowfall) {
  snowfalls_.push_back({snowfall, std::vector<std::int32_t>(world_.height.size(), 0)});
}

/// The cells that a mesh's box meets, and `margin` more on every side.
OracleBox Oracle::boxAround(int body_index, const Pose& pose, int margin) const {
  const OracleBody body = placeForOracle(base_->pack(), body_index, pose);
  int x0 = INT32_MAX, y0 = INT32_MAX, x1 = INT32_MIN, y1 = INT32_MIN;
  for (const auto& point : body.points) {
    const int x = body.origin_x + int(floorDiv(point.x, rules::kSubcells));
    const int y = body.origin_y + int(floorDiv(point.y, rules::kSubcells));
    x0 = std::min(x0, x);
    x1 = std::max(x1, x);
    y0 = std::min(y0, y);
    y1 = std::max(y1, y);
  }
  if (x1 < 0 || y1 < 0 || x0 >= world_.inside_columns || y0 >= world_.inside_rows) return {};
  return {std::max(x0 - margin, 0), std::max(y0 - margin, 0), std::min(x1 + 1 + margin, world_.inside_columns),
          std::min(y1 + 1 + margin, world_.inside_rows)};
}

/// One cell around a body, and as many more as spread displacement may reach beyond it.
int Oracle::searchMargin() const {
  return parameters_.displacement == Displacement::spread ? 1 + parameters_.spread_cells : 1;
}

OracleBox Oracle::searchBox(int body_index, const Pose& pose) const {
  const OracleBox box = boxAround(body_index, pose, searchMargin());
  return parameters_.active_areas == 0 && !box.empty() ? wholeWorld(world_) : box;
}

OracleBox Oracle::activeBox(int body_index, const Pose& pose) const {
  return boxAround(body_index, pose, searchMargin() + parameters_.active_margin_cells);
}

/// Sub-steps of at most a cell each: the body's shift, and what its farthest vertex moves by turning (spin left out)
/// and by growing.
int Oracle::subStepsFor(int body_index, const Pose& from, const Pose& to) const {
  const ScenePack& pack = base_->pack();
  std::int64_t farthest_square = 0;
  for (const auto& [x, y, z] : pack.meshes[std::size_t(pack.bodies[std::size_t(body_index)].mesh_index)].vertices)
    farthest_square = std::max(farthest_square, std::int64_t(x) * x + std::int64_t(y) * y + std::int64_t(z) * z);
  const std::int64_t reach = isqrt(std::uint64_t(farthest_square)) + 1;
  std::int64_t turned = 0;
  for (const Turn Pose::*turn : {&Pose::yaw, &Pose::pitch, &Pose::roll}) {
    const int round = Turn(to.*turn - from.*turn);
    turned += std::min(round, 65536 - round);
  }
  constexpr std::int64_t kRadiansPerTurnQ32 = 411775;  // 2 pi / 65536, as all machines must round it
  const std::int64_t shift =
      std::max(std::abs(std::int64_t(to.x_q) - from.x_q), std::abs(std::int64_t(to.y_q) - from.y_q));
  const std::int64_t grown = reach * std::abs(to.scale_q16 - from.scale_q16) / kFullScale;
  const std::int64_t farthest = shift + ((reach * turned * kRadiansPerTurnQ32) >> 32) + grown;
  return int(std::clamp<std::int64_t>((farthest + pack.cell_q - 1) / pack.cell_q, 1, kMostSubSteps));
}

/// Boxes of the bodies that take part; boxes that overlap become the box of both, until none do.
std::vector<OracleBox> Oracle::searchDomains(const std::vector<bool>& takes_part,
                                             const std::vector<Pose>& poses) const {
  std::vector<OracleBox> boxes;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const OracleBox box = takes_part[i] ? searchBox(int(i), poses[i]) : OracleBox{};
    if (!box.empty()) boxes.push_back(box);
  }
  for (bool joined = true; joined;) {
    joined = false;
    for (std::size_t i = 0; i < boxes.size() && !joined; ++i)
      for (std::size_t j = i + 1; j < boxes.size() && !joined; ++j) {
        const OracleBox &a = boxes[i], &b = boxes[j];
        if (a.x0 >= b.x1 || b.x0 >= a.x1 || a.y0 >= b.y1 || b.y0 >= a.y1) continue;
        boxes[i] = {std::min(a.x0, b.x0), std::min(a.y0, b.y0), std::max(a.x1, b.x1), std::max(a.y1, b.y1)};
        boxes.erase(boxes.begin() + std::ptrdiff_t(j));
        joined = true;
      }
  }
  return boxes;
}

void Oracle::markTiles(const OracleBox& box, std::vector<std::uint8_t>& tiles) const {
  for (int y = box.y0; y < box.y1; ++y)
    for (int x = box.x0; x < box.x1; ++x) tiles[tileIndex({x / kSize, y / kSize})] = 1;
}

bool Oracle::meetsTiles(const OracleBox& box, const std::vector<std::uint8_t>& tiles) const {
  for (int y = box.y0; y < box.y1; ++y)
    for (int x = box.x0; x < box.x1; ++x)
      if (tiles[tileIndex({x / kSize, y / kSize})] != 0) return true;
  return false;
}

/// What changed last tick, and the neighbours that it reaches.
std::vector<std::uint8_t> Oracle::wokenTiles() const {
  std::vector<std::uint8_t> tiles(live_.size(), 0);
  for (int y = 0; y < extent_.y; ++y)
    for (int x = 0; x < extent_.x; ++x)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          const bool named = (wake_[tileIndex({x, y})] >> ((dy + 1) * 3 + dx + 1) & 1) != 0;
          const bool exists = x + dx >= 0 && y + dy >= 0 && x + dx < extent_.x && y + dy < extent_.y;
          if (named && exists) tiles[tileIndex({x + dx, y + dy})] = 1;
        }
  return tiles;
}

std::vector<Pose> Oracle::posesOfSubStep(const std::vector<Pose>& poses, int step) const {
  std::vector<Pose> result;
  for (std::size_t i = 0; i < poses.size(); ++i) result.push_back(interpolate(poses_[i], poses[i], step, sub_steps_));
  return result;
}

/// Active tiles: the woken ones, live ones that this tick's craters meet, what lies around moving bodies where they
/// stood and at every sub-step, every search domain of every sub-step; or simply all. A body that stands still takes
/// part once what lies around it meets an active tile, and then its search domain may make more tiles active, and so
/// on.
std::vector<std::uint8_t> Oracle::plan(const std::vector<Pose>& poses, std::vector<bool>& takes_part) const {
  std::vector<std::uint8_t> tiles = wokenTiles();
  for (int y = 0; y < world_.rows; ++y)
    for (int x = 0; x < world_.columns; ++x)
      if (cratered_[world_.at(x, y)] != 0) tiles[tileIndex({x / kSize, y / kSize})] = 1;
  if (parameters_.active_areas == 0) std::ranges::fill(tiles, std::uint8_t(1));
  for (int step = 0; step <= sub_steps_; ++step) {
    const std::vector<Pose> now = posesOfSubStep(poses, step);
    for (std::size_t i = 0; i < poses.size(); ++i)
      if (takes_part[i]) markTiles(activeBox(int(i), now[i]), tiles);
  }
  for (bool grew = true; grew;) {
    grew = false;
    for (int step = 1; step <= sub_steps_; ++step)
      for (const OracleBox& domain : searchDomains(takes_part, posesOfSubStep(poses, step))) markTiles(domain, tiles);
    for (std::size_t i = 0; i < poses.size(); ++i)
      if (!takes_part[i] && meetsTiles(activeBox(int(i), poses[i]), tiles)) takes_part[i] = grew = true;
  }
  return tiles;
}

void Oracle::setActive(const std::vector<std::uint8_t>& tiles) {
  active_tiles_.clear();
  for (int y = 0; y < world_.rows; ++y)
    for (int x = 0; x < world_.columns; ++x) world_.active[world_.at(x, y)] = tiles[tileIndex({x / kSize, y / kSize})];
  for (int y = 0; y < extent_.y; ++y)
    for (int x = 0; x < extent_.x; ++x)
      if (tiles[tileIndex({x, y})] != 0) active_tiles_.push_back({x, y});
  for (const TileCoordinate tile : active_tiles_) {
    if (isLive(tile)) continue;
    live_[tileIndex(tile)] = 1;
    for (int y = tile.y * kSize; y < (tile.y + 1) * kSize; ++y)
      for (int x = tile.x * kSize; x < (tile.x + 1) * kSize; ++x)
        if (world_.inside(x, y)) {
          const std::size_t i = world_.at(x, y);
          crater_budget_ += crateredBase(i) - base_height_[i];
          event_budget_ += world_.height[i] - crateredBase(i);
        }
  }
}

void Oracle::step(const std::vector<Pose>& poses, const std::optional<Parameters>& parameters,
                  const std::vector<Crater>& craters, const std::vector<Snowfall>& snowfalls) {
  for (const Snowfall& snowfall : snowfalls) addSnowfall(snowfall);
  addSnow(tick_ + 1);
  wakeSnowed();  // by the parameters before
  parameters_ = parameters.value_or(parameters_);
  addCraters(craters);
  setDormantHeights();
  std::vector<bool> takes_part(poses.size());
  sub_steps_ = 1;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    takes_part[i] = tick_ == 0 || poses[i] != poses_[i];
    if (takes_part[i]) sub_steps_ = std::max(sub_steps_, subStepsFor(int(i), poses_[i], poses[i]));
  }
  const std::vector<bool> moves = takes_part;
  setActive(plan(poses, takes_part));
  const DenseWorld before = world_;
  penetrating_cells_ = kept_back_ = 0;
  crowded_.clear();
  drawBodies(moves, poses_);
  for (int step = 0; step < sub_steps_ && !active_tiles_.empty(); ++step) {
    const int first = step * sweepsPerTick() / sub_steps_, end = (step + 1) * sweepsPerTick() / sub_steps_;
    subStep(takes_part, posesOfSubStep(poses, step), posesOfSubStep(poses, step + 1), first, end - first);
  }
  wake(before);
  previous_poses_ = poses_;
  poses_ = poses;
  ++tick_;
}

/// Undersides of some of the bodies, and of nothing else.
void Oracle::drawBodies(const std::vector<bool>& which, const std::vector<Pose>& poses) {
  std::ranges::fill(world_.underside, rules::kNoUnderside);
  for (std::size_t i = 0; i < poses.size(); ++i)
    if (which[i]) oracleDepth(world_, placeForOracle(base_->pack(), int(i), poses[i]));
  oracleFrustum(world_, parameters_.frustum_height_q);
}

int Oracle::sweepsPerTick() const {
  return parameters_.sweeps_per_tick * (parameters_.slopes == SlopeRule::drift ? oracleDriftSteps(parameters_) : 1);
}

/// How the bodies that take part move in a sub-step.
std::vector<OraclePush> Oracle::pushesOf(const std::vector<bool>& takes_part, const std::vector<Pose>& from,
                                         const std::vector<Pose>& poses) const {
  std::vector<OraclePush> pushes;
  for (std::size_t i = 0; i < poses.size(); ++i)
    if (takes_part[i])
      pushes.push_back({std::int64_t(poses[i].x_q) - from[i].x_q, std::int64_t(poses[i].y_q) - from[i].y_q,
                        base_->pack().bodies[i].force_n, boxAround(int(i), poses[i], 0)});
  return pushes;
}

void Oracle::subStep(const std::vector<bool>& takes_part, const std::vector<Pose>& from, const std::vector<Pose>& poses,
                     int first_sweep, int sweep_count) {
  world_.underside_before = world_.underside;
  drawBodies(takes_part, poses);
  crowded_.clear();
  auto overlap = oracleOverlap(world_, parameters_.obstacle_threshold_q);
  penetrating_cells_ += std::ranges::count_if(overlap, [](std::int32_t value) { return value > 0; });
  for (const OracleBox& domain : searchDomains(takes_part, poses)) {
    oracleCompact(world_, overlap, parameters_, domain);
    if (parameters_.displacement == Displacement::none) continue;
    const OracleKept kept = oracleDisplace(world_, overlap, parameters_, domain);
    kept_back_ += kept.sum;
    crowded_.insert(crowded_.end(), kept.cells.begin(), kept.cells.end());
  }
  std::ranges::sort(crowded_);
  if (parameters_.slopes == SlopeRule::drift) {
    const std::vector<OraclePush> pushes = pushesOf(takes_part, from, poses);
    oraclePush(world_, parameters_, pushes, std::max(int(pushes.size()), 1));
  }
  const std::vector<std::int32_t> undersides = world_.underside;
  if (parameters_.displacement == Displacement::none) std::ranges::fill(world_.underside, rules::kNoUnderside);
  oracleRelax(world_, parameters_, sweep_count, tick_ + 1, first_sweep);
  world_.underside = undersides;
}

/// The box, within the tile, of its cells that changed in either plane.
OracleBox Oracle::changedBox(TileCoordinate tile, const DenseWorld& before) const {
  return boxWhere([&](int x, int y) {
    const std::size_t i = world_.at(tile.x * kSize + x, tile.y * kSize + y);
    return world_.height[i] != before.height[i] || world_.compacted[i] != before.compacted[i];
  });
}

/// The box, within the tile, of this tick's craters.
OracleBox Oracle::crateredBox(TileCoordinate tile) const {
  return boxWhere([&](int x, int y) { return cratered_[world_.at(tile.x * kSize + x, tile.y * kSize + y)] != 0; });
}

/// A changed tile keeps itself awake, and those neighbours whose common border lies within a tick's sweeps of the box
/// of what changed. The box of craters counts as changed too.
void Oracle::wake(const DenseWorld& before) {
  const int reach = std::clamp(sweepsPerTick(), 1, kSize);
  for (const TileCoordinate tile : active_tiles_) {
    WakeMask mask = 0;
    for (const OracleBox& box : {changedBox(tile, before), crateredBox(tile)})
      for (int dy = -1; dy <= 1 && !box.empty(); ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          const bool near_x = dx == 0 || (dx < 0 ? box.x0 : kSize - box.x1) < reach;
          const bool near_y = dy == 0 || (dy < 0 ? box.y0 : kSize - box.y1) < reach;
          if (near_x && near_y) mask = WakeMask(mask | 1 << ((dy + 1) * 3 + dx + 1));
        }
    wake_[tileIndex(tile)] = mask;
  }
}

std::uint64_t Oracle::stateHash() const {
  std::uint64_t sum = 0;
  for (int y = 0; y < extent_.y; ++y)
    for (int x = 0; x < extent_.x; ++x) {
      if (!isLive({x, y})) continue;
      for (int cell_y = y * kSize; cell_y < (y + 1) * kSize; ++cell_y)
        for (int cell_x = x * kSize; cell_x < (x + 1) * kSize; ++cell_x) {
          const std::size_t i = world_.at(cell_x, cell_y);
          sum += cellHash(cell_x, cell_y, Plane::height, world_.height[i]);
          if (world_.compacted[i] != 0) sum += cellHash(cell_x, cell_y, Plane::compacted, world_.compacted[i]);
          if (world_.material[i] != 0) sum += cellHash(cell_x, cell_y, Plane::material, world_.material[i]);
        }
      const std::uint64_t place = std::uint64_t(y) << 32 | std::uint64_t(x);
      sum += mix64(mix64(place ^ 0x7f4a7c159e3779b9u) + wakeMask({x, y}));
    }
  ByteWriter rest;
  rest.put(tick_);
  rest.put(id_.low);
  rest.put(id_.high);
  putParameters(rest, parameters_);
  rest.put(std::uint32_t(records_.size()));
  rest.put(cratersHash());
  rest.put(std::uint32_t(snowfalls_.size()));
  for (const Fall& fall : snowfalls_) {
    const Snowfall& record = fall.record;
    for (const std::int32_t value : {record.area.x0, record.area.y0, record.area.x1, record.area.y1}) rest.put(value);
    rest.put(record.rate_q32);
    rest.put(record.first_tick);
    rest.put(record.last_tick);
    rest.put(record.seed);
  }
  rest.put(std::uint32_t(poses_.size()));
  for (const auto* poses : {&poses_, &previous_poses_})
    for (const Pose& pose : *poses) {
      for (const std::int32_t value : {pose.x_q, pose.y_q, pose.z_q}) rest.put(value);
      for (const Turn turn : {pose.yaw, pose.pitch, pose.roll, pose.spin}) rest.put(turn);
      rest.put(pose.scale_q16);
    }
  return sum + hashBytes(rest.bytes);
}

Ledger Oracle::ledger() const {
  Ledger ledger;
  ledger.craters = crater_budget_;
  ledger.events = event_budget_;
  for (int y = 0; y < world_.rows; ++y)
    for (int x = 0; x < world_.columns; ++x) {
      if (!isLive({x / kSize, y / kSize})) continue;
      ledger.initial += base_height_[world_.at(x, y)];
      ledger.ground += world_.height[world_.at(x, y)];
      ledger.compacted += world_.compacted[world_.at(x, y)];
    }
  return ledger;
}

std::size_t Oracle::liveCount() const { return std::size_t(std::ranges::count(live_, std::uint8_t(1))); }

}  // namespace spoor::test
