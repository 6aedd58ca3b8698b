#pragma once

#include <Eigen/Core>

namespace organ_collision::core {

/// What rounding took of end - start, exactly but for underflow.
/// Source: D. Knuth, "The Art of Computer Programming" 2 (1969), 4.2.2.
inline Eigen::Vector3d lostOf(const Eigen::Vector3d& difference, const Eigen::Vector3d& end,
                              const Eigen::Vector3d& start) {
  const Eigen::Vector3d back = difference - end;
  return (end - (difference - back)) - (start + back);
}

}  // namespace organ_collision::core
