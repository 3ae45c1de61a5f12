#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "client/terrain_view.h"
#include "shared/sim/simulation.h"
#include "shared/world/script.h"

namespace spoor {

/// A scene that is simulated here, without a server, to be drawn.
class FigureScene {
 public:
  /// The pack must be valid.
  FigureScene(ScenePack pack, std::unique_ptr<Backend> backend);

  /// Poses of the pack's bodies after a tick.
  using PosesAt = std::function<std::vector<Pose>(std::int32_t tick)>;

  /// Runs on to `tick`, with the craters that the pack times itself. Errors: the simulation's, with the tick.
  [[nodiscard]] Status runTo(std::int32_t tick, const PosesAt& poses_at);
  /// The same with the bodies as the pack's script moves them.
  [[nodiscard]] Status runTo(std::int32_t tick);

  const ScenePack& pack() const { return *pack_; }
  const WorldState& state() const { return simulation_.state(); }
  TerrainView view() const { return {&base_, &simulation_.state()}; }

  /// Tiles that the last tick simulated, in (y, x) order; none before the first.
  const std::vector<TileCoordinate>& activeTiles() const { return active_; }

 private:
  std::unique_ptr<const ScenePack> pack_;  // where the base and the renderers keep pointing to
  BaseTerrain base_;
  Script script_;
  std::vector<std::int32_t> reach_q_;
  Simulation simulation_;
  std::vector<TileCoordinate> active_;
};

/// Flat ground and a box that stands on it, turned by 45 degrees to the axes (Persson 2019, figures 5.1 to 5.3): no
/// slope evening.
ScenePack pressedBoxPack(Displacement displacement, Metric metric);

/// The box is pressed into the ground, then moved on a little along its own axis.
inline constexpr std::int32_t kPressedBoxTicks = 6;
FigureScene::PosesAt pressedBoxPoses(const ScenePack& pack);

/// Rolling ground with a crater of each kind: see CraterLooks. No bodies; all of them come with tick 1.
ScenePack craterLooksPack();

/// Ids of the craters of craterLooksPack().
struct CraterLooks {
  static constexpr int single = 0;
  static constexpr int twin = 2;     // the newer of two that intersect
  static constexpr int deep = 3;     // with a high rim
  static constexpr int shallow = 4;  // R1 = R2, no rim (the paper's figure 12)
};

}  // namespace spoor
