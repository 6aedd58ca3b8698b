#include "trocar.h"

#include <cmath>

namespace organ_collision::demo {

TrocarJoints jointsForTip(const Eigen::Vector3d& tip_in_trocar) {
  const double x = tip_in_trocar.x();
  const double y = tip_in_trocar.y();
  const double z = tip_in_trocar.z();
  const double insertion = std::hypot(x, y, z);
  if (insertion == 0.0) return TrocarJoints{0.0, 0.0, 0.0};  // atan2 may give pi for signed zeros
  return TrocarJoints{std::atan2(x, z), std::atan2(-y, std::hypot(x, z)), insertion};
}

}  // namespace organ_collision::demo
