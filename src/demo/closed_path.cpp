#include "closed_path.h"

#include <cassert>
#include <cmath>
#include <cstddef>

namespace organ_collision::demo {

Eigen::Vector3d pointOnClosedPath(const std::vector<Eigen::Vector3d>& waypoints, double turn) {
  assert(!waypoints.empty() && turn >= 0.0 && turn <= 1.0);
  const std::size_t count = waypoints.size();
  const double along = turn * static_cast<double>(count);
  const double s = along - std::floor(along);
  const auto from = static_cast<std::size_t>(along);
  const auto at = [&](std::size_t step) { return waypoints[(from + step) % count]; };
  const Eigen::Vector3d p0 = at(count - 1), p1 = at(0), p2 = at(1), p3 = at(2);
  return p1 + 0.5 * s *
                  ((p2 - p0) +
                   s * ((2.0 * p0 - 5.0 * p1 + 4.0 * p2 - p3) + s * (3.0 * (p1 - p2) + p3 - p0)));
}

}  // namespace organ_collision::demo
