#pragma once

#include <Eigen/Core>
#include <cstddef>

namespace organ_collision::core {

/// The principal axes of points, in rows: unit vectors at right angles, but for 2^-40. Of many
/// points, those of every so many-th. Sums in the points' order, whatever their alignment.
Eigen::Matrix3d principalAxes(const Eigen::Vector3d* points, std::size_t count);

}  // namespace organ_collision::core
