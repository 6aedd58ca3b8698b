#include "organ_collision/core/unit_frame.h"

#include <cmath>

namespace organ_collision::core {

UnitFrame unitFrame(const Box& box) {
  const Eigen::Vector3d half = 0.5 * box.high - 0.5 * box.low;
  const double reach = half.maxCoeff();
  return {box.low + half, reach > 0.0 ? std::ldexp(1.0, -std::ilogb(reach) - 1) : 1.0};
}

}  // namespace organ_collision::core
