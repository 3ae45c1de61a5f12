#pragma once

#include <vector>

#include "shared/world/parameters.h"

namespace spoor::test {

/// Ground in real numbers, row-major [rows * columns]; lengths in cells (the paper's grid of side one), angles in
/// radians. Edges of the field are closed: what lies beyond is as what lies at the edge, and no force acts there.
struct DriftField {
  int columns = 0, rows = 0;
  double diffusion = 1;         // D
  double friction_inverse = 0;  // 1 / zeta
  double repose = 0;            // alpha
  std::vector<double> height;
  std::vector<double> force_x, force_y;  // of each cell; empty: none

  double at(int x, int y) const { return height[std::size_t(y * columns + x)]; }
  double volume() const;
};

/// One step of the published scheme: explicit, weights by cell (equations 4 to 8). Neither conserves volume nor knows
/// bedrock, and is unstable for steps above 1 / (4 D).
/// @param weights  none: equation 2; displacement: as printed; slope is not of the paper (asserted)
/// Source: Gilardi, Watten and Newbury, "Drift-Diffusion Based Real-Time Dynamic Terrain Deformation"
void stepGilardi(DriftField& field, double step, DriftWeights weights);

/// One step of what rules/drift.h computes, in real numbers, without bedrock, bodies or rounding: flows over edges.
void stepConserved(DriftField& field, double step, DriftWeights weights);

/// A drop of soil that diffuses on an unbounded plane: height at a distance after `time`, from a Gaussian of `peak` and
/// standard deviation `width` at time 0.
double diffusedGaussian(double peak, double width, double diffusion, double time, double distance_square);

}  // namespace spoor::test
