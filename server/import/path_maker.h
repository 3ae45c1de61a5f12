#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace spoor {

/// A point on the map, metres.
using PointM = std::array<double, 2>;

inline constexpr std::size_t kSmoothPointLimit = 4096;
inline constexpr double kSmoothStepM = 0.25;

/// Lays a smooth curve through points and returns points of it, about kSmoothStepM apart, or further where that would
/// be more than kSmoothPointLimit. The points given are among them. Source: Catmull-Rom spline, centripetal: no loops
/// or cusps between points at uneven distances (Yuksel, Schaefer, Keyser 2011).
/// @param points  2 .. kSmoothPointLimit, no two successive ones equal (asserted)
/// @param closed  the curve returns from the last point to the first; the first is not repeated
std::vector<PointM> smoothPath(const std::vector<PointM>& points, bool closed);

/// Length of the line through points, metres.
double pathLength(const std::vector<PointM>& points, bool closed);

}  // namespace spoor
