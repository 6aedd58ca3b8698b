#pragma once

#include <Eigen/Core>
#include <vector>

namespace organ_collision::demo {

/// A smooth closed path (its velocity is continuous) through `waypoints` [m], where `turn` 0 and 1
/// are the first waypoint and equal parts of a turn lead from each waypoint to the next. REQUIRES:
/// at least one waypoint; 0 <= turn <= 1. Source: E. Catmull, R. Rom, "A class of local
/// interpolating splines" (1974), uniform, tension 1/2.
Eigen::Vector3d pointOnClosedPath(const std::vector<Eigen::Vector3d>& waypoints, double turn);

}  // namespace organ_collision::demo
