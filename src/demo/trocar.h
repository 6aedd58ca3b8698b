#pragma once

#include <Eigen/Core>

namespace organ_collision::demo {

/// The joints of a straight instrument that can only turn about its trocar and slide through it.
/// All zero: the tip is in the trocar and the shaft lies along the trocar's z axis, which points
/// into the patient.
struct TrocarJoints {
  double yaw;        ///< [rad] about the trocar's y axis
  double pitch;      ///< [rad] about the x axis, after the yaw; within +-pi/2
  double insertion;  ///< [m] from the trocar to the tip; not negative
};

/// The joints that bring the tip to `tip_in_trocar` [m]. In the trocar itself: all zero.
TrocarJoints jointsForTip(const Eigen::Vector3d& tip_in_trocar);

}  // namespace organ_collision::demo
