#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "shaders/rules/raster.h"
#include "shared/world/state.h"

namespace spoor::test {

/// A whole world as plain arrays, dormant ground too, padded to whole tiles. Slow and obvious on purpose: what the
/// backends are compared with. Cells outside the world hold height 0 and no soil, and nothing ever moves into or out of
/// them.
struct DenseWorld {
  int columns = 0, rows = 0;                             // of the arrays: whole tiles
  int inside_columns = 0, inside_rows = 0;               // of the world
  int cell_q = 0;                                        // side of a cell, 0.1 mm
  std::vector<std::int32_t> height, bedrock, underside;  // [rows * columns], 0.1 mm
  std::vector<std::int32_t> underside_before;            // a sub-step earlier
  std::vector<std::int32_t> compacted;                   // [rows * columns] soil pressed together, 0.1 mm
  std::vector<std::int32_t> material;                    // [rows * columns] number of the cell's material
  std::vector<std::int32_t> push_x, push_y;              // [rows * columns] what forces move in a unit of time, 0.1 mm
  std::vector<std::uint8_t> active;                      // [rows * columns] 1: the cell's tile is active

  explicit DenseWorld(const BaseTerrain& base);
  std::size_t at(int x, int y) const { return std::size_t(y) * std::size_t(columns) + std::size_t(x); }
  bool inside(int x, int y) const { return x >= 0 && y >= 0 && x < inside_columns && y < inside_rows; }
  bool isActive(int x, int y) const { return inside(x, y) && active[at(x, y)] != 0; }
  std::int64_t soil(std::size_t cell) const { return std::int64_t(height[cell]) - bedrock[cell]; }
  /// What a cell can take: the gap beneath a body, where it is over the threshold.
  std::int64_t room(std::size_t cell, int obstacle_threshold) const {
    const std::int64_t gap = std::int64_t(underside[cell]) - height[cell];
    return gap > obstacle_threshold ? gap : 0;
  }
  const MaterialRules& rulesOf(const Parameters& parameters, std::size_t cell) const {
    return parameters.materials[std::size_t(material[cell])];
  }
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

/// A search domain: cells [x0, x1) x [y0, y1) of the world.
struct OracleBox {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  bool empty() const { return x0 >= x1 || y0 >= y1; }
  bool holds(int x, int y) const { return x >= x0 && y >= y0 && x < x1 && y < y1; }
};
OracleBox wholeWorld(const DenseWorld& world);

/// The end of stage depth: bodies higher than the frustum above bedrock are not there.
void oracleFrustum(DenseWorld& world, int frustum_height);

/// Stage penetration: overlap of every cell (padding cells are obstacles).
std::vector<std::int32_t> oracleOverlap(const DenseWorld& world, int obstacle_threshold);

/// Its second part: presses some of a domain's overlap together, out of heights and overlap onto the compacted plane.
void oracleCompact(DenseWorld& world, std::vector<std::int32_t>& overlap, const Parameters& parameters,
                   const OracleBox& domain);

/// Stage nearest: for every penetrating cell of the domain a free cell of it as an index into the arrays, else
/// kNoTarget; for iterative displacement for every obstacle too. Exactly: smallest distance, then smallest Euclidean
/// distance, then smallest y, then smallest x.
std::vector<std::int32_t> oracleNearest(const DenseWorld& world, const std::vector<std::int32_t>& overlap,
                                        const Parameters& parameters, const OracleBox& domain);

/// The passes of jump flooding over a domain whose longer side is `size`.
std::vector<int> oracleFloodSteps(NearestSearch search, int size);

/// What stage displace could not place.
struct OracleKept {
  std::int64_t sum = 0;            // 0.1 mm * cells
  std::vector<std::size_t> cells;  // whose soil still reaches into a body
};

/// Stage displace with all its rounds or iterations, nearest included.
OracleKept oracleDisplace(DenseWorld& world, std::vector<std::int32_t> overlap, const Parameters& parameters,
                          const OracleBox& domain);

/// Stage relax: sweeps over all edges between cells that are both active; those of rule `drift` from number
/// `first_sweep` of a tick on, and by the world's pushes.
void oracleRelax(DenseWorld& world, const Parameters& parameters, int sweep_count, std::int32_t tick = 1,
                 int first_sweep = 0);

/// The same, one sweep of rule `drift`.
void oracleDrift(DenseWorld& world, const Parameters& parameters, std::int32_t tick, int sweep);

/// Passes over the ground for each sweep of rule `drift`.
int oracleDriftSteps(const Parameters& parameters);

/// A body that pushes: how far it came in a sub-step, and the cells that its mesh can cover.
struct OraclePush {
  std::int64_t dx_q = 0, dy_q = 0;  // 0.1 mm
  std::int32_t force_n = 0;
  OracleBox box;
};

/// Before the sweeps of rule `drift`: the world's pushes.
/// @param body_count  that take part, pushing or not
void oraclePush(DenseWorld& world, const Parameters& parameters, const std::vector<OraclePush>& pushes, int body_count);

/// Number of a cell's material by the pack's map.
std::int32_t oracleMaterial(const BaseTerrain& base, int x, int y);

/// A whole session, tick by tick, on a DenseWorld.
class Oracle {
 public:
  explicit Oracle(const BaseTerrain& base, const PackId& id = {});

  /// `poses` must be valid, and so must be `parameters`, which hold from this tick on, `craters`, whose tick and id are
  /// set here, and `snowfalls`, which come with the tick.
  void step(const std::vector<Pose>& poses, const std::optional<Parameters>& parameters = {},
            const std::vector<Crater>& craters = {}, const std::vector<Snowfall>& snowfalls = {});

  std::uint64_t stateHash() const;
  Ledger ledger() const;
  bool isLive(TileCoordinate at) const { return live_[tileIndex(at)] != 0; }
  WakeMask wakeMask(TileCoordinate at) const { return wake_[tileIndex(at)]; }
  std::size_t liveCount() const;
  /// Active tiles of the last tick, in (y, x) order.
  const std::vector<TileCoordinate>& activeTiles() const { return active_tiles_; }
  /// Cells that, in the last sub-step of the last tick, kept overlap for want of room.
  const std::vector<std::size_t>& crowdedCells() const { return crowded_; }
  /// Of all sub-steps of the last tick, as in TickEffect.
  std::int64_t penetratingCells() const { return penetrating_cells_; }
  std::int64_t keptBack() const { return kept_back_; }
  const DenseWorld& world() const { return world_; }
  const Parameters& parameters() const { return parameters_; }
  /// All so far, with their ticks and ids.
  const std::vector<Crater>& craters() const { return records_; }
  std::size_t snowfallCount() const { return snowfalls_.size(); }
  int subSteps() const { return sub_steps_; }

 private:
  std::size_t tileIndex(TileCoordinate at) const { return std::size_t(at.y * extent_.x + at.x); }
  OracleBox boxAround(int body_index, const Pose& pose, int margin) const;
  OracleBox searchBox(int body_index, const Pose& pose) const;
  OracleBox activeBox(int body_index, const Pose& pose) const;
  int searchMargin() const;
  int subStepsFor(int body_index, const Pose& from, const Pose& to) const;
  std::vector<OracleBox> searchDomains(const std::vector<bool>& takes_part, const std::vector<Pose>& poses) const;
  std::vector<std::uint8_t> wokenTiles() const;
  void markTiles(const OracleBox& box, std::vector<std::uint8_t>& tiles) const;
  bool meetsTiles(const OracleBox& box, const std::vector<std::uint8_t>& tiles) const;
  std::vector<Pose> posesOfSubStep(const std::vector<Pose>& poses, int step) const;
  std::vector<std::uint8_t> plan(const std::vector<Pose>& poses, std::vector<bool>& takes_part) const;
  void setActive(const std::vector<std::uint8_t>& tiles);
  void addSnowfall(const Snowfall& snowfall);
  void addSnow(std::int32_t tick);
  WakeMask unstableMask(TileCoordinate tile, const std::vector<WakeMask>& wake) const;
  void wakeSnowed();
  void addCraters(const std::vector<Crater>& craters);
  std::int32_t crateredBase(std::size_t cell) const;
  void setDormantHeights();
  void addToSums(const Crater& crater);
  void markLiveBox(const Crater& crater);
  std::uint64_t cratersHash() const;
  void subStep(const std::vector<bool>& takes_part, const std::vector<Pose>& from, const std::vector<Pose>& poses,
               int first_sweep, int sweep_count);
  std::vector<OraclePush> pushesOf(const std::vector<bool>& takes_part, const std::vector<Pose>& from,
                                   const std::vector<Pose>& poses) const;
  int sweepsPerTick() const;
  void drawBodies(const std::vector<bool>& which, const std::vector<Pose>& poses);
  OracleBox changedBox(TileCoordinate tile, const DenseWorld& before) const;
  OracleBox crateredBox(TileCoordinate tile) const;
  void wake(const DenseWorld& before);

  const BaseTerrain* base_;
  PackId id_;
  Parameters parameters_;
  TileCoordinate extent_;
  DenseWorld world_;
  std::vector<std::int32_t> base_height_;
  std::vector<std::uint8_t> live_;  // [tiles]
  std::vector<WakeMask> wake_;      // [tiles]
  std::vector<Crater> records_;
  std::vector<rules::CraterSum> crater_sums_;  // [rows * columns] of all records
  std::vector<std::uint8_t> cratered_;         // [rows * columns] 1: live, and in the box of a crater of this tick
  std::int64_t crater_budget_ = 0;             // what craters gave live tiles, 0.1 mm * cells
  /// A snowfall, and how many of its layers each cell has a unit of.
  struct Fall {
    Snowfall record;
    std::vector<std::int32_t> layers;  // [rows * columns]
  };
  std::vector<Fall> snowfalls_;
  std::vector<std::int32_t> snow_;    // [rows * columns] of all snowfalls, up to its tile's last beat
  std::vector<std::uint8_t> snowed_;  // [tiles] 1: live, and took snow in this tick
  std::int64_t event_budget_ = 0;     // what snowfalls gave live tiles, 0.1 mm * cells
  std::vector<TileCoordinate> active_tiles_;
  std::vector<std::size_t> crowded_;
  std::vector<Pose> poses_, previous_poses_;
  std::int32_t tick_ = 0;
  std::int64_t penetrating_cells_ = 0, kept_back_ = 0;
  int sub_steps_ = 0;
};

}  // namespace spoor::test
