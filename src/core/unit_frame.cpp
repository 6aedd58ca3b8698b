#include "organ_collision/core/unit_frame.h"

#include <algorithm>
#include <cmath>

namespace organ_collision::core {

UnitFrame unitFrame(const Box& box) {
  const Eigen::Vector3d half = 0.5 * box.high - 0.5 * box.low;
  const double reach = half.maxCoeff();
  constexpr int kLargest = 1023;  // beyond, the scale would overflow: meshes of denormal size
  return {box.low + half,
          reach > 0.0 ? std::ldexp(1.0, std::min(-std::ilogb(reach) - 1, kLargest)) : 1.0};
}

}  // namespace organ_collision::core
