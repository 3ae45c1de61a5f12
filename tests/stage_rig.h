#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "shared/sim/native_stages.h"
#include "tests/backends.h"
#include "tests/scenes.h"

namespace spoor::test {

using Cells = std::vector<std::int32_t>;

/// The stages one by one on a whole small world: every tile active, one domain over all cells, no body yet. Planes are
/// given and taken as the world's cells, row by row.
class StageRig {
 public:
  virtual ~StageRig() = default;
  StageRig(const StageRig&) = delete;

  Cells height() const { return insideOf(tileHeights()); }
  Cells underside() const { return insideOf(tileUndersides()); }
  void setHeight(const Cells& cells) { putTileHeights(withInside(tileHeights(), cells)); }
  /// As bodies would have left them.
  void setUnderside(const Cells& cells) { putTileUndersides(withInside(tileUndersides(), cells)); }
  /// Compacted soil; all 0 where the world's parameters do not compact.
  Cells compacted() const { return insideOf(tileCompacted()); }
  /// Only where the world's parameters compact. After setHeight and setUnderside.
  void setCompacted(const Cells& cells) { putTileCompacted(withInside(tileCompacted(), cells)); }
  virtual Cells overlap() const = 0;               // after penetration
  virtual int penetratingCount() const = 0;        // after penetration; those of whose overlap all was compacted too
  virtual Cells target() const = 0;                // after nearest; of penetrating cells
  virtual void setTarget(const Cells& cells) = 0;  // in place of nearest
  /// Active tiles' heights, kTileCells of each tile in the plan's order, cells outside the world included.
  virtual Cells tileHeights() const = 0;
  virtual Cells tileUndersides() const = 0;
  virtual Cells tileCompacted() const = 0;
  const std::vector<TileCoordinate>& active() const { return plan_.active; }
  const World& world() const { return world_; }

  /// Draws these bodies, and no others, into the undersides, over all cells.
  virtual void press(const std::vector<PlacedBody>& bodies) = 0;
  virtual void penetration() = 0;
  virtual void nearest() = 0;
  virtual void displace() = 0;
  /// Soil that the last displace() left where bodies are, 0.1 mm * cells.
  virtual std::int64_t keptBack() const = 0;
  /// Sweeps, the first of them being number `first_sweep` since heights or undersides were set.
  virtual void relax(int first_sweep, int sweep_count) = 0;

  /// Penetration, nearest and displace.
  void moveSoil();

 protected:
  /// @param active  in (y, x) order; empty: all tiles. With others than all there is no domain: only relax() may run
  StageRig(const World& world, std::vector<TileCoordinate> active);
  virtual void putTileHeights(const Cells& cells) = 0;
  virtual void putTileUndersides(const Cells& cells) = 0;
  virtual void putTileCompacted(const Cells& cells) = 0;
  bool hasDomain() const { return has_domain_; }
  CellBox domainBox() const { return {0, 0, world_.pack.width_cells, world_.pack.height_cells}; }

  const World& world_;
  TickPlan plan_;

 private:
  Cells insideOf(const Cells& tiles) const;
  Cells withInside(Cells tiles, const Cells& cells) const;
  std::ptrdiff_t tileIndex(int x, int y) const;  // of a cell; -1: not active

  bool has_domain_;
};

/// The native stages; public, for tests of what only they have.
class NativeStageRig final : public StageRig {
 public:
  explicit NativeStageRig(const World& world, int thread_count = 1, const Kernels& set = kernels(),
                          bool skip_settled = true, std::vector<TileCoordinate> active = {});

  Cells overlap() const override { return domain.overlap; }
  int penetratingCount() const override { return domain.penetrating_count; }
  Cells target() const override { return domain.target; }
  void setTarget(const Cells& cells) override;
  Cells tileHeights() const override { return tilesOf(area.height); }
  Cells tileUndersides() const override { return tilesOf(area.underside); }
  Cells tileCompacted() const override;
  void press(const std::vector<PlacedBody>& bodies) override;
  void penetration() override { runPenetration(context, domain); }
  void nearest() override { runNearest(context, domain); }
  void displace() override { kept_back_ = runDisplace(context, domain, 0); }
  std::int64_t keptBack() const override { return kept_back_; }
  void relax(int first_sweep, int sweep_count) override { runRelax(context, first_sweep, sweep_count, skip_settled_); }

  ThreadPool pool;
  ActiveTiles tiles;
  WorkArea area;
  NativeContext context;
  DomainWork domain;

 private:
  void putTileHeights(const Cells& cells) override { putTiles(area.height, cells); }
  void putTileUndersides(const Cells& cells) override;
  void putTileCompacted(const Cells& cells) override { putTiles(area.compacted, cells); }
  Cells tilesOf(const std::vector<std::int32_t>& plane) const;
  void putTiles(std::vector<std::int32_t>& plane, const Cells& cells);

  bool skip_settled_;
  std::int64_t kept_back_ = 0;
};

/// The rig of a case's backend. Throws std::runtime_error where it cannot be made.
std::unique_ptr<StageRig> makeStageRig(const BackendCase& backend_case, const World& world,
                                       std::vector<TileCoordinate> active = {});

/// Puts random undersides over some of a rig's cells: over single ones, or over blocks of them, some of them roofs with
/// little room; and where it compacts some compacted soil.
void coverAtRandom(StageRig& rig, std::uint32_t seed);

/// A dense world with the planes that a rig holds, all cells active.
DenseWorld denseCopy(const StageRig& rig);

/// The world's cells of one of its planes.
Cells insideCells(const DenseWorld& dense, const std::vector<std::int32_t>& plane);

}  // namespace spoor::test
