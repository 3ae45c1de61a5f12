#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "shaders/rules/raster.h"
#include "shared/world/state.h"

namespace spoor::test {

/// A whole world as plain arrays, padded to whole tiles. Slow and obvious on purpose: what the backends are compared
/// with. Cells outside the world hold height 0 and no soil, and nothing ever moves into or out of them.
struct DenseWorld {
  int columns = 0, rows = 0;                             // of the arrays: whole tiles
  int inside_columns = 0, inside_rows = 0;               // of the world
  std::vector<std::int32_t> height, bedrock, underside;  // [rows * columns], 0.1 mm
  std::vector<std::uint8_t> active;                      // [rows * columns] 1: the cell's tile is active

  explicit DenseWorld(const BaseTerrain& base);
  std::size_t at(int x, int y) const { return std::size_t(y) * std::size_t(columns) + std::size_t(x); }
  bool inside(int x, int y) const { return x >= 0 && y >= 0 && x < inside_columns && y < inside_rows; }
};

/// A mesh in one pose: points in subcells from cell (origin_x, origin_y), heights from z_q.
struct OracleBody {
  const Mesh* mesh = nullptr;
  int origin_x = 0, origin_y = 0;
  std::int64_t z_q = 0;
  std::vector<rules::RasterPoint> points;
};
OracleBody placeForOracle(const ScenePack& pack, int body_index, const Pose& pose);

/// Is the centre of cell (x, y), counted from the body's origin, inside a triangle? By edge functions; a centre on an
/// edge belongs to the triangle to the east of it, or, where the edge is level, to the south (top-left rule).
bool coversCentre(const rules::RasterPoint& a, const rules::RasterPoint& b, const rules::RasterPoint& c, int x, int y);

/// floor of the plane's height over that centre, exactly. The triangle must have an area.
std::int64_t planeHeight(const rules::RasterPoint& a, const rules::RasterPoint& b, const rules::RasterPoint& c, int x,
                         int y);

/// Stage depth: lowers the world's undersides to a body, looking at every cell near it.
void oracleDepth(DenseWorld& world, const OracleBody& body);

/// Stage penetration: overlap of every cell (padding cells are obstacles).
std::vector<std::int32_t> oracleOverlap(const DenseWorld& world, int obstacle_threshold);

/// Stage nearest: for every penetrating cell the nearest free cell of the whole world as an index into the arrays, else
/// kNoTarget: smallest distance, then smallest y, then smallest x.
std::vector<std::int32_t> oracleNearest(const DenseWorld& world, const std::vector<std::int32_t>& overlap);

/// Stage displace. Returns the cells that kept some of their overlap for want of room.
std::vector<std::size_t> oracleDisplace(DenseWorld& world, const std::vector<std::int32_t>& overlap,
                                        const std::vector<std::int32_t>& target, int obstacle_threshold);

/// Stage relax: eight matchings per sweep over all pairs whose cells are both active.
void oracleRelax(DenseWorld& world, const ScenePack& pack, int sweep_count);

/// A whole session, tick by tick, on a DenseWorld.
class Oracle {
 public:
  explicit Oracle(const BaseTerrain& base, const PackId& id = {});

  /// `poses` must be valid.
  void step(const std::vector<Pose>& poses);

  std::uint64_t stateHash() const;
  Ledger ledger() const;
  bool isLive(TileCoordinate at) const { return live_[tileIndex(at)] != 0; }
  WakeMask wakeMask(TileCoordinate at) const { return wake_[tileIndex(at)]; }
  std::size_t liveCount() const;
  /// Active tiles of the last tick, in (y, x) order.
  const std::vector<TileCoordinate>& activeTiles() const { return active_tiles_; }
  /// Cells that, in the last sub-step of the last tick, kept overlap for want of room.
  const std::vector<std::size_t>& crowdedCells() const { return crowded_; }
  const DenseWorld& world() const { return world_; }
  int subSteps() const { return sub_steps_; }

 private:
  struct Box {
    int x0, y0, x1, y1;  // cells [x0, x1) x [y0, y1)
    bool empty() const { return x0 >= x1 || y0 >= y1; }
  };

  std::size_t tileIndex(TileCoordinate at) const { return std::size_t(at.y * extent_.x + at.x); }
  Box searchBox(int body_index, const Pose& pose) const;
  int subStepsFor(int body_index, const Pose& from, const Pose& to) const;
  std::vector<Box> searchDomains(const std::vector<bool>& takes_part, const std::vector<Pose>& poses) const;
  std::vector<std::uint8_t> wokenTiles() const;
  void markTiles(const Box& box, std::vector<std::uint8_t>& tiles) const;
  bool meetsTiles(const Box& box, const std::vector<std::uint8_t>& tiles) const;
  std::vector<Pose> posesOfSubStep(const std::vector<Pose>& poses, int step) const;
  std::vector<std::uint8_t> plan(const std::vector<Pose>& poses, std::vector<bool>& takes_part) const;
  void setActive(const std::vector<std::uint8_t>& tiles);
  void wake(const std::vector<std::int32_t>& before);

  const BaseTerrain* base_;
  PackId id_;
  TileCoordinate extent_;
  DenseWorld world_;
  std::vector<std::int32_t> base_height_;
  std::vector<std::uint8_t> live_;  // [tiles]
  std::vector<WakeMask> wake_;      // [tiles]
  std::vector<TileCoordinate> active_tiles_;
  std::vector<std::size_t> crowded_;
  std::vector<Pose> poses_, previous_poses_;
  std::int32_t tick_ = 0;
  int sub_steps_ = 0;
};

}  // namespace spoor::test
