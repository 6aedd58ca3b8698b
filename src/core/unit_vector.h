#pragma once

#include <cmath>

#include "core/plane_coordinates.h"

namespace organ_collision::core {

/// Times a power of two, so that no product of four over- or underflows.
inline Eigen::Vector3d madeSafe(const Eigen::Vector3d& v) {
  return v.isZero(0.0) ? v : Eigen::Vector3d(normalisingFactor(largestCoordinate(v)) * v);
}

/// To length 1, of whatever length it is; 0 remains 0.
inline Eigen::Vector3d unit(const Eigen::Vector3d& v) {
  const double squared = squaredLength(v);
  if (isSafe(squared)) return v / std::sqrt(squared);
  return v.isZero(0.0) ? v : unit(madeSafe(v));
}

}  // namespace organ_collision::core
