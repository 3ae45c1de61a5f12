#pragma once

#include "shared/world/state.h"

namespace spoor {

/// How a pile lies, compared with the round cone that its soil would make at the angle of repose.
struct PileShape {
  double steepest_excess = 0;  // largest excess over a threshold, of the threshold
  double shape_error = 0;      // half the sum of differences from the cone, of the pile's volume
  double azimuth_ratio = 0;    // largest radius at half the cone's height over the smallest
  double centroid_cells = 0;   // distance of the soil's centroid from the pile's middle
  double edge_deg = 0;         // steepest slope between side neighbours
  double flank_deg = 0;        // mean angle of the gradient from a quarter to three quarters of the way up
};

/// Of a pile in the middle of level ground. Thresholds, and the cone, are those of the state's first material.
PileShape pileShape(const WorldState& state, const ScenePack& pack);

}  // namespace spoor
