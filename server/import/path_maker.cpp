#include "server/import/path_maker.h"

#include <algorithm>
#include <cmath>

#include "shared/base/assert.h"

namespace spoor {
namespace {

double distance(const PointM& a, const PointM& b) { return std::hypot(b[0] - a[0], b[1] - a[1]); }

PointM mix(const PointM& a, const PointM& b, double share) {
  return {a[0] + (b[0] - a[0]) * share, a[1] + (b[1] - a[1]) * share};
}

/// Four successive points; the curve runs from the second to the third.
struct Segment {
  PointM p0, p1, p2, p3;

  /// Barry and Goldman's pyramid. @param share  0 .. 1
  PointM at(double share) const {
    const double t1 = std::sqrt(distance(p0, p1));
    const double t2 = t1 + std::sqrt(distance(p1, p2));
    const double t3 = t2 + std::sqrt(distance(p2, p3));
    const double t = t1 + share * (t2 - t1);
    const PointM a1 = mix(p0, p1, t / t1);
    const PointM a2 = mix(p1, p2, (t - t1) / (t2 - t1));
    const PointM a3 = mix(p2, p3, (t - t2) / (t3 - t2));
    return mix(mix(a1, a2, t / t2), mix(a2, a3, (t - t1) / (t3 - t1)), (t - t1) / (t2 - t1));
  }

  double length() const {
    constexpr int kParts = 16;
    double sum = 0;
    for (int i = 0; i < kParts; ++i) sum += distance(at(double(i) / kParts), at(double(i + 1) / kParts));
    return sum;
  }
};

/// The segments between points; beyond the ends of an open path a point is mirrored.
std::vector<Segment> segmentsOf(const std::vector<PointM>& points, bool closed) {
  const std::size_t count = points.size();
  std::vector<Segment> segments;
  for (std::size_t i = 0; i + (closed ? 0 : 1) < count; ++i) {
    const PointM& from = points[i];
    const PointM& to = points[(i + 1) % count];
    Segment segment{mix(to, from, 2), from, to, mix(from, to, 2)};
    if (closed || i > 0) segment.p0 = points[(i + count - 1) % count];
    if (closed || i + 2 < count) segment.p3 = points[(i + 2) % count];
    segments.push_back(segment);
  }
  return segments;
}

}  // namespace

std::vector<PointM> smoothPath(const std::vector<PointM>& points, bool closed) {
  SPOOR_ASSERT(points.size() >= 2 && points.size() <= kSmoothPointLimit);
  const std::vector<Segment> segments = segmentsOf(points, closed);
  double length_m = 0;
  for (const Segment& segment : segments) length_m += segment.length();
  // Each segment rounds its share up, and an open path has one point more than steps.
  const double room = double(kSmoothPointLimit - points.size());
  const double step_m = room > 0 ? std::max(kSmoothStepM, length_m / room) : length_m;

  std::vector<PointM> result;
  for (const Segment& segment : segments) {
    const int parts = std::max(1, int(std::ceil(segment.length() / step_m)));
    for (int i = 0; i < parts; ++i) result.push_back(i == 0 ? segment.p1 : segment.at(double(i) / parts));
  }
  if (!closed) result.push_back(points.back());
  return result;
}

double pathLength(const std::vector<PointM>& points, bool closed) {
  double sum = 0;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) sum += distance(points[i], points[i + 1]);
  if (closed && points.size() > 1) sum += distance(points.back(), points.front());
  return sum;
}

}  // namespace spoor
