#include "core/rigid_pose.h"

#include <Eigen/LU>
#include <sstream>
#include <stdexcept>

#include "organ_collision/core/triangle_mesh.h"

namespace organ_collision::core {

using Eigen::Matrix3d;

double stretchOf(const Matrix3d& linear) {
  return (linear.transpose() * linear - Matrix3d::Identity()).norm();
}

void requireRigid(const Eigen::Isometry3d& pose) {
  constexpr double kMost = 0x1p-4;  // more than tf lets pass
  const double stretch = stretchOf(pose.linear());
  if (!(stretch <= kMost)) {
    std::ostringstream message;
    message << "a pose stretches squared lengths by " << stretch << ": it must be rigid";
    throw std::invalid_argument(message.str());
  }
  if (pose.linear().determinant() < 0.0)
    throw std::invalid_argument("a pose mirrors: it must be rigid");
  requireUsable(pose.translation(), "translation", 0);
}

}  // namespace organ_collision::core
