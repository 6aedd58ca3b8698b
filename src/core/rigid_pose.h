#pragma once

#include <Eigen/Geometry>

namespace organ_collision::core {

/// How far a matrix is from a rotation: it changes squared lengths by this part of them at most.
double stretchOf(const Eigen::Matrix3d& linear);

/// Throws std::invalid_argument unless the pose is one, but for a 16th of squared lengths, and its
/// translation is usable.
void requireRigid(const Eigen::Isometry3d& pose);

}  // namespace organ_collision::core
