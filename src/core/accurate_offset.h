#pragma once

#include <Eigen/Core>

#include "organ_collision/core/triangle.h"

namespace organ_collision::core {

/// What rounding took of offset = end - start, exactly but for underflow: to be added to a step
/// from there, whose squared length is about `squared_step` at most. Nothing where that is long:
/// all else that rounding takes is then less beside the extent, and such a step leads to what is
/// nearest from where rounding has put the offset.
/// Source: D. Knuth, "The Art of Computer Programming" 2 (1969), 4.2.2.
inline Eigen::Vector3d lostOf(const Eigen::Vector3d& offset, const Eigen::Vector3d& end,
                              const Eigen::Vector3d& start, double squared_step) {
  const Eigen::Vector3d back = offset - end;
  const double share = squared_step < 0.5 * squaredLength(offset) ? 1.0 : 0.0;
  return share * ((end - (offset - back)) - (start + back));
}

}  // namespace organ_collision::core
